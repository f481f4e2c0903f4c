#include "report/kinds/measured.hpp"

namespace carom::report {
namespace {

std::string list_of(const Json& names) {
    std::string text;
    for (const Json& name : names) text += (text.empty() ? "" : ", ") + name.get<std::string>();
    return text;
}

std::string percent(const Json& spread) {
    return digits(100 * spread.at("median").get<double>(), 3) + " (" +
           digits(100 * spread.at("low").get<double>(), 3) + " to " +
           digits(100 * spread.at("high").get<double>(), 3) + ")";
}

}  // namespace

void draw_prices(const std::vector<Result>& results, Page& page) {
    page.set_title("Prices of effects");
    add_origins(results, page);
    page.paragraph(results.front().json.at("method").get<std::string>());
    Chart chart{.id = "prices",
                .title = "What carrying an effect costs",
                .x_label = "",
                .y_label = "price (% of a step without it)",
                .series = {},
                .bars = true};
    Table table{.caption = "Effects",
                .headers = {"effect", "called for", "ns a body and step", "% of a step", "in use, %",
                            "bytes a body", "columns", "stages", "other kernels", "same bits", "no price"},
                .rows = {},
                .sortable = true};
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Json& json = results[i].json;
        Series series{.name = json.at("scene").get<std::string>() + tag_of(results, i)};
        for (const Json& effect : json.at("effects")) {
            const std::string name = effect.at("name").get<std::string>();
            std::vector<std::string> row{name + tag_of(results, i),
                                         effect.at("called").get<bool>() ? "yes" : "no"};
            if (effect.contains("no_price")) {
                row.resize(table.headers.size() - 1);
                row.push_back(effect.at("no_price").get<std::string>());
                table.rows.push_back(std::move(row));
                continue;
            }
            Point point = spread_point(0, effect.at("share"), 100);
            point.label = name;
            series.points.push_back(std::move(point));
            row.push_back(digits(effect.at("ns_per_body_step").at("median").get<double>(), 3));
            row.push_back(percent(effect.at("share")));
            row.push_back(effect.contains("in_use") ? percent(effect.at("in_use").at("share")) : "");
            row.push_back(digits(effect.at("memory_bytes_per_body").get<double>(), 3));
            for (const char* key : {"columns", "stages", "kernels"}) row.push_back(list_of(effect.at(key)));
            row.push_back(effect.at("same_bits").get<bool>() ? "yes" : "no");
            row.push_back(effect.contains("solver_with")
                              ? "with it the solver is " + effect.at("solver_with").get<std::string>()
                              : "");
            table.rows.push_back(std::move(row));
        }
        chart.series.push_back(std::move(series));
    }
    page.chart(std::move(chart));
    page.table(table);
}

}  // namespace carom::report
