#include "torture/verdicts.hpp"

#include "measure/text.hpp"

namespace carom::torture {

using measure::format;
using measure::joined;

const Measure* shown_of(const Outcome& outcome) {
    const Measure* shown = nullptr;
    for (const Measure& measure : outcome.measures)
        if (!measure.passes() && (!shown || measure.share() > shown->share())) shown = &measure;
    return shown || outcome.measures.empty() ? shown : &outcome.measures.front();
}

std::string words_of(const Measure& measure) {
    std::string text = joined(measure.name, format(" %.3g", measure.value));
    if (measure.mark)
        text += format(" (at %s %.3g)", measure.sense == Sense::at_least ? "least" : "most", *measure.mark);
    return text;
}

std::string words_of(const Bracket& bracket) {
    const char* const time = bracket.is_out_of_time ? ", out of time" : "";
    if (!bracket.holds && !bracket.fails) return joined("nothing known", time);
    if (!bracket.holds) return format("fails at %.4g already%s", *bracket.fails, time);
    if (!bracket.fails) return format("holds at %.4g%s", *bracket.holds, time);
    return format("holds at %.4g, not at %.4g%s", *bracket.holds, *bracket.fails, time);
}

std::string reason_of(const Outcome& outcome) {
    std::string text = outcome.failure;
    for (const Measure& measure : outcome.measures)
        if (!measure.passes()) text += joined(text.empty() ? "" : "; ", words_of(measure));
    return text;
}

}  // namespace carom::torture
