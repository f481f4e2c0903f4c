// Heavy on light: B4 and B41.
#include <cmath>

#include "measure/text.hpp"
#include "torture/hard/box_scenes.hpp"
#include "torture/hard/heavy_column.hpp"
#include "torture/hard/passive_rule.hpp"
#include "torture/hard/uneven_pile.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kRadius = 0.5, kGravity = 10;  // m, m/s²
constexpr int kTenSeconds = 600;

std::string in_words(const UnevenPile& pile) {
    return format("pile of %d, masses %s 1 : %g, e %g friction %g, seed %d", pile.columns * pile.columns,
                  pile.masses == Masses::two ? "either" : "all between", pile.ratio, pile.restitution,
                  pile.friction, static_cast<int>(pile.seed));
}

/// It falls and comes to lie. Without friction the overlap has no mark: single light discs that are squeezed
/// out end deep in others for a while.
HardCase pile_that_falls(const UnevenPile& pile, int steps) {
    return {.code = "B41",
            .name = in_words(pile),
            .make = [=] { return scene_of(pile); },
            .run = [=](HardRun& run) -> Measures {
                EnergyRise rise(run);
                Largest settled, ever;
                for (int i = 0; i < steps && run.step(); ++i) {
                    rise.look(run);
                    if (i % 5 > 0) continue;
                    const double overlap = run.overlap();
                    ever.take(overlap);
                    if (4 * i >= 3 * steps) settled.take(overlap);
                }
                Measure overlap{"overlap, settled", settled.value()};
                if (pile.friction > 0) overlap.mark = 0.1;  // of the radius
                return {overlap,
                        rise.measure(),
                        {"quarantined", static_cast<double>(run.quarantined()), 0},
                        {"overlap ever", ever.value()}};
            }};
}

}  // namespace

Scene scene_of(const UnevenPile& pile) {
    constexpr double kPitch = 2.1 * kRadius, kAside = 0.02;  // m
    const Material material{.friction = pile.friction, .restitution = pile.restitution};
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls =
        Walls{.min = {0, 0}, .max = {pile.columns * kPitch, 1e4}, .top = false, .material = material};
    Random random(pile.seed, 41);
    for (int row = 0; row < pile.columns; ++row)
        for (int column = 0; column < pile.columns; ++column) {
            const double x = (column + 0.5) * kPitch + random.uniform(-kAside, kAside),
                         y = (row + 0.5) * kPitch + random.uniform(-kAside, kAside), u = random.uniform();
            const double mass =
                pile.masses == Masses::two ? (u < 0.5 ? pile.ratio : 1) : std::pow(pile.ratio, u);
            scene.add(heavy_disc(kRadius, mass, {x, y}, material));
        }
    return scene;
}

Scene scene_of(const HeavyColumn& column) {
    const Material material{.friction = column.friction};
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = shaft_of(kRadius, material);
    const double top = kRadius + 2 * kRadius * column.light;
    for (int i = 0; i < column.light; ++i)
        scene.add(heavy_disc(kRadius, 1, {0, kRadius + 2 * kRadius * i}, material));
    scene.add(heavy_disc(kRadius, column.ratio, {0, top + column.drop}, material));
    return scene;
}

Measures sink_in(HardRun& run, const HeavyColumn& column, double mark) {
    Passive passive(run);
    Largest deepest;
    int passed = 0;
    const double top = kRadius + 2 * kRadius * column.light;
    for (int i = 0; i < kTenSeconds && run.step(); ++i) {
        const double height = run.place(run.last()).y;
        deepest.take((top - height) / (2 * kRadius));
        passed += height > run.place(run.last() - 1).y ? 0 : 1;
        passive.look(run);
    }
    Measures measures{{"sink/diameter", deepest.value(), mark},
                      {"steps behind a light one", static_cast<double>(passed), 0}};
    passive.add_to(measures, run);
    return measures;
}

Scene box_on_boxes(int light, double ratio) {
    Scene scene = tower(light, 0, 0);
    Body heavy = box_at(0, light + 0.5, 1, 1, 0.6);
    heavy.mass = ratio;
    scene.add(heavy);
    return scene;
}

Measures sink_of_box(HardRun& run) {
    constexpr double kLargest = 0.01;  // of a side
    const Shifts shifts(run);
    run.steps(kTenSeconds);
    return {{"sink/side", shifts.sink(run, run.last()), kLargest},
            {"aside/side", std::fabs(run.place(run.last()).x), kLargest}};
}

namespace {

HardCase heavy_box(int light, double ratio) {
    return {.code = "B4",
            .name = format("box on %d, ratio %g", light, ratio),
            .make = [=] { return box_on_boxes(light, ratio); },
            .run = sink_of_box};
}

HardCase heavy_column(std::string code, const HeavyColumn& column, double mark) {
    std::string name = format("disc on %d, ratio %g", column.light, column.ratio);
    if (column.drop > 0) name += format(", dropped by %g m", column.drop);
    if (column.friction > 0) name += format(", friction %g", column.friction);
    return {.code = std::move(code),
            .name = std::move(name),
            .make = [=] { return scene_of(column); },
            .run = [=](HardRun& run) { return sink_in(run, column, mark); }};
}

}  // namespace

HardCases discs_under_a_heavy_one(Extent) {
    HardCases all;
    for (const double ratio : {10., 1e2, 1e3, 1e4}) all.push_back(heavy_column("B4", {1, ratio}, 0.001));
    all.push_back(heavy_column("B4", {1, 1e6}, 0.01));
    all.push_back(heavy_column("B4", {.ratio = 1e3, .friction = 0.5}, 0.001));
    return all;
}

HardCases discs_hit_by_a_heavy_one(Extent) {
    HardCases all;
    for (const double ratio : {1e2, 1e4, 1e6}) all.push_back(heavy_column("B4", {1, ratio, 1}, 0.05));
    return all;
}

HardCases columns_under_a_heavy_disc(Extent) {
    HardCases all;
    for (const int light : {2, 5})
        for (const double ratio : {1e2, 1e3, 1e4}) all.push_back(heavy_column("B4", {light, ratio}, 0.01));
    all.push_back(heavy_column("B4", {5, 1e6}, 0.5));
    for (const double ratio : {1e2, 1e3}) all.push_back(heavy_column("B4", {20, ratio}, 0.1));
    return all;
}

HardCases twenty_under_a_million(Extent) {
    return {heavy_column("B41", {20, 1e6}, 0.05)};
}

HardCases boxes_under_a_heavy_one(Extent) {
    HardCases all;
    for (const double ratio : {10.0, 1e2, 1e3, 1e4, 1e6}) all.push_back(heavy_box(1, ratio));
    return all;
}

HardCases five_boxes_under_a_heavy_one(Extent) {
    return {heavy_box(5, 1e3)};
}

constexpr int kStepsOfPile = 240;

HardCases piles_of_uneven_masses(Extent extent) {
    const int columns = extent.of(20, 7);
    HardCases all;
    const auto add = [&](const UnevenPile& pile) { all.push_back(pile_that_falls(pile, kStepsOfPile)); };
    for (const double ratio : {30., 1e2, 3e2, 1e3, 1e4})
        if (!extent.is_short || ratio == 30 || ratio == 1e3) add({.columns = columns, .ratio = ratio});
    for (std::uint64_t seed = 1; seed <= extent.of<std::uint64_t>(3, 1); ++seed)
        add({.columns = columns, .seed = seed});
    add({.columns = columns, .masses = Masses::log_uniform});
    add({.columns = columns, .restitution = 0.3});
    return all;
}

HardCases smooth_piles_of_uneven_masses(Extent extent) {
    const int columns = extent.of(20, 10);
    HardCases all;
    for (std::uint64_t seed = 1; seed <= extent.of<std::uint64_t>(2, 1); ++seed)
        all.push_back(pile_that_falls({.columns = columns, .friction = 0, .seed = seed}, kStepsOfPile));
    all.push_back(
        pile_that_falls({.columns = columns, .masses = Masses::log_uniform, .friction = 0}, kStepsOfPile));
    return all;
}

}  // namespace carom::torture
