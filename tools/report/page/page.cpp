#include "report/page/page.hpp"

#include <ostream>
#include <sstream>
#include <utility>

#include "report/page/assets.hpp"

namespace carom::report {
namespace {

// Nothing may be fetched: neither by us nor by what a name in a scene might try.
constexpr const char* kHead =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<meta name=\"color-scheme\" content=\"light dark\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:\">\n";

void write_assets(std::ostream& out, bool styles) {
    for (const Asset& asset : assets()) {
        if (!asset.name.ends_with(styles ? ".css" : ".js")) continue;
        out << (styles ? "<style>\n" : "<script>\n");
        for (const std::string_view piece : asset.pieces) out << piece;
        out << (styles ? "\n</style>\n" : "\n</script>\n");
    }
}

void write_data(std::ostream& out, const std::string& id, const Json& json) {
    out << "<script type=\"application/json\" id=\"" << as_html(id) << "\">" << as_script_data(json)
        << "</script>\n";
}

void write_chart(std::ostream& out, const Chart& chart) {
    const std::string id = as_html(chart.id), title = as_html(chart.title);
    out << "<figure class=\"chart\" id=\"chart-" << id << "\"><figcaption>" << title
        << "</figcaption>\n<div class=\"plot\"><canvas role=\"img\" aria-label=\"" << title
        << "\"></canvas></div>\n";
    if (!chart.note.empty()) out << "<p class=\"note\">" << as_html(chart.note) << "</p>\n";
    out << "</figure>\n";
    write_data(out, "data-" + chart.id, chart_json(chart));
}

std::string table_html(const Table& table) {
    std::string html = "<div class=\"scroll\" tabindex=\"0\"><table";
    html += table.sortable ? " class=\"sortable\">\n" : ">\n";
    if (!table.caption.empty()) html += "<caption>" + as_html(table.caption) + "</caption>\n";
    html += "<thead><tr>";
    for (const std::string& header : table.headers) html += "<th scope=\"col\">" + as_html(header) + "</th>";
    html += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
        html += "<tr>";
        for (const std::string& cell : row) html += "<td>" + as_html(cell) + "</td>";
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

}  // namespace

void Page::add(std::string html) {
    parts_.push_back({.write = [html = std::move(html)](std::ostream& out) { out << html; }});
}

void Page::heading(std::string text) {
    add("<h2>" + as_html(text) + "</h2>\n");
}

void Page::paragraph(const std::string& text) {
    add("<p>" + as_html(text) + "</p>\n");
}

void Page::warning(const std::string& text) {
    warnings_.push_back(text);
}

void Page::chart(Chart chart) {
    parts_.push_back({.write = {}, .chart = std::move(chart)});
}

void Page::table(const Table& table) {
    add(table_html(table));
}

void Page::block(std::function<void(std::ostream&)> write) {
    parts_.push_back({.write = std::move(write)});
}

void Page::append(Page section, const std::string& prefix) {
    heading(section.title_);
    for (const std::string& text : section.warnings_) warnings_.push_back(section.title_ + ": " + text);
    for (Part& part : section.parts_) {
        if (part.chart) part.chart->id = prefix + part.chart->id;
        parts_.push_back(std::move(part));
    }
}

void Page::write(std::ostream& out) const {
    out << kHead << "<title>" << as_html(title_) << "</title>\n";
    write_assets(out, true);
    out << "</head>\n<body>\n<main>\n<h1>" << as_html(title_) << "</h1>\n";
    for (const std::string& text : warnings_)
        out << "<p class=\"warning\" role=\"alert\">" << as_html(text) << "</p>\n";
    bool in_charts = false;
    for (const Part& part : parts_) {
        const bool is_chart = part.chart.has_value();
        if (is_chart != in_charts) out << (in_charts ? "</div>\n" : "<div class=\"charts\">\n");
        in_charts = is_chart;
        if (is_chart)
            write_chart(out, *part.chart);
        else
            part.write(out);
    }
    if (in_charts) out << "</div>\n";
    out << "</main>\n";
    write_assets(out, false);
    out << "</body>\n</html>\n";
}

std::string Page::html() const {
    std::ostringstream out;
    write(out);
    return std::move(out).str();
}

}  // namespace carom::report
