#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "report/kinds/kinds.hpp"

// Error against time, on cases whose answer is known: a section for each case.

namespace carom::report {
namespace {

std::string number(double value, const char* pattern = "%.3g") {
    char text[32];
    std::snprintf(text, sizeof text, pattern, value);
    return text;
}

std::string step_text(double dt) {
    const double rate = 1 / dt;
    return std::fabs(rate - std::round(rate)) < 1e-6 * rate && dt < 1 ? "1/" + number(rate, "%.0f") + " s"
                                                                      : number(dt) + " s";
}

std::string contender_of(const Json& point) {
    return plain(point.at("solver")) + ", " + plain(point.at("precision"));
}

std::string label_of(const Json& point) {
    std::string text = contender_of(point) + ", " + step_text(point.at("dt"));
    if (point.at("substeps") != 1) text += ", " + plain(point.at("substeps")) + " substeps";
    if (point.at("iterations") != 1) text += ", " + plain(point.at("iterations")) + " iterations";
    return text;
}

bool has_failed(const Json& point) {
    return !point.at("failure").is_null();
}

/// Whether the solver says what this error is about.
bool is_known(const Json& point, std::size_t error) {
    return has_failed(point) || !point.at("errors").at(error).at("value").is_null();
}

double work_of(const Json& point) {
    double sum = 0;
    for (const auto& [name, amount] : point.at("work").items()) sum += amount.get<double>();
    return sum;
}

constexpr int kColourOfFailures = 7;

/// A relative error below this is none: 1e-18 of a way is no number that anything computes.
constexpr double kNothing = 1e-18;

/// Where points stand that have no error, or none that a logarithm can show.
struct Edges {
    double top = 1, bottom = 1e-17;
};

Edges edges_of(const Json& result, std::size_t error) {
    Edges edges{.top = 0, .bottom = 1};
    for (const Json& point : result.at("points")) {
        if (has_failed(point) || !is_known(point, error)) continue;
        const double value = point.at("errors").at(error).at("value").get<double>();
        edges.top = std::max(edges.top, value);
        if (value > kNothing) edges.bottom = std::min(edges.bottom, value);
    }
    return {edges.top > 0 ? 10 * edges.top : 1, edges.bottom / 10};
}

Point point_at(const Json& point, std::size_t error, double x, const Edges& edges) {
    if (has_failed(point))
        return {.x = x, .y = edges.top, .label = label_of(point) + ": " + plain(point.at("failure"))};
    const Json& band = point.at("errors").at(error);
    const double value = band.at("value").get<double>();
    if (!(value > kNothing))
        return {.x = x, .y = edges.bottom, .label = label_of(point) + ": no error at all"};
    return {.x = x,
            .y = value,
            .low = std::max(band.at("low").get<double>(), edges.bottom),
            .high = band.at("high").get<double>(),
            .label = label_of(point)};
}

/// A colour of the page's palette for each solver and engine, the same in all charts. `rattle` and `pairwise`
/// have no case in common.
int colour_of(const Json& point) {
    static const std::map<std::string, int> colours{{"event", 0},    {"impulse", 1}, {"soft", 2},
                                                    {"pairwise", 4}, {"Box2D 3", 3}, {"Box2D 2", 6},
                                                    {"Chipmunk", 5}, {"rattle", 4}};
    const auto found = colours.find(plain(point.at("solver")));
    return found != colours.end() ? found->second : kColourOfFailures;
}

bool same_work(const Json& a, const Json& b) {
    return a.at("substeps") == b.at("substeps") && a.at("iterations") == b.at("iterations");
}

/// One line a solver and precision; where another sweep begins it is broken, or with `steps_only` what is not
/// of the sweep over steps is marks alone. Failures are marks of their own at the upper edge.
template <class Abscissa>
std::vector<Series> series_of(const Json& result, std::size_t error, const Abscissa& x_of, bool steps_only) {
    struct Drawn {
        Series line, marks;
        Json first, last;
    };
    std::vector<Drawn> drawn;
    std::map<std::string, std::size_t> place;
    Series failed{.name = "failed", .line = false, .colour = kColourOfFailures};
    const Edges edges = edges_of(result, error);
    for (const Json& point : result.at("points")) {
        if (!is_known(point, error)) continue;
        if (!(x_of(point) > 0)) continue;  // other engines do not count their work
        const Point at = point_at(point, error, x_of(point), edges);
        if (has_failed(point)) {
            failed.points.push_back(at);
            continue;
        }
        const std::string name = contender_of(point);
        if (!place.contains(name)) {
            place[name] = drawn.size();
            const Series line{.name = name, .colour = colour_of(point)};
            const Series marks{.name = name, .line = false, .colour = line.colour, .in_legend = false};
            drawn.push_back({line, marks, point, point});
        }
        Drawn& own = drawn[place[name]];
        if (steps_only && !same_work(point, own.first)) {
            own.marks.points.push_back(at);
            continue;
        }
        const bool by_step = same_work(point, own.first) && same_work(own.last, own.first);
        if (!by_step && point.at("dt") != own.last.at("dt")) own.line.points.push_back({.x = at.x, .y = NAN});
        own.line.points.push_back(at);
        own.last = point;
    }
    std::vector<Series> series;
    for (Drawn& own : drawn) series.push_back(std::move(own.line));
    if (!failed.points.empty()) series.push_back(std::move(failed));
    for (Drawn& own : drawn)
        if (!own.marks.points.empty()) series.push_back(std::move(own.marks));
    return series;
}

void name_orders(const Json& result, const std::string& error, std::vector<Series>& series) {
    for (const Json& fit : result.at("orders"))
        for (Series& each : series)
            if (plain(fit.at("error")) == error && each.in_legend && each.name == contender_of(fit))
                each.name += ": order " + number(fit.at("order").get<double>(), "%.2f");
}

void add_charts(const Json& result, std::size_t error, Page& page) {
    const Json& measure = result.at("errors").at(error);
    const std::string name = plain(measure.at("name")),
                      id = plain(result.at("id")) + "-" + std::to_string(error);
    const std::string meaning = "Error: " + plain(measure.at("meaning")) + ".";
    const std::string y_label = "error of " + name;
    page.chart(
        {.id = id + "-time",
         .title = plain(result.at("id")) + ": error of " + name + " against time",
         .x_label = "time of all steps (s)",
         .y_label = y_label,
         .log_x = true,
         .log_y = true,
         .series = series_of(
             result, error, [](const Json& p) { return p.at("seconds").at("value").get<double>(); }, false),
         .slopes = {{-1, "slope 1"}, {-2, "slope 2"}},
         .note = meaning});
    std::vector<Series> by_step = series_of(
        result, error,
        [](const Json& p) { return p.at("dt").get<double>() / p.at("substeps").get<double>(); }, true);
    name_orders(result, name, by_step);
    page.chart({.id = id + "-step",
                .title = plain(result.at("id")) + ": error of " + name + " against substep",
                .x_label = "step / substeps (s)",
                .y_label = y_label,
                .log_x = true,
                .log_y = true,
                .series = std::move(by_step),
                .slopes = {{1, "slope 1"}, {2, "slope 2"}}});
    if (error > 0) return;
    page.chart({.id = id + "-work",
                .title = plain(result.at("id")) + ": error of " + name + " against work",
                .x_label = "bodies moved + pairs looked at + impacts",
                .y_label = y_label,
                .log_x = true,
                .log_y = true,
                .series = series_of(result, error, work_of, false),
                .note = "The same in units that do not depend on the machine."});
}

void add_times(const Json& result, Page& page) {
    Table table{.caption = "Time to reach an error of " + plain(result.at("errors").at(0).at("name")),
                .headers = {"solver", "1 %", "0.1 %", "0.01 %"},
                .sortable = true};
    std::map<std::string, std::size_t> row;
    for (const Json& time : result.at("time_to_reach")) {
        const std::string name = contender_of(time);
        if (!row.contains(name)) row[name] = table.rows.size(), table.rows.push_back({name});
        table.rows[row[name]].push_back(time.at("seconds").is_null()
                                            ? "–"
                                            : number(1e3 * time.at("seconds").get<double>(), "%.4g") +
                                                  " ms (" + plain(time.at("setting")) + ")");
    }
    page.table(table);
}

/// "0.0428 at 1/30 s, 0.007 at 1/240 s"
std::string parts_text(const Json& parts, bool by_step) {
    std::string text;
    for (const Json& part : parts) {
        const std::string work = part.at("substeps") != 1 || part.at("iterations") == 1
                                     ? plain(part.at("substeps")) + " substeps"
                                     : plain(part.at("iterations")) + " iterations";
        text += (text.empty() ? "" : ", ") + number(part.at("error").get<double>(), "%.2g") +
                (by_step ? " at " + step_text(part.at("dt")) : " with " + work);
    }
    return text;
}

/// What the step does with all the work there is, and what the work does at one step.
void add_sources(const Json& result, Page& page) {
    const Json sources = result.value("sources", Json::array());
    if (sources.empty()) return;
    Table table{.caption =
                    "Where the error comes from: the step at a converged solve, what is unsolved at one "
                    "step. What neither takes away is softness or round-off",
                .headers = {"solver", "step length", "residual"}};
    for (const Json& each : sources)
        table.rows.push_back(
            {contender_of(each), parts_text(each.at("step"), true),
             step_text(each.at("residual").at(0).at("dt")) + ": " + parts_text(each.at("residual"), false)});
    page.table(table);
}

void add_case(const Json& result, Page& page) {
    page.heading(plain(result.at("id")) + ": " + plain(result.at("title")));
    std::string text =
        "Exact: " + plain(result.at("exact")) + ". Effects: " + plain(result.at("effects")) + ".";
    if (result.at("starts") > 1)
        text += " Motion is chaotic, so " + plain(result.at("starts")) +
                " starts are compared (fewer in a quick run): median with 10–90 % band, or mean with "
                "standard error.";
    page.paragraph(text);
    if (result.contains("note")) page.paragraph(plain(result.at("note")));
    std::string failures;
    for (const Json& point : result.at("points"))
        if (has_failed(point))
            failures += (failures.empty() ? "" : "; ") + label_of(point) + ": " + plain(point.at("failure"));
    if (!failures.empty()) page.paragraph("Failed: " + failures + ".");
    for (const Json& out : result.value("left_out", Json::array()))
        page.paragraph("Left out: " + plain(out.at("engine")) + ", because " + plain(out.at("why")) + ".");
    for (std::size_t error = 0; error < result.at("errors").size(); ++error) add_charts(result, error, page);
    add_times(result, page);
    add_sources(result, page);
}

}  // namespace

void draw_accuracy(const Result& result, Page& page) {
    const Json& json = result.json;
    page.set_title("What accuracy costs in time");
    if (json.at("quick").get<bool>()) page.warning("A quick run: few settings, starts and repetitions.");
    page.paragraph(
        "Each case has a known answer. Every solver computes it in single and double precision over a "
        "sweep of steps, substeps and iterations. Lower is nearer the answer, further left is faster. "
        "Times are of stepping alone, on one thread, the median of repeated runs.");
    std::string others;
    for (const Json& engine : json.value("engines", Json::array()))
        others += (others.empty() ? "" : ", ") + plain(engine.at("name")) + " " + plain(engine.at("version"));
    if (!others.empty())
        page.paragraph(
            "Other engines, their errors computed by the same code from the places and speeds they "
            "say: " +
            others +
            ". They run with their defaults, but never sleep and bounce at every "
            "speed.");
    for (const Json& engine : json.value("missing_engines", Json::array()))
        page.paragraph("Not in it: " + plain(engine.at("name")) + ", because " + plain(engine.at("why")) +
                       ".");
    page.heading("Which solver for which scene");
    for (const Json& advice : json.at("advice")) page.paragraph(plain(advice));
    for (const Json& each : json.at("cases")) add_case(each, page);
}

}  // namespace carom::report
