#include "torture/rows.hpp"

#include <algorithm>

#include "torture/envelopes/envelope.hpp"
#include "torture/hard/hard_case.hpp"

namespace carom::torture {

std::vector<std::string> names_of_rows() {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const HardCase& each : all_hard_cases({.is_short = true})) add(each.code);
    for (const Envelope& each : all_envelopes()) add(each.name);
    return names;
}

}  // namespace carom::torture
