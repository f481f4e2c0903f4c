#include "torture/tables.hpp"

#include <algorithm>
#include <cmath>

#include "measure/text.hpp"
#include "torture/verdicts.hpp"

namespace carom::torture {
namespace {

using measure::format;
using measure::joined;

std::string cell_of(const Measure& measure) {
    return joined(format("%.3g", measure.value), measure.passes() ? " " : "!");
}

/// Cells, and a text behind them that has no column.
struct Line {
    std::vector<std::string> cells;
    std::string remark{};
};

/// Columns are as wide as their widest cell; the first `left` of them begin at the left.
std::string aligned(const std::vector<Line>& all, std::size_t left) {
    std::vector<int> widths;
    for (const auto& [line, remark] : all) {
        widths.resize(std::max(widths.size(), line.size()), 0);
        for (std::size_t i = 0; i < line.size(); ++i)
            widths[i] = std::max(widths[i], static_cast<int>(line[i].size()));
    }
    std::string text;
    for (const auto& [line, remark] : all) {
        std::string one;
        for (std::size_t i = 0; i < line.size(); ++i)
            one += format(i < left ? "  %-*s" : "  %*s", widths[i], line[i].c_str());
        one += "  " + remark;
        one.erase(one.find_last_not_of(' ') + 1);
        text += one + '\n';
    }
    return text;
}

std::string mark_of(const Measure& measure) {
    return measure.mark ? format("%s %.3g ", measure.sense == Sense::at_least ? ">=" : "<=", *measure.mark)
                        : "told ";
}

constexpr std::size_t kTextColumns = 4;  // verdict, scene, solver, precision

Line line_of(const Row& row) {
    Line line{{row.has_failed() ? "FAIL" : "PASS", row.scene, row.solver, row.precision},
              row.outcome.failure};
    for (const Measure& measure : row.outcome.measures) line.cells.push_back(cell_of(measure));
    return line;
}

bool have_one_head(const Row& a, const Row& b) {
    return std::equal(a.outcome.measures.begin(), a.outcome.measures.end(), b.outcome.measures.begin(),
                      b.outcome.measures.end(), [](const Measure& one, const Measure& other) {
                          return one.name == other.name && one.mark == other.mark;
                      });
}

/// Rows that measure the same follow each other under one head: names, and below them the marks.
std::string full_table(std::span<const Row> rows) {
    std::string text;
    std::vector<Line> lines;
    const Row* last = nullptr;
    for (const Row& row : rows) {
        const bool is_new = !row.outcome.measures.empty() && (!last || !have_one_head(row, *last));
        if (is_new) {
            text += aligned(lines, kTextColumns);
            lines = {{{"", "scene", "solver", "precision"}}, {{"", "", "", "mark"}}};
            for (const Measure& measure : row.outcome.measures)
                lines[0].cells.push_back(measure.name + " "), lines[1].cells.push_back(mark_of(measure));
            last = &row;
        }
        lines.push_back(line_of(row));
    }
    return text + aligned(lines, kTextColumns);
}

/// One line a solver and precision: how many passed, the largest of every number.
std::string summary_table(std::span<const Row> rows) {
    struct Sum {
        std::string solver, precision;
        int rows = 0, failed = 0, unfinished = 0;
        std::vector<Measure> largest;
    };
    std::vector<Sum> sums;
    for (const Row& row : rows) {
        auto sum = std::find_if(sums.begin(), sums.end(), [&](const Sum& each) {
            return each.solver == row.solver && each.precision == row.precision;
        });
        if (sum == sums.end()) sum = sums.insert(sums.end(), {row.solver, row.precision, 0, 0, 0, {}});
        ++sum->rows, sum->failed += row.has_failed(), sum->unfinished += !row.outcome.failure.empty();
        if (sum->largest.empty()) sum->largest = row.outcome.measures;
        for (std::size_t i = 0; i < std::min(sum->largest.size(), row.outcome.measures.size()); ++i)
            if (!(row.outcome.measures[i].value <= sum->largest[i].value))
                sum->largest[i].value = row.outcome.measures[i].value;
    }
    if (sums.empty()) return {};
    std::vector<Line> lines{{{"", "solver", "precision", "runs", "failed", "not ended"}},
                            {{"", "", "largest; mark", "", "", ""}}};
    const auto with_head = std::max_element(sums.begin(), sums.end(), [](const Sum& a, const Sum& b) {
        return a.largest.size() < b.largest.size();
    });
    for (const Measure& measure : with_head->largest)
        lines[0].cells.push_back(measure.name + " "), lines[1].cells.push_back(mark_of(measure));
    for (const Sum& sum : sums) {
        lines.push_back({{sum.failed ? "FAIL" : "PASS", sum.solver, sum.precision, std::to_string(sum.rows),
                          std::to_string(sum.failed), std::to_string(sum.unfinished)}});
        for (const Measure& measure : sum.largest) lines.back().cells.push_back(cell_of(measure));
    }
    return aligned(lines, 3);
}

/// How far beyond its marks a row is; infinite where it has no number.
double excess_of(const Row& row) {
    double excess = row.outcome.failure.empty() ? 0 : 1;
    for (const Measure& measure : row.outcome.measures)
        if (!measure.passes()) excess = std::fmax(excess, measure.share());
    return excess;
}

/// What a cell of a matrix says: a number, and its mark.
std::string matrix_cell(const Row& row) {
    switch (row.outcome.status) {
        case Status::refused:
            return "refused";
        case Status::as_auto:
            return "as auto";
        case Status::ran:
            break;
    }
    if (row.outcome.bracket) return words_of(*row.outcome.bracket);
    const Measure* const shown = shown_of(row.outcome);
    std::string text = shown ? format("%.2g", shown->value) : "none";
    if (shown && shown->mark) text += format("/%.2g", *shown->mark);
    return row.has_failed() ? text + "!" : text;
}

/// A line a scene, a column a solver and precision, and those that failed in full.
std::string matrix_table(std::span<const Row> rows) {
    std::vector<std::string> columns, scenes;
    const auto place_in = [](std::vector<std::string>& all, const std::string& name) {
        const auto found = std::find(all.begin(), all.end(), name);
        if (found != all.end()) return static_cast<std::size_t>(found - all.begin());
        all.push_back(name);
        return all.size() - 1;
    };
    std::vector<Line> lines{{{"scene"}}};
    for (const Row& row : rows) {
        const std::size_t column = 1 + place_in(columns, row.solver + " " + row.precision),
                          line = 1 + place_in(scenes, row.scene);
        if (line == lines.size()) lines.push_back({{row.scene}});
        lines[line].cells.resize(std::max(lines[line].cells.size(), column + 1));
        lines[line].cells[column] = matrix_cell(row);
    }
    lines[0].cells.insert(lines[0].cells.end(), columns.begin(), columns.end());
    std::string text = aligned(lines, 1);
    for (const Row& row : rows)
        if (row.has_failed())
            text += joined("  FAIL ", row.scene, ", ", row.solver, " ", row.precision, ": ",
                           reason_of(row.outcome), "\n");
    return text;
}

}  // namespace

std::string table_of(const Case& of, std::span<const Row> rows) {
    constexpr std::size_t kMostInFull = 20;
    std::string text = joined(of.id, ": ", of.title, "\n");
    if (of.is_matrix) return text + matrix_table(rows);
    if (!of.is_summed_up || rows.size() < kMostInFull) return text + full_table(rows);
    text += summary_table(rows);
    std::vector<Row> failed;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(failed),
                 [](const Row& row) { return row.has_failed(); });
    if (failed.empty()) return text;
    std::stable_sort(failed.begin(), failed.end(),
                     [](const Row& a, const Row& b) { return excess_of(a) > excess_of(b); });
    text += format("\n  The farthest above their marks of %zu that fail:\n", failed.size());
    failed.resize(std::min(failed.size(), kMostInFull));
    return text + full_table(failed);
}

}  // namespace carom::torture
