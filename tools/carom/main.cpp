#include <carom/errors.hpp>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "format.hpp"
#include "standard_output.hpp"

namespace carom::tool {
namespace {

int complain(const char* message, ExitCode code) {
    std::fprintf(stderr, "carom: %s\n", message);
    return code;
}

/// Help and version texts are answers; everything else CLI11 throws is a wrong command line.
int answer(const CLI::App& program, const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kWrongInput;
}

int run_program(int argc, char** argv) {
    CLI::App program("Carom, a 2D rigid-body physics engine: runs scenes and writes what happened.", "carom");
    Action action;
    program.require_subcommand(1);
    program.set_version_flag(
        "--version", [] { return version_text(); }, "Version, instruction sets, threads, and exit");
    add_run_command(program, action);
    add_explain_command(program, action);
    add_check_command(program, action);
    add_profile_command(program, action);
    add_prices_command(program, action);
    add_scaling_command(program, action);
    add_report_command(program, action);
    add_accuracy_command(program, action);
    add_torture_command(program, action);
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return answer(program, error);
    }
    return action();
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
