#include "torture/results.hpp"

#include <carom/build_info.hpp>
#include <carom/version.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/text.hpp"

namespace carom::torture {
namespace {

using measure::format;
using measure::joined;

/// JSON has no infinity and no not-a-number; null is read back as not a number, which passes no mark.
double number_from(const Json& json) {
    return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

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
    return measure.mark ? format("<= %.3g ", *measure.mark) : "told ";
}

constexpr std::size_t kTextColumns = 4;  // verdict, scene, solver, precision

Line line_of(const Row& row) {
    Line line{{row.passes() ? "PASS" : "FAIL", row.scene, row.solver, row.precision}, row.outcome.failure};
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
        ++sum->rows, sum->failed += !row.passes(), sum->unfinished += !row.outcome.failure.empty();
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

/// How far above its marks a row is; infinite where it has no number.
double excess_of(const Row& row) {
    double excess = row.outcome.failure.empty() ? 0 : 1;
    for (const Measure& measure : row.outcome.measures)
        if (!measure.passes()) {
            const double ratio = measure.value / std::fmax(*measure.mark, 1e-9);
            excess = std::isnan(ratio) ? std::numeric_limits<double>::infinity() : std::fmax(excess, ratio);
        }
    return excess;
}

}  // namespace

Json to_json(const Outcome& outcome) {
    Json measures = Json::array();
    for (const Measure& measure : outcome.measures) {
        Json one{{"name", measure.name}, {"value", measure.value}};
        if (measure.mark) one["mark"] = *measure.mark, one["passed"] = measure.passes();
        measures.push_back(std::move(one));
    }
    Json json{{"measures", std::move(measures)}, {"failure", outcome.failure}};
    if (outcome.is_skipped) json["skipped"] = true;
    return json;
}

Outcome outcome_from(const Json& json) {
    Outcome outcome{.failure = json.at("failure").get<std::string>(), .is_skipped = json.contains("skipped")};
    for (const Json& one : json.at("measures")) {
        Measure& measure = outcome.measures.emplace_back();
        measure.name = one.at("name").get<std::string>(), measure.value = number_from(one.at("value"));
        if (one.contains("mark")) measure.mark = one.at("mark").get<double>();
    }
    return outcome;
}

Json to_json(std::span<const Case* const> cases, std::span<const Row> rows, const Options& asked) {
    Json json{{"kind", "torture"},
              {"version", kVersion},
              {"isa", build_info().chosen},
              {"seed", asked.seed},
              {"limit_s", asked.limit}};
    json["cases"] = Json::array();
    for (const Case* each : cases) {
        int count = 0, failed = 0;
        for (const Row& row : rows)
            if (row.case_id == each->id) ++count, failed += !row.passes();
        json["cases"].push_back(
            {{"id", each->id}, {"title", each->title}, {"rows", count}, {"failed", failed}});
    }
    json["rows"] = Json::array();
    for (const Row& row : rows) {
        Json one{{"case", row.case_id},
                 {"scene", row.scene},
                 {"solver", row.solver},
                 {"precision", row.precision},
                 {"passed", row.passes()}};
        one.update(to_json(row.outcome));
        json["rows"].push_back(std::move(one));
    }
    return json;
}

std::string table_of(const Case& of, std::span<const Row> rows) {
    constexpr std::size_t kMostInFull = 20;
    std::string text = joined(of.id, ": ", of.title, "\n");
    if (!of.is_summed_up || rows.size() < kMostInFull) return text + full_table(rows);
    text += summary_table(rows);
    std::vector<Row> failed;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(failed),
                 [](const Row& row) { return !row.passes(); });
    if (failed.empty()) return text;
    std::stable_sort(failed.begin(), failed.end(),
                     [](const Row& a, const Row& b) { return excess_of(a) > excess_of(b); });
    text += format("\n  The farthest above their marks of %zu that fail:\n", failed.size());
    failed.resize(std::min(failed.size(), kMostInFull));
    return text + full_table(failed);
}

}  // namespace carom::torture
