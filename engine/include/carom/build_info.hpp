#pragma once

#include <string>
#include <vector>

namespace carom {

/// What the linked library is and what it would use on this machine; `carom --version` prints it.
struct BuildInfo {
    std::string version;
    std::vector<std::string> built;     ///< instruction sets compiled in, slowest first
    std::vector<std::string> runnable;  ///< of these, what this machine can run
    std::string chosen;                 ///< what a world with isa "auto" takes; CAROM_ISA has its say
    int threads = 1;                    ///< what a world with threads 0 takes
    bool openmp = false;                ///< built with OpenMP
    std::string xsimd_version;
    std::string compiler;
};

/// @throws Error (unsupported_isa) if CAROM_ISA asks for what there is not
BuildInfo build_info();

}  // namespace carom
