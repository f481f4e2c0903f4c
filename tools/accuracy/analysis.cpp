#include "accuracy/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>

#include "accuracy/solvers.hpp"

namespace carom::accuracy {
namespace {

bool is_of(const Point& point, const Contender& contender) {
    return name_of(point.setting) == contender.name && point.setting.precision == contender.precision;
}

/// What a point's first error is at most: of a mean that is uncertain, the upper end of its band.
double surely_at_most(const CaseResult& result, const Point& point) {
    return result.of->errors[0].is_statistic ? point.errors[0].high : point.errors[0].value;
}

/// The points of the sweep over steps that have an error, longest step first.
std::vector<const Point*> step_sweep(const CaseResult& result, const Contender& contender) {
    std::vector<const Point*> sweep;
    for (const Point& point : result.points)
        if (is_of(point, contender) && point.failure.empty() &&
            (sweep.empty() || (point.setting.substeps == sweep.front()->setting.substeps &&
                               point.setting.iterations == sweep.front()->setting.iterations)))
            sweep.push_back(&point);
    std::sort(sweep.begin(), sweep.end(),
              [](const Point* a, const Point* b) { return a->setting.dt > b->setting.dt; });
    return sweep;
}

}  // namespace

std::string in_words(const Contender& contender) {
    return contender.name + (contender.precision == Precision::single_ ? ", float" : ", double");
}

std::vector<Contender> contenders_in(const CaseResult& result) {
    std::vector<Contender> found;
    for (const Point& point : result.points) {
        const Contender contender{name_of(point.setting), point.setting.precision};
        if (std::find(found.begin(), found.end(), contender) == found.end()) found.push_back(contender);
    }
    return found;
}

std::optional<Order> observed_order(const CaseResult& result, const Contender& contender, std::size_t error) {
    constexpr double kStillFalls = 0.8;  // of the error of the step before
    constexpr std::size_t kFewest = 3;
    std::vector<double> x, y;
    Order fit;
    for (const Point* point : step_sweep(result, contender)) {
        const double value = point->errors[error].value;
        if (!(value > 0) || (!y.empty() && std::log(value) > y.back() + std::log(kStillFalls))) break;
        x.push_back(std::log(point->setting.dt)), y.push_back(std::log(value));
        if (x.size() == 1) fit.from = point->setting.dt;
        fit.to = point->setting.dt;
    }
    if (x.size() < kFewest) return std::nullopt;
    const double n = static_cast<double>(x.size());
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
    fit.order = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    return fit;
}

std::optional<Sources> sources_of(const CaseResult& result, const Contender& contender, std::size_t error) {
    const auto& all = swept_solvers();
    const auto swept = std::find_if(all.begin(), all.end(),
                                    [&](const SweptSolver& each) { return each.name() == contender.name; });
    if (swept == all.end() || !swept->has_residual) return std::nullopt;
    std::set<double, std::greater<>> steps;
    for (const Point& point : result.points)
        if (is_of(point, contender)) steps.insert(point.setting.dt);
    if (steps.empty()) return std::nullopt;
    const double middle = *std::next(steps.begin(), static_cast<std::ptrdiff_t>(steps.size() / 2));
    Sources sources;
    for (const Point& point : result.points) {
        if (!is_of(point, contender) || !point.failure.empty()) continue;
        const Setting& s = point.setting;
        const Sources::Part part{s.dt, s.substeps, s.iterations, point.errors[error].value};
        if (s.substeps == swept->most_substeps() && s.iterations == swept->most_iterations())
            sources.step.push_back(part);
        if (s.dt == middle) sources.residual.push_back(part);
    }
    std::sort(sources.step.begin(), sources.step.end(),
              [](const auto& a, const auto& b) { return a.dt > b.dt; });
    std::sort(sources.residual.begin(), sources.residual.end(), [](const auto& a, const auto& b) {
        return a.substeps * a.iterations < b.substeps * b.iterations;
    });
    if (sources.step.size() < 2 || sources.residual.size() < 2) return std::nullopt;
    return sources;
}

const Point* cheapest(const CaseResult& result, const Contender& contender, double target) {
    const Point* best = nullptr;
    for (const Point& point : result.points)
        if (is_of(point, contender) && point.failure.empty() && surely_at_most(result, point) <= target &&
            (!best || point.seconds.value < best->seconds.value))
            best = &point;
    return best;
}

const Point* cheapest(const CaseResult& result, double target) {
    const Point* best = nullptr;
    for (const Contender& contender : contenders_in(result))
        if (const Point* point = cheapest(result, contender, target);
            point && (!best || point->seconds.value < best->seconds.value))
            best = point;
    return best;
}

std::vector<const Point*> frontier_of(const CaseResult& result) {
    std::vector<const Point*> frontier;
    for (const Point& point : result.points) {
        if (!point.failure.empty()) continue;
        const auto is_better = [&](const Point& other) {
            return other.failure.empty() && other.seconds.value < point.seconds.value &&
                   surely_at_most(result, other) <= surely_at_most(result, point);
        };
        if (std::none_of(result.points.begin(), result.points.end(), is_better)) frontier.push_back(&point);
    }
    return frontier;
}

}  // namespace carom::accuracy
