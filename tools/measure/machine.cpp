#include "measure/machine.hpp"

#include <carom/build_info.hpp>

#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "measure/text.hpp"

namespace carom::measure {
namespace {

/// The value of a line "key : value" of /proc/cpuinfo, or nothing.
std::string cpuinfo(const std::string& key) {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(key)) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return {};
}

/// What a file of the kernel's description of a cache says, or nothing.
std::string cache_entry(int index, const char* entry) {
    std::ifstream file(format("/sys/devices/system/cpu/cpu0/cache/index%d/%s", index, entry));
    std::string text;
    std::getline(file, text);
    return text;
}

/// Lower-case letters and digits; everything else becomes one dash.
std::string as_label(const std::string& text) {
    std::string label;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) != 0)
            label += static_cast<char>(std::tolower(byte));
        else if (!label.empty() && label.back() != '-')
            label += '-';
    }
    while (!label.empty() && label.back() == '-') label.pop_back();
    return label;
}

}  // namespace

std::size_t cache_bytes(int level) {
    constexpr int kMostCaches = 8;
    for (int index = 0; index < kMostCaches; ++index) {
        if (cache_entry(index, "level") != std::to_string(level) ||
            cache_entry(index, "type") == "Instruction")
            continue;
        const std::string size = cache_entry(index, "size");  // "32768K"
        const auto number = static_cast<std::size_t>(std::strtoull(size.c_str(), nullptr, 10));
        return number << (size.ends_with("K") ? 10 : size.ends_with("M") ? 20 : 0);
    }
    return 0;
}

Json machine_properties() {
    const BuildInfo build = build_info();
    utsname system{};
    uname(&system);
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    std::string processor = cpuinfo("model name");
    if (processor.empty()) processor = system.machine;
    return {{"processor", processor},
            {"architecture", system.machine},
            {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
            {"memory_bytes", static_cast<std::int64_t>(pages) * page},
            {"l1_bytes", cache_bytes(1)},
            {"l2_bytes", cache_bytes(2)},
            {"l3_bytes", cache_bytes(3)},
            {"system", system.sysname},
            {"compiler", build.compiler},
            {"isa", build.runnable},
            {"threads", build.threads},
            {"xsimd", build.xsimd_version}};
}

std::string machine_label(const Json& properties) {
    constexpr std::int64_t kMebibyte = 1 << 20;
    std::string text = properties.at("processor").get<std::string>();
    text += joined(" ", std::to_string(properties.at("cores").get<std::int64_t>()), " cores");
    if (!properties.at("isa").empty()) text += joined(" ", properties.at("isa").back().get<std::string>());
    if (const auto l3 = properties.at("l3_bytes").get<std::int64_t>() / kMebibyte; l3 > 0)
        text += joined(" ", std::to_string(l3), " mib l3");
    return as_label(text);
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    std::array<char, 16> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%d", &utc);
    return {text.data(), length};
}

Json result_header(const std::string& kind) {
    return {{"kind", kind},
            {"date", today()},
            {"version", build_info().version},
            {"machine", machine_properties()}};
}

}  // namespace carom::measure
