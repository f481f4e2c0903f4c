#include "torture/envelopes/bracket.hpp"

#include <cmath>

namespace carom::torture {
namespace {

double next_of(const Range& range, double value) {
    const double next = range.is_linear ? value + range.stride : value * range.stride;
    return std::fmin(range.is_whole ? std::round(next) : next, range.last);
}

bool is_narrow(const Range& range, double holds, double fails) {
    if (range.is_whole && fails - holds <= 1) return true;
    constexpr double kRounding = 1 + 1e-9;
    return range.is_linear ? fails - holds <= range.narrow * kRounding
                           : fails <= holds * range.narrow * kRounding;
}

/// Between both, and neither of them.
double middle_of(const Range& range, double holds, double fails) {
    const double middle = range.is_linear ? 0.5 * (holds + fails) : std::sqrt(holds * fails);
    if (!range.is_whole) return middle;
    return std::fmin(std::fmax(std::round(middle), holds + 1), fails - 1);
}

}  // namespace

Bracket bracket_of(const Range& range, const std::function<Verdict(double, std::string&)>& probe,
                   const std::function<void(const Bracket&)>& report) {
    Bracket bracket;
    const auto is_known = [&](double value) {
        std::string why;
        const Verdict verdict = probe(value, why);
        ++bracket.runs;
        if (verdict == Verdict::out_of_time)
            bracket.is_out_of_time = true;
        else if (verdict == Verdict::holds)
            bracket.holds = value;
        else
            bracket.fails = value, bracket.reason = why;
        report(bracket);
        return !bracket.is_out_of_time;
    };
    for (double value = range.first; !bracket.fails; value = next_of(range, value)) {
        if (!is_known(value)) return bracket;
        if (value >= range.last) break;
    }
    while (bracket.holds && bracket.fails && !is_narrow(range, *bracket.holds, *bracket.fails))
        if (!is_known(middle_of(range, *bracket.holds, *bracket.fails))) break;
    return bracket;
}

}  // namespace carom::torture
