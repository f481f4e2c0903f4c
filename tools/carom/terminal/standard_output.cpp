#include "standard_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <utility>

#include "exit_codes.hpp"

namespace carom::tool {
namespace {

std::string& results() {
    static std::string where;  // empty: there are none
    return where;
}

}  // namespace

void hold_standard_streams() {
    constexpr int kModes[] = {O_WRONLY, O_RDONLY, O_WRONLY};  // of standard input, output and error
    for (int stream = 0; stream < 3; ++stream)
        if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", kModes[stream]) < 0) return;
}

void note_results_in(std::string where) {
    results() = std::move(where);
    std::signal(SIGPIPE, SIG_IGN);
}

int checked_output(int code) {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    if (results().empty()) {
        std::fputs("carom: standard output could not be written\n", stderr);
        return kInternalError;
    }
    std::fprintf(stderr,
                 "carom: standard output could not be written, the table is lost; the results are complete "
                 "in %s\n",
                 results().c_str());
    return code;
}

}  // namespace carom::tool
