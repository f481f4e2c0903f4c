#include "torture/results.hpp"

#include <carom/build_info.hpp>
#include <carom/version.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include "torture/envelopes/envelope.hpp"

namespace carom::torture {
namespace {

/// JSON has no infinity and no not-a-number; null is read back as not a number, which passes no mark.
double number_from(const Json& json) {
    return json.is_number() ? json.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

constexpr std::array kStatus{"ran", "refused", "as auto"};  // in the order of Status

Status status_from(const Json& json) {
    const auto place = std::find(kStatus.begin(), kStatus.end(), json.get<std::string>());
    return place == kStatus.end() ? Status::ran : static_cast<Status>(place - kStatus.begin());
}

Json to_json(const Bracket& bracket) {
    Json json{{"holds", nullptr}, {"fails", nullptr}};
    if (bracket.holds) json["holds"] = *bracket.holds;
    if (bracket.fails) json["fails"] = *bracket.fails;
    json.update(
        {{"reason", bracket.reason}, {"out_of_time", bracket.is_out_of_time}, {"runs", bracket.runs}});
    return json;
}

Bracket bracket_from(const Json& json) {
    Bracket bracket{.reason = json.at("reason").get<std::string>(),
                    .is_out_of_time = json.at("out_of_time").get<bool>(),
                    .runs = json.at("runs").get<int>()};
    if (!json.at("holds").is_null()) bracket.holds = json.at("holds").get<double>();
    if (!json.at("fails").is_null()) bracket.fails = json.at("fails").get<double>();
    return bracket;
}

Json to_json(const Envelope& envelope) {
    Json json{{"name", envelope.name},           {"title", envelope.title},
              {"criterion", envelope.criterion}, {"first", envelope.range.first},
              {"last", envelope.range.last},     {"linear", envelope.range.is_linear},
              {"narrow", envelope.range.narrow}, {"seeds", envelope.seeds}};
    if (envelope.at) json["at"] = *envelope.at;
    return json;
}

}  // namespace

Json to_json(const Outcome& outcome) {
    Json measures = Json::array();
    for (const Measure& measure : outcome.measures) {
        Json one{{"name", measure.name}, {"value", measure.value}};
        if (measure.mark) {
            if (measure.sense == Sense::at_least) one["at_least"] = true;
            one["mark"] = *measure.mark, one["passed"] = measure.passes(), one["share"] = measure.share();
        }
        measures.push_back(std::move(one));
    }
    Json json{{"measures", std::move(measures)}, {"failure", outcome.failure}};
    json["status"] = kStatus[static_cast<std::size_t>(outcome.status)];
    if (outcome.bracket) json["bracket"] = to_json(*outcome.bracket);
    return json;
}

Outcome outcome_from(const Json& json) {
    Outcome outcome{.failure = json.at("failure").get<std::string>(),
                    .status = status_from(json.at("status"))};
    if (json.contains("bracket")) outcome.bracket = bracket_from(json.at("bracket"));
    for (const Json& one : json.at("measures")) {
        Measure& measure = outcome.measures.emplace_back();
        measure.name = one.at("name").get<std::string>(), measure.value = number_from(one.at("value"));
        if (one.contains("mark")) measure.mark = one.at("mark").get<double>();
        if (one.contains("at_least")) measure.sense = Sense::at_least;
    }
    return outcome;
}

Json to_json(std::span<const Case* const> cases, std::span<const Row> rows, const Options& asked) {
    Json json{{"kind", "torture"},  {"version", kVersion},    {"isa", build_info().chosen},
              {"seed", asked.seed}, {"limit_s", asked.limit}, {"quick", asked.is_quick}};
    json["cases"] = Json::array();
    for (const Case* each : cases) {
        int count = 0, failed = 0;
        for (const Row& row : rows)
            if (row.case_id == each->id) count += row.has_run(), failed += row.has_failed();
        json["cases"].push_back(
            {{"id", each->id}, {"title", each->title}, {"rows", count}, {"failed", failed}});
    }
    json["envelopes"] = Json::array();
    if (std::any_of(cases.begin(), cases.end(), [](const Case* each) { return each->id == "envelopes"; }))
        for (const Envelope& each : all_envelopes()) json["envelopes"].push_back(to_json(each));
    json["rows"] = Json::array();
    for (const Row& row : rows) {
        Json one{{"case", row.case_id},
                 {"scene", row.scene},
                 {"solver", row.solver},
                 {"precision", row.precision}};
        if (row.has_run()) one["passed"] = !row.has_failed();
        one.update(to_json(row.outcome));
        json["rows"].push_back(std::move(one));
    }
    return json;
}

}  // namespace carom::torture
