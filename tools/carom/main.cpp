#include <carom/errors.hpp>

#include <cstdio>
#include <exception>
#include <new>

#include "commands/commands.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/standard_output.hpp"

namespace carom::tool {
namespace {

int complain(const char* message, ExitCode code) {
    std::fprintf(stderr, "carom: %s\n", message);
    return code;
}

}  // namespace
}  // namespace carom::tool

int main(int argc, char** argv) {
    using namespace carom::tool;
    hold_standard_streams();
    try {
        return checked_output(run_program(argc, argv));
    } catch (const carom::Error& error) {
        return complain(error.what(), kWrongInput);
    } catch (const UsageError& error) {
        return complain(error.what(), kWrongInput);
    } catch (const WriteError& error) {
        return complain(joined(error.what(), ". The results are incomplete and were removed.").c_str(),
                        kInternalError);
    } catch (const OutputError& error) {
        return complain(error.what(), kInternalError);
    } catch (const std::bad_alloc&) {
        return complain("out of memory", kInternalError);
    } catch (const std::exception& error) {
        return complain(joined("internal error: ", error.what()).c_str(), kInternalError);
    }
}
