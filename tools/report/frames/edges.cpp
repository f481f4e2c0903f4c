#include "report/frames/edges.hpp"

#include <algorithm>
#include <cmath>

namespace carom::report {

std::vector<EdgeBody> edge_bodies(const Json& settings) {
    std::vector<EdgeBody> bodies;
    if (!settings.is_object() || !settings.contains("edges")) return bodies;
    for (const Json& each : settings.at("edges")) {
        EdgeBody edges{.body = each.at("body"), .x = {}, .y = {}};
        for (const Json& point : each.at("points")) {
            edges.x.push_back(point.at(0)), edges.y.push_back(point.at(1));
            edges.reach = std::max(edges.reach, std::hypot(edges.x.back(), edges.y.back()));
        }
        if (each.at("loop") == true && !edges.x.empty())
            edges.x.push_back(edges.x.front()), edges.y.push_back(edges.y.front());
        bodies.push_back(std::move(edges));
    }
    return bodies;
}

std::vector<JointLine> joint_lines(const Json& settings, const Json& breaks) {
    std::vector<JointLine> lines;
    if (!settings.is_object() || !settings.contains("joints")) return lines;
    for (const Json& each : settings.at("joints"))
        lines.push_back({each.at(0), each.at(3), each.at(1), each.at(2), each.at(4), each.at(5)});
    if (!breaks.is_array()) return lines;
    for (const Json& each : breaks)
        if (const std::size_t joint = each.at(0); joint < lines.size()) lines[joint].until = each.at(1);
    return lines;
}

}  // namespace carom::report
