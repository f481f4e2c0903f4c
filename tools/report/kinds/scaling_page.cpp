#include "report/kinds/measured.hpp"

namespace carom::report {
namespace {

Chart scaling_chart(const std::vector<Result>& results) {
    Chart chart{.id = "scaling",
                .title = "Time against the number of bodies",
                .x_label = "bodies",
                .y_label = "time a body and step (ns)",
                .log_x = true,
                .log_y = true,
                .series = {},
                .slopes = {{.slope = 1, .name = "O(N^2) a step"}},
                .note =
                    "Medians of all rounds with their quartiles; a flat line is time in proportion to the "
                    "number of bodies."};
    for (std::size_t i = 0; i < results.size(); ++i)
        for (const Json& row : results[i].json.at("rows")) {
            const std::string name = row.at("method").get<std::string>() + tag_of(results, i);
            series_named(chart.series, name)
                .points.push_back(spread_point(row.at("bodies").get<double>(), row.at("ns_per_body")));
        }
    return chart;
}

/// What the fit and the crossovers say, a sentence each.
void add_findings(const Json& scaling, const std::string& tag, Page& page) {
    for (const Json& fit : scaling.at("complexity"))
        page.paragraph(fit.at("method").get<std::string>() + tag + ": time a step grows as N^" +
                       digits(fit.at("exponent").get<double>(), 3) + " (standard error " +
                       digits(fit.at("exponent_error").get<double>(), 2) + ") from " +
                       fit.at("from_bodies").dump() + " bodies on; nearest is " +
                       fit.at("nearest").get<std::string>() + ".");
    for (const Json& crossover : scaling.at("crossovers")) {
        std::string text = crossover.at("to").get<std::string>() + tag + " is faster than " +
                           crossover.at("from").get<std::string>();
        if (crossover.contains("bodies"))
            text += " from " + digits(crossover.at("bodies").at("median").get<double>(), 3) + " bodies on (" +
                    digits(crossover.at("bodies").at("low").get<double>(), 3) + " to " +
                    digits(crossover.at("bodies").at("high").get<double>(), 3) + ")";
        else if (crossover.contains("at_every_size_from"))
            text += " at every size measured";
        else
            text += " at no size measured";
        page.paragraph(text + "; at " + crossover.at("ratio_at").dump() + " bodies " +
                       digits(crossover.at("ratio").at("median").get<double>(), 3) + " times.");
    }
}

}  // namespace

void draw_scaling(const std::vector<Result>& results, Page& page) {
    page.set_title("Time against the number of bodies");
    add_origins(results, page);
    page.chart(scaling_chart(results));
    Table table{.caption = "One step of the gas",
                .headers = {"method", "bodies", "ns a body", "lower quartile", "upper quartile",
                            "candidate pairs a body", "contacts a body", "bytes a body"},
                .rows = {},
                .sortable = true};
    for (std::size_t i = 0; i < results.size(); ++i) {
        add_findings(results[i].json, tag_of(results, i), page);
        for (const Json& row : results[i].json.at("rows")) {
            const auto number = [&](const char* key) { return digits(row.at(key).get<double>()); };
            const auto spread = [&](const char* key) {
                return digits(row.at("ns_per_body").at(key).get<double>());
            };
            table.rows.push_back({row.at("method").get<std::string>() + tag_of(results, i),
                                  row.at("bodies").dump(), spread("median"), spread("low"), spread("high"),
                                  number("pairs_per_body"), number("contacts_per_body"),
                                  number("bytes_per_body")});
        }
    }
    page.table(table);
}

}  // namespace carom::report
