#include <algorithm>
#include <map>

#include "accuracy/analysis.hpp"
#include "accuracy/solvers.hpp"
#include "terminal/format.hpp"

namespace carom::accuracy {
namespace {

using tool::format;
using tool::joined;

constexpr double kPercent = 100;

/// Two digits, never as a power of ten.
std::string times(double ratio) {
    return ratio < 10 ? format("%.2g", ratio) : format("%.0f", ratio);
}

/// The cheapest point of a solver, in whichever precision, that reaches the target.
const Point* cheapest_of(const CaseResult& result, const std::string& name, double target) {
    const Point* best = nullptr;
    for (const Precision precision : {Precision::single_, Precision::double_})
        if (const Point* point = cheapest(result, {name, precision}, target);
            point && (!best || point->seconds.value < best->seconds.value))
            best = point;
    return best;
}

bool has_points_of(const CaseResult& result, const std::string& name) {
    return std::any_of(result.points.begin(), result.points.end(),
                       [&](const Point& point) { return name_of(point.setting) == name; });
}

/// "impulse (cheapest in 3 of 3)", "event (cheapest in 2 of 4) or pairwise (cheapest in 2 of 4)", "none gets
/// there"
std::string winners(const std::vector<const CaseResult*>& cases, double target) {
    std::map<std::string, int> wins;
    for (const CaseResult* result : cases)
        if (const Point* best = cheapest(*result, target)) ++wins[name_of(best->setting)];
    if (wins.empty()) return "none gets there";
    std::string text;
    for (const auto& [name, count] : wins)
        text += format("%s%s (cheapest in %d of %zu)", text.empty() ? "" : " or ", name.c_str(), count,
                       cases.size());
    return text;
}

/// "event takes 2.1 to 2.4 times the time of the cheapest, pairwise 62 times or never gets there"
std::string distances(const std::vector<const CaseResult*>& cases, double target) {
    std::string text;
    for (const SweptSolver& swept : swept_solvers()) {
        const std::string name = swept.name();
        double least = 0, most = 0;
        bool fails = false;
        for (const CaseResult* result : cases) {
            const Point* best = cheapest(*result, target);
            if (!best || !has_points_of(*result, name)) continue;
            const Point* own = cheapest_of(*result, name, target);
            if (!own) {
                fails = true;
                continue;
            }
            const double ratio = own->seconds.value / best->seconds.value;
            least = least > 0 ? std::min(least, ratio) : ratio, most = std::max(most, ratio);
        }
        if (!(most > 1) && !fails) continue;
        text += (text.empty() ? "" : "; ") + name;
        if (most > 0)
            text += joined(" takes ", least < most ? joined(times(least), " to ") : "", times(most),
                           " times the time of the cheapest");
        if (fails) text += most > 0 ? ", or does not get there" : " does not get there";
    }
    return text;
}

/// What to take for a kind of scene.
std::string advice_on(std::string_view kind, const std::vector<const CaseResult*>& cases) {
    std::string text(kind);
    text += " (";
    for (const CaseResult* result : cases)
        text += (result == cases.front() ? "" : ", ") + std::string(result->of->id);
    text += "): ";
    for (const double target : kTargets)
        text += format("%sto %g %% %s", target == kTargets.front() ? "" : "; ", kPercent * target,
                       winners(cases, target).c_str());
    const std::string others = distances(cases, kTargets.front());
    return others.empty() ? text + "."
                          : text + format(". To %g %%: ", kPercent * kTargets.front()) + others + ".";
}

/// Where a solver is on the frontier, or that it never is; and why.
std::string standing_of(const SweptSolver& swept, const std::vector<CaseResult>& results) {
    const std::string name = swept.name();
    std::string cases;
    for (const CaseResult& result : results) {
        const auto frontier = frontier_of(result);
        if (std::any_of(frontier.begin(), frontier.end(),
                        [&](const Point* point) { return name_of(point->setting) == name; }))
            cases += (cases.empty() ? "" : ", ") + std::string(result.of->id);
    }
    const std::string why = format("%s %s. ", name.c_str(), swept.why.c_str());
    if (cases.empty())
        return why + "It is never on the frontier: something else is always faster and nearer.";
    return why + "It is on the frontier in " + cases + ".";
}

}  // namespace

std::vector<std::string> advice_from(const std::vector<CaseResult>& results) {
    std::vector<std::string_view> kinds;
    for (const CaseResult& result : results)
        if (std::find(kinds.begin(), kinds.end(), result.of->kind) == kinds.end())
            kinds.push_back(result.of->kind);
    std::vector<std::string> advice;
    for (const std::string_view kind : kinds) {
        std::vector<const CaseResult*> cases;
        for (const CaseResult& result : results)
            if (result.of->kind == kind) cases.push_back(&result);
        advice.push_back(advice_on(kind, cases));
    }
    for (const SweptSolver& swept : swept_solvers()) {
        const bool has_points = std::any_of(results.begin(), results.end(), [&](const CaseResult& result) {
            return has_points_of(result, swept.name());
        });
        if (has_points) advice.push_back(standing_of(swept, results));
    }
    return advice;
}

}  // namespace carom::accuracy
