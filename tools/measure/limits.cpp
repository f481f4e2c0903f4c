#include "measure/limits.hpp"

#include "measure/text.hpp"

namespace carom::measure {
namespace {

constexpr double kReadingsOfShortCall = 40;  // a call that takes no longer is mostly its own beginning
constexpr double kFewBodies = 1000;
constexpr double kNearRoof = 0.3;     // of the roof: what is left is latency, not another limit
constexpr double kVectorsHelp = 1.3;  // times scalar

}  // namespace

std::string limit_of(const StageFacts& facts) {
    if (facts.seconds_per_call < kReadingsOfShortCall * facts.seconds_of_a_reading)
        return format("%s: a call takes %.2f us, mostly to begin",
                      facts.bodies < kFewBodies ? "too few bodies" : "too little to do in a step",
                      1e6 * facts.seconds_per_call);
    if (facts.roof_share && *facts.roof_share >= kNearRoof) {
        const double percent = 100 * *facts.roof_share;
        if (facts.roof_is_memory)
            return format("memory: %.0f %% of what %s can move", percent, facts.level.c_str());
        return format("arithmetic: %.0f %% of what the units can do", percent);
    }
    if (!facts.times_scalar) return "branching or latency: far from both roofs";
    if (*facts.times_scalar >= kVectorsHelp)
        return format(
            "arithmetic in part: vectors make it %.1f times faster, the rest is loads of single records, "
            "shuffles and branches",
            *facts.times_scalar);
    return "branching: far from both roofs, and vectors do not help; one thing decides what comes next";
}

}  // namespace carom::measure
