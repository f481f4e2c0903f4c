#include "accuracy/results.hpp"

#include <carom/build_info.hpp>
#include <carom/version.hpp>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <thread>

#include "accuracy/analysis.hpp"
#include "accuracy/engines.hpp"
#include "accuracy/solvers.hpp"
#include "results/text_file.hpp"
#include "terminal/format.hpp"

namespace carom::accuracy {
namespace {

using tool::format;

const char* precision_name(Precision precision) {
    return precision == Precision::single_ ? "float" : "double";
}

Json to_json(const Band& band) {
    return {{"value", band.value}, {"low", band.low}, {"high", band.high}};
}

Band band_from(const Json& json) {
    const auto number = [&](const char* key) {
        return json.at(key).is_null() ? NAN : json.at(key).get<double>();
    };
    return {number("value"), number("low"), number("high")};
}

Json orders_of(const CaseResult& result) {
    Json orders = Json::array();
    for (const Contender& contender : contenders_in(result))
        for (std::size_t e = 0; e < result.of->errors.size(); ++e)
            if (const auto fit = observed_order(result, contender, e))
                orders.push_back({{"solver", contender.name},
                                  {"precision", precision_name(contender.precision)},
                                  {"error", result.of->errors[e].name},
                                  {"order", fit->order},
                                  {"from_dt", fit->from},
                                  {"to_dt", fit->to}});
    return orders;
}

Json sources_in(const CaseResult& result) {
    Json found = Json::array();
    const auto parts_of = [](const std::vector<Sources::Part>& parts) {
        Json json = Json::array();
        for (const Sources::Part& part : parts)
            json.push_back({{"dt", part.dt},
                            {"substeps", part.substeps},
                            {"iterations", part.iterations},
                            {"error", part.error}});
        return json;
    };
    for (const Contender& contender : contenders_in(result))
        if (const auto sources = sources_of(result, contender, 0))
            found.push_back({{"solver", contender.name},
                             {"precision", precision_name(contender.precision)},
                             {"step", parts_of(sources->step)},
                             {"residual", parts_of(sources->residual)}});
    return found;
}

Json times_of(const CaseResult& result) {
    Json times = Json::array();
    for (const Contender& contender : contenders_in(result))
        for (const double target : kTargets) {
            const Point* point = cheapest(result, contender, target);
            times.push_back({{"solver", contender.name},
                             {"precision", precision_name(contender.precision)},
                             {"target", target},
                             {"seconds", point ? Json(point->seconds.value) : Json()},
                             {"setting", point ? Json(in_words(point->setting)) : Json()}});
        }
    return times;
}

Json to_json(const CaseResult& result) {
    const Case& of = *result.of;
    Json json{
        {"id", of.id},       {"title", of.title},    {"kind", of.kind},         {"effects", of.effects},
        {"exact", of.exact}, {"starts", of.members}, {"errors", Json::array()}, {"points", Json::array()}};
    for (const ErrorMeasure& error : of.errors)
        json["errors"].push_back(
            {{"name", error.name}, {"meaning", error.meaning}, {"is_statistic", error.is_statistic}});
    if (!of.note.empty()) json["note"] = of.note;
    json["left_out"] = Json::array();
    for (const LeftOut& out : left_out_of(of))
        json["left_out"].push_back({{"engine", out.engine}, {"why", out.why}});
    const auto frontier = frontier_of(result);
    for (const Point& point : result.points) {
        Json one = to_json(point);
        one["on_frontier"] = std::find(frontier.begin(), frontier.end(), &point) != frontier.end();
        json["points"].push_back(std::move(one));
    }
    json["orders"] = orders_of(result);
    json["time_to_reach"] = times_of(result);
    json["sources"] = sources_in(result);
    return json;
}

}  // namespace

std::string in_words(const Setting& s) {
    const double rate = 1 / s.dt;
    std::string text = format("%s, %s, ", name_of(s).c_str(), precision_name(s.precision));
    text += s.dt < 1 && std::fabs(rate - std::round(rate)) < 1e-6 * rate ? format("1/%.0f s", rate)
                                                                         : format("%g s", s.dt);
    if (s.substeps != 1) text += format(", %d substeps", s.substeps);
    if (s.iterations != 1) text += format(", %d iterations", s.iterations);
    return text;
}

Json to_json(const Setting& setting) {
    return {{"solver", name_of(setting)},
            {"precision", precision_name(setting.precision)},
            {"dt", setting.dt},
            {"substeps", setting.substeps},
            {"iterations", setting.iterations}};
}

Json to_json(const Point& point) {
    Json json = to_json(point.setting);
    json["errors"] = Json::array();
    for (const Band& error : point.errors) json["errors"].push_back(to_json(error));
    json["seconds"] = to_json(point.seconds);
    json["runs"] = point.runs;
    json["work"] = {{"body_substeps", point.work.body_substeps},
                    {"pair_tests", point.work.pair_tests},
                    {"impacts", point.work.impacts}};
    json["failure"] = point.failure.empty() ? Json() : Json(point.failure);
    return json;
}

Point point_from(const Json& json) {
    Point point;
    const std::string name = json.at("solver").get<std::string>();
    if (const auto solver = solver_named(name))
        point.setting.solver = *solver;
    else
        point.setting.engine = name;
    point.setting.precision =
        json.at("precision").get<std::string>() == "float" ? Precision::single_ : Precision::double_;
    point.setting.dt = json.at("dt").get<double>();
    point.setting.substeps = json.at("substeps").get<int>();
    point.setting.iterations = json.at("iterations").get<int>();
    for (const Json& error : json.at("errors")) point.errors.push_back(band_from(error));
    point.seconds = band_from(json.at("seconds"));
    point.runs = json.at("runs").get<int>();
    const Json& work = json.at("work");
    point.work = {work.at("body_substeps").get<double>(), work.at("pair_tests").get<double>(),
                  work.at("impacts").get<double>()};
    if (!json.at("failure").is_null()) point.failure = json.at("failure").get<std::string>();
    return point;
}

Json to_json(const std::vector<CaseResult>& results, bool quick) {
    Json json{{"kind", "accuracy"},
              {"version", kVersion},
              {"quick", quick},
              {"machine",
               {{"processors", std::thread::hardware_concurrency()},
                {"instruction_sets", runnable_instruction_sets()},
                {"compiler", build_info().compiler},
                {"isa", build_info().chosen}}},
              {"engines", Json::array()},
              {"missing_engines", Json::array()},
              {"cases", Json::array()}};
    for (const bench::PeerEngine& engine : engines())
        json["engines"].push_back({{"name", engine.family}, {"version", engine.version}});
    for (const bench::MissingEngine& missing : bench::missing_engines())
        json["missing_engines"].push_back({{"name", missing.family}, {"why", missing.why}});
    for (const CaseResult& result : results) json["cases"].push_back(to_json(result));
    json["advice"] = advice_from(results);
    return json;
}

std::string to_csv(const std::vector<CaseResult>& results) {
    std::string text =
        "case,solver,precision,dt,substeps,iterations,error,value,low,high,seconds,seconds_low,seconds_high,"
        "runs,"
        "body_substeps,pair_tests,impacts,failure\n";
    for (const CaseResult& result : results)
        for (const Point& point : result.points)
            for (std::size_t e = 0; e < result.of->errors.size(); ++e) {
                const Setting& s = point.setting;
                text += format("%s,%s,%s,", std::string(result.of->id).c_str(), name_of(s).c_str(),
                               precision_name(s.precision));
                tool::append_number(text, s.dt);
                text += format(",%d,%d,", s.substeps, s.iterations);
                tool::append_field(text, result.of->errors[e].name);
                const Band error = point.failure.empty() ? point.errors[e] : Band{NAN, NAN, NAN};
                for (const double number : {error.value, error.low, error.high, point.seconds.value,
                                            point.seconds.low, point.seconds.high})
                    text += ',', tool::append_number(text, number);
                text += format(",%d", point.runs);
                for (const double number :
                     {point.work.body_substeps, point.work.pair_tests, point.work.impacts})
                    text += ',', tool::append_number(text, number);
                text += ',';
                tool::append_field(text, point.failure);
                text += '\n';
            }
    return text;
}

}  // namespace carom::accuracy
