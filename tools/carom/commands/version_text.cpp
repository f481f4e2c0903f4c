#include <carom/build_info.hpp>

#include <string>

#include "commands.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text.append(text.empty() ? "" : " ").append(name);
    return text;
}

}  // namespace

std::string version_text() {
    const BuildInfo info = build_info();
    return joined("carom ", info.version, "\n",                               //
                  "instruction sets  built: ", listed(info.built),            //
                  "; this machine runs: ", listed(info.runnable),             //
                  "; chosen: ", info.chosen, "\n",                            //
                  "threads           ", std::to_string(info.threads),         //
                  info.openmp ? " (OpenMP)\n" : " (built without OpenMP)\n",  //
                  "xsimd             ", info.xsimd_version, "\n",             //
                  "compiler          ", info.compiler);
}

}  // namespace carom::tool
