#include "measure/ceilings.hpp"

#include <carom/world.hpp>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "measure/arithmetic_peak.hpp"
#include "measure/clocks.hpp"
#include "measure/machine.hpp"
#include "measure/text.hpp"

namespace carom::measure {
namespace {

constexpr int kTries = 5;
constexpr std::size_t kKibibyte = 1024;

std::size_t cache_or(int level, std::size_t otherwise) {
    const std::size_t bytes = cache_bytes(level);
    return bytes > 0 ? bytes : otherwise;
}

/// Bytes a second of memcpy between two arrays that have `bytes` together.
double copy_bandwidth(std::size_t bytes, double seconds) {
    const std::size_t half = bytes / 2;
    std::vector<char> from(half, 1), to(half, 2);
    double best = 0;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        std::size_t copied = 0;
        const double start = thread_seconds();
        double spent = 0;
        do {
            const std::size_t times = 1 + 256 * kKibibyte / half;
            for (std::size_t i = 0; i < times; ++i) {
                std::memcpy(to.data(), from.data(), half);
                asm volatile("" : : "r"(to.data()) : "memory");
            }
            copied += 2 * half * times;
            spent = thread_seconds() - start;
        } while (spent < seconds / kTries);
        best = std::max(best, static_cast<double>(copied) / spent);
    }
    return best;
}

}  // namespace

const CopyBandwidth& Ceilings::copy_of(std::size_t working_set) const {
    for (const CopyBandwidth& level : copy)
        if (working_set <= 2 * level.bytes) return level;
    return copy.back();
}

const ArithmeticPeak& Ceilings::peak_of(const std::string& isa) const {
    for (const ArithmeticPeak& each : peak)
        if (each.isa == isa) return each;
    throw std::out_of_range(joined("no arithmetic peak was measured for ", isa));
}

Ceilings measure_ceilings(double seconds) {
    const std::size_t l1 = cache_or(1, 32 * kKibibyte);
    const std::size_t l2 = cache_or(2, 512 * kKibibyte);
    const std::size_t l3 = cache_or(3, 8 * kKibibyte * kKibibyte);
    Ceilings ceilings;
    const auto add = [&](const char* level, std::size_t bytes) {
        ceilings.copy.push_back({level, bytes, copy_bandwidth(bytes, seconds)});
    };
    add("L1", l1 / 2);
    add("L2", l2 / 2);
    add("L3", l3 / 2);
    add("memory", 4 * l3);
    for (const std::string& isa : runnable_instruction_sets())
        ceilings.peak.push_back(
            {isa, best_arithmetic_rate(isa, false, seconds), best_arithmetic_rate(isa, true, seconds)});
    return ceilings;
}

Json ceilings_json(const Ceilings& ceilings) {
    Json json{{"copy", Json::array()}, {"peak", Json::array()}};
    for (const CopyBandwidth& level : ceilings.copy)
        json["copy"].push_back(
            {{"level", level.level}, {"bytes", level.bytes}, {"bytes_per_second", level.bytes_per_second}});
    for (const ArithmeticPeak& each : ceilings.peak)
        json["peak"].push_back({{"isa", each.isa},
                                {"float_per_second", each.single_per_second},
                                {"double_per_second", each.double_per_second}});
    return json;
}

RoofShare roof_share(const Work& work, double items_per_second, double bandwidth, double peak) {
    const double memory = work.bytes * items_per_second / bandwidth;
    const double arithmetic = work.operations * items_per_second / peak;
    return {std::max(memory, arithmetic), memory >= arithmetic};
}

}  // namespace carom::measure
