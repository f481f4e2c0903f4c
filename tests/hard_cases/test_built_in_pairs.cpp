// Mechanisms whose bodies are in each other as they are built: joints hold what contacts would part.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <carom/carom.hpp>

namespace test_built_in_pairs {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr Material kRough{.friction = 0.5};

template <class W>
double fastest(const W& world) {
    const auto view = world.bodies();
    double most = 0;
    for (std::size_t row = 0; row < view.count; ++row)
        most = std::max(most, std::hypot(static_cast<double>(view.velocity_x[row]),
                                         static_cast<double>(view.velocity_y[row])));
    return most;
}

Scene over_a_floor() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.effects.ledger = true;
    scene.add({.type = BodyType::static_body, .shape = Segment{{-50, 0}, {50, 0}}, .material = kRough});
    return scene;
}

/// Capsules end to end around a circle of 1 m, each with its next on a soft weld; those after the next
/// overlap by up to .15 m.
Scene welded_ring(int count, double radius, double frequency) {
    Scene scene = over_a_floor();
    const double height = 1 + radius + 0.02, sector = 2 * std::numbers::pi / count;
    std::vector<BodyId> links;
    for (int i = 0; i < count; ++i) {
        const double angle = i * sector;
        links.push_back(scene.add({.shape = Capsule{2 * std::sin(0.5 * sector), radius},
                                   .position = {std::cos(angle), height + std::sin(angle)},
                                   .angle = angle + 0.5 * std::numbers::pi,
                                   .material = kRough}));
    }
    for (std::size_t i = 0; i < links.size(); ++i) {
        const double angle = (static_cast<double>(i) + 0.5) * sector, reach = std::cos(0.5 * sector);
        scene.add(
            Joint{.a = links[i],
                  .b = links[(i + 1) % links.size()],
                  .kind = WeldJoint{.anchor = Vec2{reach * std::cos(angle), height + reach * std::sin(angle)},
                                    .frequency = frequency,
                                    .damping_ratio = 0.5}});
    }
    return scene;
}

/// Discs of .3 m, .2 m from each other, on hinges between them, above a floor.
Scene chain_of_discs() {
    Scene scene = over_a_floor();
    BodyId before;
    for (int i = 0; i < 12; ++i) {
        const BodyId disc =
            scene.add({.shape = Disc{0.3}, .position = {0.2 * i, 1}, .mass = 1, .material = kRough});
        if (i > 0)
            scene.add(Joint{.a = before, .b = disc, .kind = RevoluteJoint{.anchor = Vec2{0.2 * i - 0.1, 1}}});
        before = disc;
    }
    return scene;
}

/// Two discs of .5 m that overlap by .3 m, each at the end of a smooth arm of 2 m around the origin.
struct TwoArms {
    Scene scene;
    BodyId one, other;

    explicit TwoArms(bool is_one_mechanism) {
        const double angle = std::asin(0.35 / 2);
        const auto add_arm = [&](double side) {
            const Vec2 at{2 * std::cos(angle), 2 * side * std::sin(angle)};
            return scene.add({.shape = Disc{0.5}, .position = at, .mass = 1, .material = {.restitution = 1}});
        };
        one = add_arm(1), other = add_arm(-1);
        const BodyId hub = scene.add({.shape = Disc{0.1}, .mass = 100});
        const auto hold = [&](BodyId body) {
            scene.add(Joint{.a = is_one_mechanism ? std::optional(hub) : std::nullopt,
                            .b = body,
                            .kind = RevoluteJoint{.anchor = Vec2{0, 0}}});
        };
        hold(one), hold(other);
    }
};

double distance(const World64& world, BodyId a, BodyId b) {
    const auto view = world.bodies();
    const std::size_t i = world.row(a), k = world.row(b);
    return std::hypot(view.position_x[k] - view.position_x[i], view.position_y[k] - view.position_y[i]);
}

/// As it turns around the origin by so much per second.
void turn(World64& world, BodyId body, double rate) {
    const auto view = world.bodies();
    const std::size_t row = world.row(body);
    world.set_velocity(body, {-rate * view.position_y[row], rate * view.position_x[row]});
    world.set_angular_velocity(body, rate);
}

}  // namespace

TEST_SUITE("hard cases: built-in pairs") {
    // Contacts pushed bodies apart, welds drew them together: energies up to 900 J from 120 J, for ever.
    TEST_CASE_TEMPLATE("rings of welded capsules that overlap get no energy and come to rest", W, World,
                       World64) {
        struct Ring {
            int count;
            double radius, frequency;
        };
        for (const Ring ring :
             {Ring{12, 0.35, 15}, Ring{20, 0.18, 15}, Ring{24, 0.2, 15}, Ring{20, 0.17, 5}}) {
            CAPTURE(ring.count);
            W world(welded_ring(ring.count, ring.radius, ring.frequency));
            double most = 0;
            const double first = world.ledger().energy.total();
            for (int step = 0; step < 1200; ++step) {
                world.step(kStep);
                most = std::max(most, world.ledger().energy.total());
            }
            CHECK(most < first * 1.00001);
            CHECK(fastest(world) < 0.002);
        }
    }

    // It crept at .4 m/s for ever with its hinges .2 m open.
    TEST_CASE_TEMPLATE("a chain of discs of which every other two overlap lies still, its hinges closed", W,
                       World, World64) {
        W world(chain_of_discs());
        for (int step = 0; step < 1200; ++step) world.step(kStep);
        CHECK(fastest(world) < 1e-3);
        CHECK(world.joint_errors().max < 1e-4);
    }

    TEST_CASE("a built-in pair touches once it has come apart") {
        const TwoArms arms(true);
        World64 world(arms.scene);
        turn(world, arms.one, 1), turn(world, arms.other, -1);
        const double radii = 1;
        bool was_apart = false, has_met = false;
        double nearest = 4;
        for (int step = 0; step < 900; ++step) {
            world.step(kStep);
            const double now = distance(world, arms.one, arms.other);
            was_apart = was_apart || now > radii;
            has_met = has_met || (step > 60 && now < 1.05 * radii);
            if (was_apart) nearest = std::min(nearest, now);
        }
        CHECK(was_apart);
        CHECK(has_met);
        CHECK(nearest > 0.99 * radii);
    }

    TEST_CASE("a pair stays built in through a saved state, and the bits are the same") {
        const TwoArms arms(true);
        World64 world(arms.scene), other(arms.scene);
        for (int step = 0; step < 30; ++step) world.step(kStep);
        CHECK(distance(world, arms.one, arms.other) == doctest::Approx(0.7));  // nothing parts them
        std::vector<std::byte> state(world.state_bytes());
        world.save_state(state);
        other.restore_state(state);
        for (World64* each : {&world, &other}) {
            turn(*each, arms.one, 1), turn(*each, arms.other, -1);
            for (int step = 0; step < 300; ++step) each->step(kStep);
        }
        CHECK(other.state_hash() == world.state_hash());
    }

    TEST_CASE("bodies of two mechanisms, and those that a joint lets touch, part as ever") {
        const TwoArms arms(false);
        World64 world(arms.scene);
        for (int step = 0; step < 120; ++step) world.step(kStep);
        CHECK(distance(world, arms.one, arms.other) > 0.97);

        Scene scene;
        const BodyId a = scene.add({.shape = Disc{0.5}, .mass = 1}),
                     b = scene.add({.shape = Disc{0.5}, .position = {0.7, 0}, .mass = 1});
        scene.add(Joint{.a = a, .b = b, .kind = DistanceJoint{.min = 0.1, .max = 2}, .collide = true});
        World64 rope(scene);
        for (int step = 0; step < 120; ++step) rope.step(kStep);
        CHECK(distance(rope, a, b) > 0.97);
    }

    TEST_CASE(
        "the second link of a chain may begin in the block it hangs from, other bodies are pushed out") {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId block = scene.add({.type = BodyType::static_body, .shape = Box{8, 1}});
        const auto hang = [&](BodyId above, Vec2 at, Vec2 anchor) {
            const BodyId disc = scene.add({.shape = Disc{0.3}, .position = at, .mass = 1});
            scene.add(Joint{.a = above, .b = disc, .kind = RevoluteJoint{.anchor = anchor}});
            return disc;
        };
        const BodyId first = hang(block, {0, -0.3}, {0, -0.2}), second = hang(first, {0, -0.6}, {0, -0.45});
        // A mast of three discs on the block, of which the last is held .1 m too low.
        BodyId mast = hang(block, {3, 1}, {3, 0.5});
        mast = hang(mast, {3.5, 1.2}, {3.2, 1.2});
        mast = hang(mast, {3.3, 0.7}, {3.5, 1});
        World64 world(scene);
        for (int step = 0; step < 300; ++step) world.step(kStep);
        const auto y = [&](BodyId body) { return world.bodies().position_y[world.row(body)]; };
        CHECK(y(second) == doctest::Approx(-0.6));
        CHECK(y(mast) > 0.77);
    }

    TEST_CASE("a body in place of one that was removed touches what that was built into") {
        TwoArms arms(true);
        World64 world(arms.scene);
        for (int step = 0; step < 10; ++step) world.step(kStep);
        world.remove(arms.other);
        const BodyId next = world.add({.shape = Disc{0.5}, .position = {2, -0.35}, .mass = 1});
        REQUIRE(next.index == arms.other.index);  // the slot is used again
        for (int step = 0; step < 120; ++step) world.step(kStep);
        CHECK(distance(world, arms.one, next) > 0.97);
    }

    TEST_CASE("what lies on another goes on lying there when joints make them one mechanism") {
        Scene scene = over_a_floor();
        std::vector<BodyId> boxes;
        for (int i = 0; i < 4; ++i)
            boxes.push_back(
                scene.add({.shape = Box{1, 1}, .position = {0, 0.5 + i}, .mass = 1, .material = kRough}));
        World world(scene);
        for (int step = 0; step < 60; ++step) world.step(kStep);
        for (std::size_t i = 0; i + 2 < boxes.size(); ++i)
            world.add(Joint{.a = boxes[i], .b = boxes[i + 2], .kind = DistanceJoint{.max = 3}});
        for (int step = 0; step < 120; ++step) world.step(kStep);
        for (std::size_t i = 0; i < boxes.size(); ++i)
            CHECK(world.bodies().position_y[world.row(boxes[i])] ==
                  doctest::Approx(0.5 + static_cast<double>(i)).epsilon(0.01));
    }
}

}  // namespace test_built_in_pairs
