#include <carom/world.hpp>

#include <algorithm>

#include "measure/complexity.hpp"
#include "measure/gas.hpp"
#include "measure/machine.hpp"
#include "measure/scaling.hpp"
#include "measure/text.hpp"

namespace carom::measure {
namespace {

constexpr double kNano = 1e9;
// Below that many bodies a step is mostly what it costs to begin one.
constexpr std::int64_t kFewestFittedBodies = 1000;

Json as_json(const Spread& spread) {
    return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

std::vector<std::string> methods_of(const std::vector<ScalingRow>& rows) {
    std::vector<std::string> methods;
    for (const ScalingRow& row : rows)
        if (std::find(methods.begin(), methods.end(), row.method) == methods.end())
            methods.push_back(row.method);
    return methods;
}

Json row_json(const ScalingRow& row) {
    std::vector<double> each;
    for (const double seconds : row.seconds)
        each.push_back(kNano * seconds / static_cast<double>(row.bodies));
    return {{"method", row.method},
            {"bodies", row.bodies},
            {"ns_per_body", as_json(quartiles(each))},
            {"rounds", each},
            {"pairs_per_body", row.pairs_per_body},
            {"contacts_per_body", row.contacts_per_body},
            {"bytes_per_body", row.bytes_per_body}};
}

/// How the time of one method grows, from the sizes where it is not all overhead.
Json complexity_json(const std::vector<ScalingRow>& rows, const std::string& method) {
    std::vector<Cost> costs;
    for (const ScalingRow& row : rows)
        if (row.method == method && row.bodies >= kFewestFittedBodies)
            costs.push_back({static_cast<double>(row.bodies), quantile(row.seconds, 0.5)});
    if (costs.size() < 3) return nullptr;
    const PowerLaw law = fit_power_law(costs);
    const Complexity nearest = nearest_complexity(costs);
    return {{"method", method},         {"from_bodies", kFewestFittedBodies},
            {"exponent", law.exponent}, {"exponent_error", law.exponent_error},
            {"nearest", nearest.name},  {"deviation", nearest.deviation}};
}

/// From how many bodies on `second` is faster than `first`.
Json crossover_json(const std::vector<ScalingRow>& rows, const std::string& first,
                    const std::string& second) {
    std::vector<Duel> duels;
    const ScalingRow* last = nullptr;
    for (const ScalingRow& a : rows)
        for (const ScalingRow& b : rows)
            if (a.method == first && b.method == second && a.bodies == b.bodies) {
                duels.push_back({static_cast<double>(a.bodies), a.seconds, b.seconds});
                last = &a;
            }
    if (duels.empty()) return nullptr;
    const Crossover crossover = find_crossover(duels);
    Json json{{"from", first}, {"to", second}};
    switch (crossover.kind) {
        case Crossover::Kind::crosses:
            json["bodies"] = as_json(crossover.size);
            break;
        case Crossover::Kind::always:
            json["at_every_size_from"] = duels.front().size;
            break;
        case Crossover::Kind::never:
            json["at_no_size_up_to"] = duels.back().size;
            break;
    }
    json["ratio_at"] = last->bodies;
    json["ratio"] = as_json(median_interval(ratios(duels.back().first, duels.back().second)));
    return json;
}

std::string crossover_text(const Json& crossover) {
    const auto name = [&](const char* key) { return crossover.at(key).get<std::string>(); };
    std::string text = joined(name("to"), " is faster than ", name("from"));
    if (crossover.contains("bodies")) {
        const Json& bodies = crossover.at("bodies");
        text += format(" from %.0f bodies on (%.0f to %.0f)", bodies.at("median").get<double>(),
                       bodies.at("low").get<double>(), bodies.at("high").get<double>());
    } else if (crossover.contains("at_every_size_from")) {
        text += format(" at every size measured, from %.0f bodies",
                       crossover.at("at_every_size_from").get<double>());
    } else {
        text +=
            format(" at no size measured, up to %.0f bodies", crossover.at("at_no_size_up_to").get<double>());
    }
    const Json& ratio = crossover.at("ratio");
    return text + format("; at %lld bodies %.3g times (%.3g to %.3g)\n",
                         static_cast<long long>(crossover.at("ratio_at").get<std::int64_t>()),
                         ratio.at("median").get<double>(), ratio.at("low").get<double>(),
                         ratio.at("high").get<double>());
}

}  // namespace

Json scaling_json(const std::vector<ScalingRow>& rows) {
    Json json = result_header("scaling");
    json["scene"] = "gas";
    json["dt"] = kStep;
    json["precision"] = "float";
    json["rows"] = Json::array();
    for (const ScalingRow& row : rows) json["rows"].push_back(row_json(row));
    json["complexity"] = Json::array();
    const std::vector<std::string> methods = methods_of(rows);
    for (const std::string& method : methods)
        if (Json fit = complexity_json(rows, method); !fit.is_null()) json["complexity"].push_back(fit);
    json["crossovers"] = Json::array();
    const std::vector<std::string> isas = runnable_instruction_sets();
    for (const char* from : {"naive", "all pairs"})
        for (const std::string& isa : {isas.front(), isas.back()})
            if (Json found = crossover_json(rows, from, joined("grid ", isa)); !found.is_null())
                json["crossovers"].push_back(found);
    return json;
}

std::string scaling_text(const Json& scaling) {
    std::string text = "gas, ns a body a step (quartiles), candidate pairs, contacts and bytes a body\n\n";
    text += format("  %-22s %9s %12s  %-23s %8s %9s %7s\n", "method", "bodies", "ns", "from - to", "pairs",
                   "contacts", "bytes");
    for (const Json& row : scaling.at("rows")) {
        const Json& ns = row.at("ns_per_body");
        const std::string range =
            format("%.4g - %.4g", ns.at("low").get<double>(), ns.at("high").get<double>());
        text += format("  %-22s %9lld %12.4g  %-23s %8.4g %9.3g %7.0f\n",
                       row.at("method").get<std::string>().c_str(),
                       static_cast<long long>(row.at("bodies").get<std::int64_t>()),
                       ns.at("median").get<double>(), range.c_str(), row.at("pairs_per_body").get<double>(),
                       row.at("contacts_per_body").get<double>(), row.at("bytes_per_body").get<double>());
    }
    text += "\n";
    for (const Json& fit : scaling.at("complexity"))
        text += format("%s: time grows as N^%.2f (+- %.2f) from %lld bodies on, nearest %s\n",
                       fit.at("method").get<std::string>().c_str(), fit.at("exponent").get<double>(),
                       fit.at("exponent_error").get<double>(),
                       static_cast<long long>(fit.at("from_bodies").get<std::int64_t>()),
                       fit.at("nearest").get<std::string>().c_str());
    for (const Json& crossover : scaling.at("crossovers")) text += crossover_text(crossover);
    return text;
}

}  // namespace carom::measure
