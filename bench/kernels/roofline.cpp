#include "kernels/roofline.hpp"

#include <array>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include "measure/ceilings.hpp"
#include "measure/machine.hpp"
#include "measure/text.hpp"

namespace carom::bench {
namespace {

using measure::Json;

/// Why a kernel stays below the roof, whatever the machine: what else than bytes and arithmetic it does.
struct Reason {
    std::string_view kernel;
    std::string_view text;
};
constexpr std::array kReasons{
    Reason{"find_bounds", "minima and maxima wait for the one before: two chains a column"},
    Reason{"find_cells", "computes in double, half the lanes, and converts both ways"},
    Reason{"find_candidates",
           "offsets of blocks are integer work, and pairs found are written one batch at a time"},
    Reason{"find_near", "three short runs of about two bodies: a batch is mostly empty, each is compressed"},
    Reason{"begin_flight", "turns columns into records in registers; lists of rows are written one by one"},
    Reason{"end_flight", "turns records into columns in registers"},
    Reason{"find_impacts", "loads a record a lane and turns them in registers: shuffles, not arithmetic"},
    Reason{"find_impacts_near",
           "three short runs of about two bodies, then a record a lane: calls and shuffles, not arithmetic"},
    Reason{"find_contacts", "a record a lane, and nine columns compressed one after the other"},
    Reason{"warm_start_pairs", "gathers and scatters two records a lane, turned in registers"},
    Reason{"first_pairs", "gathers and scatters four records a lane, turned in registers"},
    Reason{"next_pairs", "gathers and scatters two records a lane, turned in registers"},
    Reason{"begin_substeps", "turns records in registers, and writes as much again as it reads"},
    Reason{"advance_bodies", "turns five records in registers for each batch"},
    Reason{"find_box_manifolds", "loads two poses and two sizes a lane; selections are not counted"},
    Reason{"find_manifolds",
           "loads vertices and normals a lane and turns them in registers; selections are not counted"},
    Reason{"end_substeps", "turns records into columns in registers; divides by radii"},
    Reason{"advance_rotation", "as many loads and stores as operations: one store a cycle"},
};

std::string_view reason_of(std::string_view kernel) {
    std::string_view longest, text;
    for (const Reason& reason : kReasons)
        if (kernel.starts_with(reason.kernel) && reason.kernel.size() > longest.size())
            longest = reason.kernel, text = reason.text;
    return text;
}

std::vector<std::string> split(const std::string& name) {
    std::vector<std::string> parts;
    std::istringstream stream(name);
    for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
    return parts;
}

/// "items:256" -> 256
std::int64_t value_of(const std::string& part) {
    return std::stoll(part.substr(part.find(':') + 1));
}

Json row_json(const Json& run, const measure::Ceilings& ceilings) {
    const std::vector<std::string> name = split(run.at("name").get<std::string>());
    const std::string &kernel = name.at(1), &isa = name.at(2), &precision = name.at(3);
    const double items = run.at("items_per_second").get<double>();
    const measure::Work work{run.at("bytes_per_item").get<double>(),
                             run.at("operations_per_item").get<double>()};
    const auto working_set = static_cast<std::size_t>(run.at("working_set").get<double>());
    const measure::CopyBandwidth& level = ceilings.copy_of(working_set);
    const measure::ArithmeticPeak& peak = ceilings.peak_of(isa);
    const measure::RoofShare share =
        measure::roof_share(work, items, level.bytes_per_second,
                            precision == "float" ? peak.single_per_second : peak.double_per_second);
    Json row{{"kernel", kernel},
             {"isa", isa},
             {"precision", precision},
             {"items", value_of(name.at(4))},
             {"level", level.level},
             {"hits", run.at("hits")},
             {"ns_per_item", 1e9 / items},
             {"items_per_second", items},
             {"bytes_per_second", items * work.bytes},
             {"operations_per_second", items * work.operations},
             {"operations_per_byte", work.operations / work.bytes},
             {"roof_share", share.share},
             {"roof", share.is_memory ? "bandwidth" : "arithmetic"}};
    if (name.size() > 5) row["hits_asked"] = value_of(name.at(5));
    return row;
}

std::string key_of(const Json& row) {
    return measure::joined(row.at("kernel").get<std::string>(), "/", row.at("precision").get<std::string>(),
                           "/", std::to_string(row.at("items").get<std::int64_t>()), "/",
                           std::to_string(row.value("hits_asked", std::int64_t{-1})));
}

}  // namespace

Json roofline_json(const Json& runs) {
    const measure::Ceilings ceilings = measure::measure_ceilings();
    Json json = measure::result_header("kernels");
    json["ceilings"] = measure::ceilings_json(ceilings);
    json["rows"] = Json::array();
    std::map<std::string, double> scalar_ns;
    for (const Json& run : runs) {
        Json row = row_json(run, ceilings);
        if (row.at("isa") == "scalar") scalar_ns[key_of(row)] = row.at("ns_per_item").get<double>();
        json["rows"].push_back(std::move(row));
    }
    Json reasons = Json::object();
    for (Json& row : json["rows"]) {
        if (const auto scalar = scalar_ns.find(key_of(row)); scalar != scalar_ns.end())
            row["times_scalar"] = scalar->second / row.at("ns_per_item").get<double>();
        const std::string kernel = row.at("kernel").get<std::string>();
        reasons[kernel] = reason_of(kernel);
    }
    json["reasons"] = std::move(reasons);
    return json;
}

std::string roofline_text(const Json& roofline) {
    std::string text = "copy, GB/s:";
    for (const Json& level : roofline.at("ceilings").at("copy"))
        text += measure::format("  %s %.1f", level.at("level").get<std::string>().c_str(),
                                1e-9 * level.at("bytes_per_second").get<double>());
    text += "\narithmetic, G/s (float, double):";
    for (const Json& peak : roofline.at("ceilings").at("peak"))
        text += measure::format("  %s %.1f, %.1f", peak.at("isa").get<std::string>().c_str(),
                                1e-9 * peak.at("float_per_second").get<double>(),
                                1e-9 * peak.at("double_per_second").get<double>());
    text += measure::format("\n\n%-28s %-7s %-7s %8s %5s %9s %8s %8s %7s %-10s %8s\n", "kernel", "isa",
                            "numbers", "items", "hits", "ns/item", "GB/s", "Gop/s", "roof", "", "x scalar");
    for (const Json& row : roofline.at("rows")) {
        const auto number = [&](const char* key) { return row.at(key).get<double>(); };
        const auto word = [&](const char* key) { return row.at(key).get<std::string>(); };
        text += measure::format("%-28s %-7s %-7s %8lld %5.2f %9.3f %8.2f %8.2f %5.0f %% %-10s %8.2f\n",
                                word("kernel").c_str(), word("isa").c_str(), word("precision").c_str(),
                                static_cast<long long>(row.at("items").get<std::int64_t>()), number("hits"),
                                number("ns_per_item"), 1e-9 * number("bytes_per_second"),
                                1e-9 * number("operations_per_second"), 100 * number("roof_share"),
                                word("roof").c_str(), row.value("times_scalar", 0.0));
    }
    return text;
}

}  // namespace carom::bench
