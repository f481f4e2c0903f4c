#include <carom/build_info.hpp>

#include <string>

#include "commands.hpp"

namespace carom::tool {
namespace {

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
    return text;
}

}  // namespace

std::string version_text() {
    const BuildInfo info = build_info();
    return "carom " + info.version + "\n" +
           "instruction sets  built: " + joined(info.built) + "; this machine runs: " + joined(info.runnable) +
           "; chosen: " + info.chosen + "\n" +
           "threads           " + std::to_string(info.threads) + (info.openmp ? " (OpenMP)" : " (built without OpenMP)") + "\n" +
           "xsimd             " + info.xsimd_version + "\n" +
           "compiler          " + info.compiler;
}

}  // namespace carom::tool
