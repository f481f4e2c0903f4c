// Unequal masses and sizes.
#include "torture/envelopes/envelope.hpp"
#include "torture/hard/chains.hpp"
#include "torture/hard/heavy_column.hpp"
#include "torture/hard/joint_scenes.hpp"
#include "torture/hard/sizes.hpp"

namespace carom::torture {
namespace {

constexpr Range kRatios{.first = 10, .last = 1e9, .stride = 10, .narrow = 1.5};
constexpr int kLinks = 20, kTenSeconds = 600;

Envelope disc_on(int light, std::string name, std::string title) {
    return {.name = std::move(name),
            .title = std::move(title),
            .criterion =
                "in 10 s it sinks by at most 1 % of a diameter, passes none, energy and speed as falling "
                "allows",
            .range = kRatios,
            .seeds = {1},
            .make =
                [=](double ratio, std::uint64_t) {
                    return scene_of(HeavyColumn{light, ratio});
                },
            .run =
                [=](HardRun& run, double ratio) {
                    return sink_in(run, {light, ratio}, 0.01);
                }};
}

Envelope chain(bool swings) {
    return {
        .name = swings ? "chain-weight-swinging" : "chain-weight",
        .title = swings ? "weight on a chain of 20 links that is let go level, over a link's"
                        : "weight on a chain of 20 links that hangs, over a link's",
        .criterion = "in 10 s no joint opens by more than 1 % of a link, and energy keeps the rule",
        .range = kRatios,
        .seeds = {1},
        .make =
            [=](double weight, std::uint64_t) {
                return weighted_chain(kLinks, weight, swings ? Vec2{1, 0} : Vec2{0, -1});
            },
        .run = [](HardRun& run, double weight) { return strain_of(run, kLinks, weight, 0.01, kTenSeconds); }};
}

}  // namespace

Envelopes mass_ratios() {
    return {disc_on(1, "mass-ratio", "mass of a disc over that of the one it lies on"),
            disc_on(5, "mass-ratio-five", "mass of a disc over each of five that it lies on"),
            {.name = "mass-ratio-boxes",
             .title = "mass of a box over each of five that it stands on",
             .criterion = "after 10 s it has sunk by at most 1 % of a side, and gone aside by no more",
             .range = kRatios,
             .seeds = {1},
             .make = [](double ratio, std::uint64_t) { return box_on_boxes(5, ratio); },
             .run = [](HardRun& run, double) { return sink_of_box(run); }},
            chain(false),
            chain(true)};
}

Envelopes size_ratios() {
    return {{.name = "size-ratio",
             .title = "radius of a disc over that of up to 200 that heap up on and beside it",
             .criterion =
                 "in 10 s no overlap above 10 % of the small radius, energy and speed as falling allows, "
                 "none outside",
             .range = {.first = 100, .last = 1e6, .stride = 10, .narrow = 1.5},
             .seeds = {1},
             .make = [](double ratio, std::uint64_t) { return small_around_large(ratio); },
             .run = [](HardRun& run, double) { return overlap_around_large(run, kTenSeconds); }}};
}

}  // namespace carom::torture
