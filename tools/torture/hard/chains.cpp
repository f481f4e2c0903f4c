// Chains of light links with heavy ends: B5.
#include "torture/hard/chains.hpp"

#include <cmath>

#include "measure/text.hpp"
#include "torture/hard/joint_scenes.hpp"
#include "torture/hard/passive_rule.hpp"

namespace carom::torture {

using measure::format;

namespace {

/// Four links, the third one light, the last one thrown in a direction [rad]: the light one turns by radians
/// a substep at once, where bent paths have no solution near by.
Scene light_link(double light, double speed, double direction) {
    Scene scene;
    std::vector<BodyId> links;
    for (const double x : {0.0, 1.0, 2.0, 3.0})
        links.push_back(scene.add(bar({x, 0}, 1, x == 2 ? light : 1000)));
    scene.bodies.back().velocity = {speed * std::cos(direction), speed * std::sin(direction)};
    const auto join = [&](std::size_t a, const JointKind& kind) {
        scene.add(Joint{.a = links[a], .b = links[a + 1], .kind = kind});
    };
    join(0, RevoluteJoint{.anchor = Vec2{0.5, 0}});
    join(1, DistanceJoint{.anchor_b = {0, 0.3}});
    join(2, RevoluteJoint{.anchor = Vec2{2.5, 0}});
    return scene;
}

Measures energy_of_links(HardRun& run) {
    constexpr double kLargest = 1.1;  // velocities are those of whole times, of a path of second order
    const double start = run.energy();
    Largest most;
    for (int i = 0; i < 60 && run.step(); ++i) most.take(run.energy() / start);
    return {{"energy/first", most.value(), kLargest},
            {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

}  // namespace

Measures strain_of(HardRun& run, int links, double weight, double largest_gap, int steps) {
    const double fall = -run.scene().gravity.y * weight * links;  // J
    EnergyRise rise(run, fall);
    Largest gap;
    for (int i = 0; i < steps && run.step(); ++i) {
        gap.take(run.joint_gap());
        rise.look(run);
    }
    return {{"gap/link", gap.value(), largest_gap}, rise.measure()};
}

HardCases chains_with_weights(Extent extent) {
    HardCases all;
    for (const int links : {20, 40})
        for (const double weight : {200.0, 1e3, 5e4})
            for (const bool swings : {false, true})
                all.push_back(
                    {.code = "B5",
                     .name = format("chain of %d links, weight %g, %s", links, weight,
                                    swings ? "let go level" : "hangs"),
                     .make =
                         [=] {
                             return weighted_chain(links, weight, swings ? Vec2{1, 0} : Vec2{0, -1});
                         },
                     .run =
                         [=](HardRun& run) {
                             return strain_of(run, links, weight, swings ? 1e-4 : 1e-6, extent.of(600, 300));
                         }});
    return all;
}

HardCases light_links_between_heavy_ones(Extent) {
    HardCases all;
    for (const double light : {1.0, 1e-3})
        for (const double speed : {30.0, 300.0, 3000.0})
            all.push_back(
                {.code = "B5",
                 .name = format("link of %g kg between some of 1,000, one thrown at %g m/s", light, speed),
                 .make = [=] { return light_link(light, speed, 0.3); },
                 .run =
                     [=](HardRun& run) {
                         return worst_of_all(run,
                                             {light_link(light, speed, 1.2), light_link(light, speed, 2.5)},
                                             energy_of_links);
                     }});
    return all;
}

}  // namespace carom::torture
