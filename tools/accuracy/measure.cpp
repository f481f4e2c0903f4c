#include "accuracy/measure.hpp"

#include <carom/errors.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {
namespace {

constexpr int kFewestRuns = 3;

struct Run {
    std::vector<double> errors;
    double seconds = 0;
    Work work;
};

Run run_once(const Case& asked, const Setting& setting, int member, double longest) {
    const Scene scene = asked.scene(member);
    Stepper stepper(scene, setting, longest, asked.counts);
    Run run;
    try {
        run.errors = asked.run(stepper, scene, member);
        if (!std::isfinite(run.errors.front())) throw Failure("the error is not a number");
    } catch (Failure& failure) {
        failure.seconds = stepper.seconds();
        throw;
    }
    run.seconds = stepper.seconds(), run.work = stepper.work();
    return run;
}

/// The value below which a part of them lies, between neighbours in proportion.
double quantile(std::vector<double> values, double part) {
    if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); })) return NAN;
    std::sort(values.begin(), values.end());
    const double place = part * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

Band band_of(const std::vector<double>& values) {
    return {quantile(values, 0.5), quantile(values, 0.1), quantile(values, 0.9)};
}

/// Size of the mean, and where it lies within one standard error.
Band statistic_of(const std::vector<double>& values) {
    const double count = static_cast<double>(values.size());
    double mean = 0, squares = 0;
    for (const double value : values) mean += value / count;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double error = count > 1 ? std::sqrt(squares / (count - 1) / count) : 0;
    return {std::fabs(mean), std::max(0.0, std::fabs(mean) - error), std::fabs(mean) + error};
}

Point summary_of(const Case& asked, const Setting& setting, const std::vector<Run>& runs) {
    Point point;
    point.setting = setting;
    point.runs = static_cast<int>(runs.size());
    for (std::size_t e = 0; e < asked.errors.size(); ++e) {
        std::vector<double> values;
        for (const Run& run : runs) values.push_back(run.errors[e]);
        if (asked.errors[e].is_statistic) {
            point.errors.push_back(statistic_of(values));
            continue;
        }
        for (double& value : values) value = std::fabs(value);
        point.errors.push_back(band_of(values));
    }
    std::vector<double> seconds;
    const double count = static_cast<double>(runs.size());
    for (const Run& run : runs) {
        seconds.push_back(run.seconds);
        point.work.body_substeps += run.work.body_substeps / count;
        point.work.pair_tests += run.work.pair_tests / count;
        point.work.impacts += run.work.impacts / count;
    }
    point.seconds = band_of(seconds);
    return point;
}

Point failed(const Setting& setting, int runs, const std::string& why, double seconds = 0) {
    Point point;
    point.seconds = {seconds, seconds, seconds};
    point.setting = setting;
    point.runs = runs;
    point.failure = why;
    return point;
}

}  // namespace

std::optional<Point> measure(const Case& asked, const Setting& setting, const Effort& effort,
                             const std::function<bool()>& stop) {
    const int members = std::min(asked.members, effort.most_members);
    std::vector<Run> runs;
    double spent = 0;
    try {
        const auto is_enough = [&] {
            const int done = static_cast<int>(runs.size());
            if (members > 1) return done >= members;
            return done >= effort.most_runs || (done >= kFewestRuns && spent > effort.seconds_a_point) ||
                   spent > effort.long_run;
        };
        while (!is_enough()) {
            if (stop()) return std::nullopt;
            runs.push_back(run_once(asked, setting, members > 1 ? static_cast<int>(runs.size()) : 0,
                                    effort.longest_run));
            spent += runs.back().seconds;
        }
    } catch (const Failure& failure) {
        return failed(setting, static_cast<int>(runs.size()) + 1, failure.what(), failure.seconds);
    } catch (const Error& refusal) {
        return failed(setting, 0, refusal.what());
    }
    return summary_of(asked, setting, runs);
}

}  // namespace carom::accuracy
