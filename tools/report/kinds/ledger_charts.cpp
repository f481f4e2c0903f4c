#include "report/kinds/ledger_charts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace carom::report {
namespace {

constexpr const char* kTime = "time (s)";
constexpr double kMostImpacts = 1e15;  // beyond, and where it is no number, the file is damaged

struct Cause {
    const char* column;
    int colour;  // the same in every chart
};
constexpr std::array<Cause, 7> kCauses{{{"gravity", 0},
                                        {"drag", 1},
                                        {"restitution", 2},
                                        {"friction", 3},
                                        {"correction", 4},
                                        {"joints", 5},
                                        {"drive", 6}}};

Series over_time(const std::vector<double>& time, const std::vector<double>& values, std::string name,
                 int colour) {
    Series series{.name = std::move(name), .colour = colour};
    for (std::size_t i = 0; i < std::min(time.size(), values.size()); ++i)
        series.points.push_back({.x = time[i], .y = values[i]});
    return series;
}

Chart time_chart(std::string id, std::string title, std::string y_label) {
    return {.id = std::move(id),
            .title = std::move(title),
            .x_label = kTime,
            .y_label = std::move(y_label),
            .follows_time = true};
}

/// The times at which impacts were counted since the row before.
Marks impacts_of(const NumberTable& ledger) {
    Marks marks{.name = "impacts"};
    const std::vector<double>&time = ledger.at("time"), &impacts = ledger.at("impacts");
    double before = 0;
    for (std::size_t i = 0; i < impacts.size(); ++i) {
        if (impacts[i] > before) marks.x.push_back(time[i]);
        before = impacts[i];
    }
    return marks;
}

void add_energy(const NumberTable& ledger, Page& page) {
    Chart chart = time_chart("energy", "Energy", "energy (J)");
    const std::vector<double>& time = ledger.at("time");
    int colour = 0;
    for (const char* column : {"kinetic", "rotational", "potential", "total"})
        chart.series.push_back(over_time(time, ledger.at(column), column, colour++));
    chart.marks = impacts_of(ledger);
    const std::vector<double>& impacts = ledger.at("impacts");
    if (!impacts.empty() && impacts.back() > 0 && impacts.back() < kMostImpacts)
        chart.note = "Marks on the time axis: steps in which bodies or walls collided, " +
                     std::to_string(static_cast<long long>(impacts.back())) + " impacts in all.";
    page.chart(std::move(chart));
}

void add_momentum(const NumberTable& ledger, Page& page) {
    const std::vector<double>& time = ledger.at("time");
    Chart linear = time_chart("momentum", "Momentum", "momentum (kg m/s)");
    linear.series = {over_time(time, ledger.at("px"), "momentum x", 0),
                     over_time(time, ledger.at("py"), "momentum y", 1)};
    page.chart(std::move(linear));
    Chart angular = time_chart("angular-momentum", "Angular momentum", "angular momentum (kg m\u00b2/s)");
    angular.series = {over_time(time, ledger.at("L"), "angular momentum", 2)};
    angular.note = "About the origin, spin included.";
    page.chart(std::move(angular));
}

void add_wall_impulse(const NumberTable& ledger, Page& page) {
    const std::vector<double>& impulse = ledger.at("wall_impulse");
    if (impulse.empty() || impulse.back() == 0) return;
    Chart chart = time_chart("wall-impulse", "Impulse on the walls", "sum of sizes since the start (N s)");
    chart.series = {over_time(ledger.at("time"), impulse, "impulse", 4)};
    chart.note = "Its slope, divided by the walls' length, is the pressure.";
    page.chart(std::move(chart));
}

/// A cause that gives at times and takes at others is two areas of one colour, one on each side of zero.
void add_areas(const std::vector<double>& time, const std::vector<double>& work, const Cause& cause,
               Chart& chart) {
    bool in_legend = true;
    for (const bool gains : {true, false}) {
        Series series{
            .name = cause.column, .area = true, .stack = gains ? "gains" : "losses", .colour = cause.colour};
        bool any = false;
        for (std::size_t i = 0; i < work.size(); ++i) {
            const double part = gains ? std::max(work[i], 0.0) : std::min(work[i], 0.0);
            series.points.push_back({.x = time[i], .y = part});
            any = any || part != 0;
        }
        if (!any) continue;
        series.in_legend = in_legend;
        in_legend = false;
        chart.series.push_back(std::move(series));
    }
}

void add_causes(const NumberTable& ledger, Page& page) {
    const std::vector<double>& time = ledger.at("time");
    Chart causes = time_chart("causes", "Where the energy went", "work since the start (J)");
    for (const Cause& cause : kCauses) add_areas(time, ledger.at(cause.column), cause, causes);
    if (causes.series.empty()) causes.series.push_back({.name = "none"});
    causes.note =
        "Work done on the bodies by each cause, stacked: gains above zero, losses below. Gravity's work is "
        "minus the change of potential energy.";
    page.chart(std::move(causes));
    Chart rest = time_chart("unexplained", "What the causes do not explain", "unexplained (J)");
    rest.series = {over_time(time, ledger.at("unexplained"), "unexplained", 7)};
    rest.note =
        "The error of the run: what the state says minus what the causes add up to, on a scale of its own.";
    page.chart(std::move(rest));
}

std::vector<double> numbers(const Json& values) {
    std::vector<double> numbers;
    for (const Json& value : values) numbers.push_back(number_of(value));
    return numbers;
}

}  // namespace

void add_ledger_charts(const NumberTable& ledger, Page& page) {
    add_energy(ledger, page);
    add_momentum(ledger, page);
    add_wall_impulse(ledger, page);
    add_causes(ledger, page);
}

void add_contact_charts(const Json& summary, Page& page) {
    const auto course = summary.find("contacts_over_time");
    if (course == summary.end()) return;
    const std::vector<double> time = numbers(course->at("time"));
    Chart count = time_chart("contacts", "Contacts", "touching contacts");
    count.series = {over_time(time, numbers(course->at("touching")), "touching", 0)};
    page.chart(std::move(count));
    Chart overlap = time_chart("overlap", "Overlap of touching bodies", "overlap (% of the smaller radius)");
    for (const auto& [key, name, colour] :
         {std::tuple{"overlap_mean", "mean", 0}, {"overlap_max", "largest", 1}}) {
        std::vector<double> percent = numbers(course->at(key));
        for (double& value : percent) value *= 100;
        overlap.series.push_back(over_time(time, percent, name, colour));
    }
    page.chart(std::move(overlap));
}

}  // namespace carom::report
