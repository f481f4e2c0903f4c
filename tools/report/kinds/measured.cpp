#include "report/kinds/measured.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>

namespace carom::report {

std::string tag_of(const std::vector<Result>& results, std::size_t index) {
    if (results.size() == 1) return {};
    std::string tag = " (A)";
    tag[2] = static_cast<char>('A' + static_cast<int>(index % 26));
    return tag;
}

void add_origins(const std::vector<Result>& results, Page& page) {
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Json& json = results[i].json;
        const Json& machine = json.at("machine");
        const auto text = [&](const Json& from, const char* key) { return from.at(key).get<std::string>(); };
        std::string isas;
        for (const Json& isa : machine.at("isa")) isas.append(" ").append(isa.get<std::string>());
        std::string origin = tag_of(results, i);
        if (!origin.empty()) origin = origin.substr(1) + " ";
        page.paragraph(origin + results[i].file.filename().string() + ": measured " + text(json, "date") +
                       " with Carom " + text(json, "version") + " on " + text(machine, "processor") + ", " +
                       machine.at("cores").dump() + " cores," + isas + "; " + text(machine, "compiler") +
                       (json.value("quick", false) ? "; quick mode: fewer and shorter measurements" : ""));
    }
}

std::string digits(double value, int significant) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.*g", significant, value);
    return text.data();
}

Point spread_point(double x, const Json& spread, double scale) {
    return {.x = x,
            .y = scale * spread.at("median").get<double>(),
            .low = scale * spread.at("low").get<double>(),
            .high = scale * spread.at("high").get<double>()};
}

std::vector<std::string> name_parts(const std::string& name) {
    std::vector<std::string> parts;
    std::istringstream stream(name);
    for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
    return parts;
}

double name_value(const std::string& name, std::string_view key) {
    for (const std::string& part : name_parts(name))
        if (part.size() > key.size() && part.starts_with(key) && part[key.size()] == ':')
            return std::strtod(part.c_str() + key.size() + 1, nullptr);
    return 0;
}

Series& series_named(std::vector<Series>& series, const std::string& name) {
    const auto is_it = [&](const Series& each) { return each.name == name; };
    if (const auto found = std::find_if(series.begin(), series.end(), is_it); found != series.end())
        return *found;
    series.push_back({.name = name});
    return series.back();
}

}  // namespace carom::report
