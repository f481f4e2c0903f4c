// A scene with an effect on that has no value in it moves as without: the same bits, for every effect that a
// scene can force, each solver that has it and both precisions.
#include "pricing/priced_effects.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

namespace test_zero_valued_effects {

using namespace carom;
using namespace carom::test;
using tool::PricedEffect;

namespace {

constexpr double kStep = 1.0 / 60;

/// Without restitution discs cluster, and solvers that carry out each impact have very many of them.
bool is_for_rest(Solver solver) {
    return solver == Solver::soft;
}

/// Whether the effect has no value that could be zero: on is then something else than off.
bool has_no_zero(const PricedEffect& effect) {
    return effect.name == "sleep";
}

bool has(Solver solver, const PricedEffect& effect) {
    const auto forces = [&](tool::Wish wish) {
        return std::find(effect.wishes.begin(), effect.wishes.end(), wish) != effect.wishes.end();
    };
    if (solver != Solver::soft && forces(&EffectOverrides::rolling_resistance)) return false;
    if (solver == Solver::event) return !forces(&EffectOverrides::drag);
    return true;
}

/// Discs of many sizes that meet each other and the walls, with every law that the solver has.
Scene scene_of_everything(Solver solver) {
    Scene scene = gas_scene({.count = is_for_rest(solver) ? 120 : 40,
                             .packing_fraction = is_for_rest(solver) ? 0.5 : 0.3,
                             .velocity_rms = 4,
                             .restitution = is_for_rest(solver) ? 0.4 : 0.9,
                             .smallest_radius = 0.2,
                             .largest_radius = 0.6});
    scene.gravity = {0.5, -6};
    if (solver != Solver::event) scene.drag = {0.2, 0.3};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Body& body = scene.bodies[i];
        body.angular_velocity = static_cast<double>(i % 7) - 3;
        if (solver != Solver::impulse) body.material.friction = 0.1 * static_cast<double>(i % 5);
        if (solver == Solver::soft) body.material.rolling_resistance = 0.05 * static_cast<double>(i % 3);
    }
    scene.bodies[3].type = BodyType::static_body;
    scene.bodies[3].velocity = {}, scene.bodies[3].angular_velocity = 0;
    scene.bodies[20].fixed_rotation = true;
    scene.bodies[20].angular_velocity = 0;
    if (solver != Solver::impulse) scene.walls->material.friction = 0.3;
    scene.accuracy.solver = solver;
    return scene;
}

Scene scene_of_nothing(Solver solver) {
    Scene scene = scene_of_everything(solver);
    for (const PricedEffect& effect : tool::priced_effects())
        if (effect.take_away) effect.take_away(scene);
    return scene;
}

template <class Real>
std::uint64_t hash_after(const Scene& scene, const EffectOverrides& effects) {
    WorldOptions options;
    options.effects = effects;
    BasicWorld<Real> world(scene, options);
    for (int i = 0; i < (is_for_rest(scene.accuracy.solver) ? 200 : 20); ++i) world.step(kStep);
    CHECK(world.quarantined().empty());
    return world.state_hash();
}

constexpr Solver kSolvers[] = {Solver::impulse, Solver::soft, Solver::event};

}  // namespace

TEST_SUITE("physics/zero-valued effects") {
    TEST_CASE_TEMPLATE("each effect, carried and zero, changes no bit: beside all others and alone", Real,
                       float, double) {
        for (const Solver solver : kSolvers)
            for (const PricedEffect& effect : tool::priced_effects()) {
                if (has_no_zero(effect) || !has(solver, effect)) continue;
                Scene among_all = scene_of_everything(solver), alone = scene_of_nothing(solver);
                if (effect.take_away) effect.take_away(among_all);
                EffectOverrides off, on;
                for (const tool::Wish wish : effect.alongside) off.*wish = on.*wish = true;
                for (const tool::Wish wish : effect.wishes) on.*wish = true;
                CAPTURE(name_of(solver));
                CAPTURE(std::string(effect.name));
                // `event` refuses gravity without restitution: nothing may rest.
                if (solver != Solver::event || effect.name != "restitution")
                    CHECK(hash_after<Real>(among_all, on) == hash_after<Real>(among_all, off));
                CHECK(hash_after<Real>(alone, on) == hash_after<Real>(alone, off));
            }
    }

    TEST_CASE_TEMPLATE("all effects together, carried and zero, change no bit", Real, float, double) {
        for (const Solver solver : kSolvers) {
            EffectOverrides all;
            for (const PricedEffect& effect : tool::priced_effects())
                for (const tool::Wish wish : effect.wishes)
                    if (!has_no_zero(effect) && has(solver, effect)) all.*wish = true;
            CAPTURE(name_of(solver));
            const Scene scene = scene_of_nothing(solver);
            CHECK(hash_after<Real>(scene, all) == hash_after<Real>(scene, {}));
        }
    }

    TEST_CASE("with its values each effect does change the motion, so the scenes above can tell") {
        for (const Solver solver : kSolvers)
            for (const PricedEffect& effect : tool::priced_effects()) {
                if (!effect.take_away || !has(solver, effect)) continue;
                if (solver == Solver::event && effect.name == "restitution") continue;
                // `impulse` has friction only without gravity, which these scenes have.
                if (solver == Solver::impulse && effect.name.find("friction") != std::string::npos) continue;
                Scene without = scene_of_everything(solver);
                effect.take_away(without);
                CAPTURE(name_of(solver));
                CAPTURE(std::string(effect.name));
                CHECK(hash_after<float>(scene_of_everything(solver), {}) != hash_after<float>(without, {}));
            }
    }
}

}  // namespace test_zero_valued_effects
