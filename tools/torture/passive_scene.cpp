#include "torture/passive_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "measure/text.hpp"
#include "torture/random.hpp"
#include "torture/runs.hpp"

namespace carom::torture {
namespace {

constexpr std::array kRestitutions{.0, .1, .2, .3, .4, .5, .6, .7, .8, .9, 1., .95, .98, .99};
constexpr std::array kFrictions{0., 0.1, 0.5};
constexpr std::array kSteps{1. / 30, 1. / 60, 1. / 120, 1. / 240};       // s
constexpr double kFewest = 10, kMost = 10'000;                           // bodies
const double kHexagonal = std::numbers::pi / (2 * std::numbers::sqrt3);  // fill where all discs touch

/// Numbers of bodies from 10 to 10,000, every octave there, most of them small: half below 30.
double number_of_bodies(Random& random) {
    return random.skewed(kFewest, kMost, 3);
}

/// Mean square over largest square, of radii spread evenly from 1 to `ratio`.
double mean_square_share(double ratio) {
    return (1 + ratio + ratio * ratio) / (3 * ratio * ratio);
}

/// Distance of centres on a lattice of that fill, and the largest radius [m].
struct Spacing {
    double lattice, radius;
};

Spacing spacing_of(const PassiveTraits& traits) {
    const double radius = 0.5 * traits.unit * traits.radius_ratio;
    const double fill_of_largest =
        std::fmin(traits.fill / mean_square_share(traits.radius_ratio), 0.9);  // above, nothing can move
    return {2 * radius * std::sqrt(kHexagonal / fill_of_largest), radius};
}

Enclosure enclosure_of(const PassiveTraits& traits, double area, double aspect, double angle) {
    if (traits.fence != Fence::walls) return polygon_of(traits.fence, traits.sides, area, angle);
    const double width = std::sqrt(area / aspect);
    return box_of(Fence::walls, width, width * aspect);
}

std::vector<Vec2> lattice_in(const Enclosure& enclosure, double spacing) {
    const Vec2 low = enclosure.low(), high = enclosure.high();
    const double row = 0.5 * std::numbers::sqrt3 * spacing;
    std::vector<Vec2> sites;
    int j = 0;
    for (double y = low.y + 0.5 * spacing; y < high.y; y += row, ++j)
        for (double x = low.x + (j % 2 ? 1 : 0.5) * spacing; x < high.x; x += spacing)
            if (enclosure.clearance({x, y}) >= 0.5 * spacing * (1 - 1e-9)) sites.push_back({x, y});
    return sites;
}

/// What is there, and room for as many bodies as are asked for.
struct Place {
    Enclosure enclosure;
    std::vector<Vec2> sites;
};

Place place_for(const PassiveTraits& traits, double spacing, Random& random) {
    constexpr double kGrowth = 1.03;
    const auto bodies = static_cast<std::size_t>(traits.bodies);
    const double aspect = random.log_uniform(0.4, 2.5), angle = random.uniform(0, 2 * std::numbers::pi);
    double area = traits.room * static_cast<double>(bodies) * 0.5 * std::numbers::sqrt3 * spacing * spacing;
    for (;; area *= kGrowth) {
        Place place{enclosure_of(traits, area, aspect, angle), {}};
        place.sites = lattice_in(place.enclosure, spacing);
        if (place.sites.size() >= bodies) return place;
    }
}

/// A crowd that falls takes the highest sites, a gas any.
void choose_sites(std::vector<Vec2>& sites, const PassiveTraits& traits, Random& random) {
    if (traits.gravity > 0)
        std::stable_sort(sites.begin(), sites.end(), [](Vec2 a, Vec2 b) { return a.y > b.y; });
    else
        for (std::size_t i = sites.size(); i > 1; --i) std::swap(sites[i - 1], sites[random.below(i)]);
    sites.resize(static_cast<std::size_t>(traits.bodies));
}

Body body_at(Vec2 site, const PassiveTraits& traits, const Spacing& spacing, bool is_fixed, Random& random) {
    const double radius = 0.5 * traits.unit * random.uniform(1, traits.radius_ratio);
    const double play = 0.99 * (0.5 * spacing.lattice - radius) / std::numbers::sqrt2;  // m, each way
    const Material material = material_of(traits.restitution, traits.friction);
    Body body = disc_of(radius, {site.x + random.uniform(-play, play), site.y + random.uniform(-play, play)},
                        {traits.speed * random.normal() / std::numbers::sqrt2,
                         traits.speed * random.normal() / std::numbers::sqrt2},
                        material);
    if (traits.friction > 0) body.angular_velocity = traits.speed / radius * random.normal();
    if (!is_fixed) return body;
    body.type = BodyType::static_body, body.velocity = {}, body.angular_velocity = 0;
    if (traits.fence != Fence::walls && random.chance(0.5))
        body.shape = Segment{{-radius, 0}, {radius, 0}}, body.angle = random.uniform(0, std::numbers::pi);
    return body;
}

}  // namespace

PassiveTraits passive_traits(std::uint64_t seed, std::uint64_t index, std::int64_t most_bodies) {
    Random random(seed, index);
    PassiveTraits traits{.seed = seed, .index = index};
    traits.bodies = std::min(most_bodies, static_cast<std::int64_t>(number_of_bodies(random)));
    traits.restitution = random.one_of<double>(kRestitutions);
    traits.friction = random.one_of<double>(kFrictions);
    const double other = random.one_of<double>(kRestitutions);
    traits.wall_restitution = random.chance(0.7) ? traits.restitution : other;
    traits.fill = random.uniform(0.2, 0.9);
    traits.unit = random.log_uniform(1e-2, 1e2);
    traits.radius_ratio = random.chance(0.5) ? 3 : 1;
    const bool is_heavy = random.chance(0.5), is_in_units = random.chance(0.5),
               is_let_go = random.chance(0.5);
    const double speed = traits.unit * random.log_uniform(0.3, 10), room = random.log_uniform(1, 4);
    if (is_heavy) traits.gravity = kGravity * (is_in_units ? traits.unit : 1), traits.room = room;
    traits.speed = is_heavy && is_let_go ? 0 : speed;
    const bool has_obstacles = random.chance(0.25);
    if (has_obstacles) traits.fixed_share = 0.05;
    traits.dt = random.one_of<double>(kSteps);
    traits.fence = random.one_of<Fence>(std::array{Fence::walls, Fence::segments, Fence::chain});
    traits.sides = 3 + static_cast<int>(random.below(6));
    traits.precision = random.chance(0.5) ? Precision::single_ : Precision::double_;
    return traits;
}

std::string in_words(const PassiveTraits& traits) {
    const char* const fence = traits.fence == Fence::walls   ? "walls"
                              : traits.fence == Fence::chain ? "chain"
                                                             : "segments";
    std::string text = measure::format("#%llu N %lld e %g", static_cast<unsigned long long>(traits.index),
                                       static_cast<long long>(traits.bodies), traits.restitution);
    if (traits.wall_restitution != traits.restitution)
        text += measure::format(" (walls %g)", traits.wall_restitution);
    text += measure::format(" f %g fill %.2f r 1:%g %.2g m v %.2g g %.2g dt 1/%.0f %s", traits.friction,
                            traits.fill, traits.radius_ratio, 0.5 * traits.unit, traits.speed, traits.gravity,
                            1 / traits.dt, fence);
    if (traits.fence != Fence::walls) text += measure::format(" %d", traits.sides);
    if (traits.fixed_share > 0) text += " obstacles";
    return text;
}

PassiveScene passive_scene(const PassiveTraits& traits) {
    Random random(traits.seed ^ 0x9E3779B97F4A7C15u, traits.index);  // others than those of the traits
    const Spacing spacing = spacing_of(traits);
    Place place = place_for(traits, spacing.lattice, random);
    choose_sites(place.sites, traits, random);
    Scene scene;
    scene.gravity = {0, -traits.gravity};
    scene.step.dt = traits.dt;
    scene.effects.ledger = true;
    std::vector<double> lowest;
    for (std::size_t i = 0; i < place.sites.size(); ++i) {
        const bool is_fixed = i > 0 && random.chance(traits.fixed_share);
        const Body& body =
            scene.bodies.emplace_back(body_at(place.sites[i], traits, spacing, is_fixed, random));
        const Disc* disc = std::get_if<Disc>(&body.shape);
        lowest.push_back(place.enclosure.lowest_centre(disc ? disc->radius : 0));
    }
    place.enclosure.add_to(scene, material_of(traits.wall_restitution, traits.friction));
    lowest.resize(scene.bodies.size(), 0);
    return {std::move(scene), std::move(place.enclosure), std::move(lowest)};
}

}  // namespace carom::torture
