#include <carom/build_info.hpp>
#include <carom/version.hpp>
#include <carom/world.hpp>

#include "isa/select_isa.hpp"
#include "parallel/executor.hpp"

#include <xsimd/config/xsimd_config.hpp>

namespace carom {
namespace {

std::string xsimd_version() {
    return std::to_string(XSIMD_VERSION_MAJOR) + '.' + std::to_string(XSIMD_VERSION_MINOR) + '.' +
           std::to_string(XSIMD_VERSION_PATCH);
}

std::string compiler() {
#if defined(__clang__)
    return "clang " __clang_version__;
#else
    return "gcc " __VERSION__;
#endif
}

constexpr bool kOpenMp =
#if defined(_OPENMP)
    true;
#else
    false;
#endif

}  // namespace

BuildInfo build_info() {
    return {.version = std::string(version()),
            .built = built_instruction_sets(),
            .runnable = runnable_instruction_sets(),
            .chosen = std::string(select_kernels("auto").single_precision.isa),
            .threads = Executor(0).threads(),
            .openmp = kOpenMp,
            .xsimd_version = xsimd_version(),
            .compiler = compiler()};
}

}  // namespace carom
