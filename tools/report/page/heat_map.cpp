#include "report/page/heat_map.hpp"

#include "report/page/markup.hpp"

namespace carom::report {
namespace {

std::string class_of(int level, bool is_struck) {
    std::string name = "heat";
    if (level >= 0) name += " heat-" + std::to_string(level);
    if (is_struck) name += " struck";
    return name;
}

std::string small_html(const std::string& text) {
    return text.empty() ? "" : "<small>" + as_html(text) + "</small>";
}

std::string cell_html(const HeatCell& cell) {
    if (cell.text.empty()) return "<td></td>";
    std::string html = "<td class=\"" + class_of(cell.level, cell.is_struck) + "\"";
    if (!cell.hover.empty()) html += " title=\"" + as_html(cell.hover) + "\"";
    return html + ">" + as_html(cell.text) + small_html(cell.small) + "</td>";
}

/// Groups over their columns, then the columns.
std::string head_html(const HeatMap& map) {
    std::string groups, names;
    for (std::size_t i = 0; i < map.columns.size();) {
        std::size_t end = i;
        while (end < map.columns.size() && map.columns[end].group == map.columns[i].group) ++end;
        groups += "<th scope=\"colgroup\" colspan=\"" + std::to_string(end - i) + "\">" +
                  as_html(map.columns[i].group) + "</th>";
        for (; i < end; ++i) names += "<th scope=\"col\">" + as_html(map.columns[i].name) + "</th>";
    }
    return "<thead><tr><th scope=\"col\" rowspan=\"2\">" + as_html(map.corner) + "</th>" + groups +
           "</tr>\n<tr>" + names + "</tr></thead>\n";
}

}  // namespace

std::string heat_map_html(const HeatMap& map) {
    std::string html = "<div class=\"scroll\" tabindex=\"0\"><table class=\"heat-map\">\n";
    if (!map.caption.empty()) html += "<caption>" + as_html(map.caption) + "</caption>\n";
    html += head_html(map) + "<tbody>\n";
    for (const HeatRow& row : map.rows) {
        html += "<tr><th scope=\"row\">" + as_html(row.name) + small_html(row.small) + "</th>";
        for (const HeatCell& cell : row.cells) html += cell_html(cell);
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string heat_legend_html(const std::vector<HeatKey>& keys) {
    std::string html = "<p class=\"heat-legend\">";
    for (const HeatKey& key : keys)
        html +=
            "<span class=\"" + class_of(key.level, key.is_struck) + "\">" + as_html(key.text) + "</span> ";
    return html + "</p>\n";
}

}  // namespace carom::report
