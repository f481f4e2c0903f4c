#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "report/kinds/kinds.hpp"
#include "report/page/heat_map.hpp"

// Cases x solvers x precisions: a number and its mark in each cell, and what fails in a list; where envelopes
// end.

namespace carom::report {
namespace {

std::string number(double value, const char* pattern = "%.3g") {
    char text[32];
    std::snprintf(text, sizeof text, pattern, value);
    return text;
}

/// An end of a bracket, or of a range: 1280 as it is.
std::string end_text(double value) {
    return number(value, "%.4g");
}

/// The share of its mark that a measure takes up; one without a number is beyond every mark.
double share_of(const Json& measure) {
    const double share = number_of(measure.at("share"));
    return std::isnan(share) ? HUGE_VAL : share;
}

std::string mark_text(const Json& measure) {
    return (measure.contains("at_least") ? "≥ " : "≤ ") + number(measure.at("mark").get<double>());
}

std::string words_of(const Json& measure) {
    std::string text = plain(measure.at("name")) + " " + number(number_of(measure.at("value")));
    if (measure.contains("mark"))
        text += " (" + mark_text(measure) + (measure.at("passed").get<bool>() ? ")" : "; fails)");
    return text;
}

/// The measure that a cell shows: of those that fail the one farthest beyond its mark; else the first, which
/// is what the case is about.
const Json* shown_of(const Json& row) {
    const Json* shown = nullptr;
    for (const Json& measure : row.at("measures")) {
        const bool fails = measure.contains("mark") && !measure.at("passed").get<bool>();
        if (fails && (!shown || share_of(measure) > share_of(*shown))) shown = &measure;
    }
    return shown || row.at("measures").empty() ? shown : &row.at("measures").front();
}

bool has_failed(const Json& row) {
    return row.contains("passed") && !row.at("passed").get<bool>();
}

// Shares of the mark at which the next level begins: a log scale, four levels of it beyond the mark.
constexpr double kLevelEnds[] = {1e-3, 1e-2, 0.1, 0.5, 1, 2, 10, 100};

int level_of(double share) {
    int level = 0;
    for (const double end : kLevelEnds) level += share > end ? 1 : 0;
    return level;
}

const std::vector<HeatKey>& keys_of_marks() {
    static const std::vector<HeatKey> keys{{"below 0.1 % of the mark", 0},
                                           {"below 1 %", 1},
                                           {"below 10 %", 2},
                                           {"below half of it", 3},
                                           {"passes", 4},
                                           {"✗ up to 2 × the mark", 5},
                                           {"✗ up to 10 ×", 6},
                                           {"✗ up to 100 ×", 7},
                                           {"✗ beyond, or no number", 8},
                                           {"refused by the solver", -1, true},
                                           {"= run under auto", -1, true}};
    return keys;
}

/// All that is known of a row, for the hover.
std::string story_of(const Json& row) {
    std::string text =
        plain(row.at("scene")) + "\n" + plain(row.at("solver")) + ", " + plain(row.at("precision"));
    if (const std::string failure = plain(row.at("failure")); !failure.empty()) text += "\n" + failure;
    for (const Json& measure : row.at("measures")) text += "\n" + words_of(measure);
    return text;
}

HeatCell struck(const Json& row) {
    const bool is_refused = row.at("status") == "refused";
    return {.text = is_refused ? "–" : "=",
            .hover = is_refused ? "refused: " + plain(row.at("failure"))
                                : plain(row.at("solver")) + " is what auto takes here",
            .is_struck = true};
}

HeatCell cell_of(const Json& row) {
    if (row.at("status") != "ran") return struck(row);
    HeatCell cell{.text = "no number", .hover = story_of(row)};
    const Json* const shown = shown_of(row);
    if (shown) {
        cell.text = number(number_of(shown->at("value"))), cell.small = plain(shown->at("name"));
        if (shown->contains("mark")) {
            cell.small += " " + mark_text(*shown);
            cell.level = level_of(share_of(*shown));
        }
    }
    if (const std::string failure = plain(row.at("failure")); !failure.empty())
        cell.level = kHeatLevels - 1, cell.small = failure;
    if (has_failed(row)) cell.text = "✗ " + cell.text;
    return cell;
}

/// How far an envelope reached between its ends, 0 to 1; below 0 if not even the easiest held.
double reach_of(const Json& bracket, const Json& envelope) {
    const double holds = number_of(bracket.at("holds"));
    if (std::isnan(holds)) return -1;
    const double first = envelope.at("first").get<double>(), last = envelope.at("last").get<double>();
    if (envelope.at("linear").get<bool>()) return (holds - first) / (last - first);
    return std::log(holds / first) / std::log(last / first);
}

HeatCell bracket_cell(const Json& row, const Json& envelope) {
    if (!row.contains("bracket")) return cell_of(row);
    const Json& bracket = row.at("bracket");
    const double holds = number_of(bracket.at("holds")), fails = number_of(bracket.at("fails"));
    const double reach = reach_of(bracket, envelope);
    HeatCell cell{.hover = plain(row.at("solver")) + ", " + plain(row.at("precision"))};
    if (std::isnan(holds)) {
        const bool is_unknown = std::isnan(fails);
        cell.text = is_unknown ? "unknown" : "✗ none", cell.level = is_unknown ? -1 : kHeatLevels - 1;
    } else {
        cell.text = end_text(holds),
        cell.level = reach >= 1 ? 0 : 5 - static_cast<int>(std::fmin(5 * reach, 4.99));
    }
    if (!std::isnan(fails)) cell.small = "not at " + end_text(fails);
    if (std::isnan(fails) && reach >= 1) cell.small = "as far as asked";
    if (bracket.at("out_of_time").get<bool>())
        cell.small += (cell.small.empty() ? "" : ", ") + std::string("out of time");
    if (const std::string reason = plain(bracket.at("reason")); !reason.empty())
        cell.hover += "\nat " + end_text(fails) + ": " + reason;
    cell.hover += "\nruns: " + plain(bracket.at("runs"));
    return cell;
}

/// The heat map of some rows, a line a scene.
class Matrix {
  public:
    using CellOf = std::function<HeatCell(const Json& row)>;

    explicit Matrix(std::string corner) { map_.corner = std::move(corner); }

    void add(const Json& row, const CellOf& cell_of_row) {
        const std::string scene = plain(row.at("scene")), solver = plain(row.at("solver")),
                          precision = plain(row.at("precision"));
        const std::size_t column = place_in(columns_, solver + "\n" + precision),
                          line = place_in(lines_, scene);
        if (column == map_.columns.size()) map_.columns.push_back({solver, precision});
        if (line == map_.rows.size()) map_.rows.push_back({.name = scene});
        std::vector<HeatCell>& cells = map_.rows[line].cells;
        cells.resize(std::max(cells.size(), column + 1));
        cells[column] = cell_of_row(row);
    }
    void note(const std::string& scene, const std::string& text) {
        const auto line = lines_.find(scene);
        if (line != lines_.end()) map_.rows[line->second].small = text;
    }
    /// Columns of one solver side by side.
    HeatMap map() const {
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < map_.columns.size(); ++i)
            for (std::size_t j = 0; j < map_.columns.size(); ++j)
                if (map_.columns[j].group == map_.columns[i].group &&
                    std::find(order.begin(), order.end(), j) == order.end())
                    order.push_back(j);
        HeatMap sorted{.caption = map_.caption, .corner = map_.corner};
        for (const std::size_t column : order) sorted.columns.push_back(map_.columns[column]);
        for (const HeatRow& row : map_.rows) {
            HeatRow& own = sorted.rows.emplace_back(HeatRow{row.name, row.small, {}});
            for (const std::size_t column : order)
                own.cells.push_back(column < row.cells.size() ? row.cells[column] : HeatCell{});
        }
        return sorted;
    }

  private:
    static std::size_t place_in(std::map<std::string, std::size_t>& places, const std::string& name) {
        return places.try_emplace(name, places.size()).first->second;
    }
    HeatMap map_;
    std::map<std::string, std::size_t> columns_, lines_;
};

void add_map(const Matrix& matrix, Page& page) {
    page.block([html = heat_map_html(matrix.map())](std::ostream& out) { out << html; });
}

/// How each solver did: what ran, passed, was refused.
void add_counts(const Json& json, Page& page) {
    struct Count {
        std::string solver, precision;
        int ran = 0, failed = 0, refused = 0;
    };
    std::vector<Count> counts;
    for (const Json& row : json.at("rows")) {
        if (row.contains("bracket")) continue;  // they have no marks
        const std::string solver = plain(row.at("solver")), precision = plain(row.at("precision"));
        auto count = std::find_if(counts.begin(), counts.end(), [&](const Count& each) {
            return each.solver == solver && each.precision == precision;
        });
        if (count == counts.end()) count = counts.insert(counts.end(), {solver, precision});
        count->ran += row.at("status") == "ran" ? 1 : 0;
        count->refused += row.at("status") == "refused" ? 1 : 0;
        count->failed += has_failed(row) ? 1 : 0;
    }
    counts.erase(
        std::remove_if(counts.begin(), counts.end(), [](const Count& each) { return each.ran == 0; }),
        counts.end());
    if (counts.empty()) return;
    std::stable_sort(counts.begin(), counts.end(),
                     [](const Count& a, const Count& b) { return a.precision > b.precision; });
    Table table{.caption = "How many runs pass",
                .headers = {"solver", "precision", "ran", "passed", "failed", "refused"},
                .sortable = true};
    for (const Count& count : counts)
        table.rows.push_back({count.solver, count.precision, std::to_string(count.ran),
                              std::to_string(count.ran - count.failed), std::to_string(count.failed),
                              std::to_string(count.refused)});
    page.table(table);
}

void add_failures(const std::vector<const Json*>& rows, Page& page) {
    Table table{.caption = "What fails",
                .headers = {"scene", "solver", "precision", "times its mark", "why"},
                .sortable = true};
    for (const Json* row : rows) {
        if (!has_failed(*row)) continue;
        std::string why = plain(row->at("failure"));
        double most = 0;
        for (const Json& measure : row->at("measures")) {
            if (!measure.contains("mark") || measure.at("passed").get<bool>()) continue;
            most = std::fmax(most, share_of(measure));
            why += (why.empty() ? "" : "; ") + plain(measure.at("name")) + " " +
                   number(number_of(measure.at("value"))) + ", " + mark_text(measure);
        }
        const std::string times = std::isfinite(most) && most > 0 ? number(most) : "–";
        table.rows.push_back(
            {plain(row->at("scene")), plain(row->at("solver")), plain(row->at("precision")), times, why});
    }
    if (table.rows.empty())
        page.paragraph("Nothing fails.");
    else
        page.table(table);
}

void add_legend(const std::vector<HeatKey>& keys, Page& page) {
    page.block([html = heat_legend_html(keys)](std::ostream& out) { out << html; });
}

void draw_case(const std::vector<const Json*>& rows, Page& page) {
    constexpr std::size_t kMostScenes = 300;  // random ones are more: then those that fail are shown alone
    std::map<std::string, bool> scenes;       // whether some solver fails
    for (const Json* row : rows) {
        bool& fails = scenes[plain(row->at("scene"))];
        fails = fails || has_failed(*row);
    }
    const bool are_all_shown = scenes.size() <= kMostScenes;
    if (!are_all_shown)
        page.paragraph("Of " + std::to_string(scenes.size()) +
                       " scenes those that some solver fails are shown.");
    Matrix matrix("scene");
    std::size_t shown = 0;
    for (const Json* row : rows)
        if (are_all_shown || scenes[plain(row->at("scene"))]) matrix.add(*row, cell_of), ++shown;
    if (shown > 0) add_legend(keys_of_marks(), page), add_map(matrix, page);
    add_failures(rows, page);
}

/// Title of an envelope's row without what differs from one to the next of the same name, and that.
void add_chart_of(const std::string& name, const Json& json, const std::vector<const Json*>& rows,
                  Page& page) {
    std::vector<Series> series;
    std::string criterion;
    for (const Json& envelope : json.at("envelopes")) {
        if (envelope.at("name") != name || !envelope.contains("at")) continue;
        criterion = plain(envelope.at("criterion"));
        for (const Json* row : rows) {
            if (row->at("scene") != envelope.at("title") || !row->contains("bracket")) continue;
            const double holds = number_of(row->at("bracket").at("holds"));
            const std::string own = plain(row->at("solver")) + ", " + plain(row->at("precision"));
            auto line = std::find_if(series.begin(), series.end(),
                                     [&](const Series& each) { return each.name == own; });
            if (line == series.end()) line = series.insert(series.end(), {.name = own});
            line->points.push_back({.x = envelope.at("at").get<double>(), .y = holds, .label = own});
        }
    }
    if (series.empty()) return;
    page.chart({.id = "envelope-" + name,
                .title = "The densest gas that each solver holds, by restitution",
                .x_label = "restitution",
                .y_label = "share of the area",
                .series = std::move(series),
                .note = "Holds: " + criterion + "."});
}

void draw_envelopes(const Json& json, const std::vector<const Json*>& rows, Page& page) {
    static const std::vector<HeatKey> keys{{"holds as far as asked", 0},
                                           {"nearly so", 1},
                                           {"", 2},
                                           {"half of the way", 3},
                                           {"", 4},
                                           {"hardly beyond the first value", 5},
                                           {"✗ not even the first", 8},
                                           {"refused by the solver", -1, true},
                                           {"= run under auto", -1, true}};
    page.paragraph(
        "One thing gets harder and harder until the solver does not hold; then the bracket is halved. A cell "
        "has the hardest value that held for every seed, and below it the easiest above that did not. "
        "Colours "
        "say how far that is between the first and the last value that are asked for, as logarithms. A cell "
        "has " +
        plain(json.at("limit_s")) + " s of processor time; one that is out of time says so.");
    add_legend(keys, page);
    Matrix matrix("what gets harder; when it holds");
    for (const Json* row : rows)
        for (const Json& envelope : json.at("envelopes"))
            if (envelope.at("title") == row->at("scene")) {
                matrix.add(*row, [&](const Json& each) { return bracket_cell(each, envelope); });
                matrix.note(plain(row->at("scene")), end_text(envelope.at("first").get<double>()) + " to " +
                                                         end_text(envelope.at("last").get<double>()) + "; " +
                                                         plain(envelope.at("criterion")) + "; seeds: " +
                                                         std::to_string(envelope.at("seeds").size()));
            }
    add_map(matrix, page);
    add_chart_of("density", json, rows, page);
    Table table{.caption = "Why they end",
                .headers = {"what gets harder", "solver", "precision", "holds", "fails", "why"},
                .sortable = true};
    for (const Json* row : rows) {
        if (!row->contains("bracket")) continue;
        const Json& bracket = row->at("bracket");
        const auto text = [&](const char* key) {
            return bracket.at(key).is_null() ? std::string("–") : end_text(bracket.at(key).get<double>());
        };
        std::string why = plain(bracket.at("reason"));
        if (bracket.at("out_of_time").get<bool>())
            why += (why.empty() ? "" : "; ") + std::string("out of time");
        if (!why.empty())
            table.rows.push_back({plain(row->at("scene")), plain(row->at("solver")),
                                  plain(row->at("precision")), text("holds"), text("fails"), why});
    }
    if (!table.rows.empty()) page.table(table);
}

}  // namespace

void draw_torture(const Result& result, Page& page) {
    const Json& json = result.json;
    page.set_title("Hard cases under every solver");
    int failed = 0;
    for (const Json& row : json.at("rows")) failed += has_failed(row) ? 1 : 0;
    if (json.at("quick").get<bool>()) page.warning("A quick run: cases do a part of what they do.");
    if (failed > 0)
        page.warning(std::to_string(failed) + " runs fail; each is listed below its map, with the reason.");
    page.paragraph(
        "Each cell is a scene under a solver, in single or double precision. It has the measured number that "
        "the "
        "case is about, or that is farthest beyond its mark, and the mark; all numbers are on hover. " +
        plain(json.at("version")) + ", " + plain(json.at("isa")) + ", one thread a run.");
    add_counts(json, page);
    for (const Json& each : json.at("cases")) {
        std::vector<const Json*> rows;
        for (const Json& row : json.at("rows"))
            if (row.at("case") == each.at("id")) rows.push_back(&row);
        page.heading(plain(each.at("id")) + ": " + plain(each.at("title")));
        if (rows.empty())
            page.paragraph("Nothing ran.");
        else if (each.at("id") == "envelopes")
            draw_envelopes(json, rows, page);
        else
            draw_case(rows, page);
    }
}

}  // namespace carom::report
