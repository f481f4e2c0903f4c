#include <doctest/doctest.h>
#include <carom/carom.hpp>
#include <carom/generators.hpp>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>

#include "support/report.hpp"

// Every allocation of the test program passes here and is counted.

namespace {

std::atomic<long> allocation_count{0};

void* counted(std::size_t bytes, std::size_t alignment) {
    ++allocation_count;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    if (void* memory = std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded)) return memory;
    throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    ++allocation_count;
    return std::malloc(bytes == 0 ? 1 : bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
    ++allocation_count;
    return std::malloc(bytes == 0 ? 1 : bytes);
}
void* operator new(std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new[](std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
    return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace test_memory {

using namespace carom;

namespace {

/// Discs between walls at packing fraction .3; what varies from test to test is set by the caller.
Scene box_of_discs(std::int64_t count, RadiusRange radius) {
    Scene scene;
    scene.walls.emplace();
    const double side = std::sqrt(static_cast<double>(count) * 3.14159 * radius.max * radius.max / 0.3);
    scene.walls->max = {side, side};
    scene.walls->material.restitution = 1;
    Gas gas;
    gas.count = count;
    gas.radius = radius;
    gas.velocity_rms = 3;
    gas.body.material.restitution = 1;
    add_gas(scene, gas);
    return scene;
}

/// Discs with friction in a square container of edges, which turns.
/// @param spin  rad/s
Scene discs_in_a_container(int discs_a_side, double spin) {
    Scene scene;
    scene.gravity = {0, -10};
    const double half = 0.3 * discs_a_side;
    const Material rough{.friction = 0.5};
    scene.add(
        {.type = spin == 0 ? BodyType::static_body : BodyType::kinematic_body,
         .shape = Chain{.points = {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, .loop = true},
         .angular_velocity = spin,
         .material = rough});
    Lattice discs;
    discs.count_x = discs_a_side, discs.count_y = discs_a_side / 2;
    discs.origin = {-half + 0.3, -half + 0.3}, discs.spacing = {0.56, 0.56};
    discs.jitter = 0.02, discs.radius_range = RadiusRange{0.15, 0.25};
    discs.body.material = rough;
    add_lattice(scene, discs);
    return scene;
}

constexpr double kStep = 1.0 / 60;  // s

template <class World>
long allocations_of_steps(World& world, int warm_up, int steps) {
    for (int i = 0; i < warm_up; ++i) world.step(kStep);
    const long before = allocation_count.load();
    for (int i = 0; i < steps; ++i) world.step(kStep);
    return allocation_count.load() - before;
}

}  // namespace

TEST_SUITE("world/memory") {
    TEST_CASE_TEMPLATE("a warm gas steps without an allocation", World, carom::World, World64) {
        World world(box_of_discs(2000, {0.5, 0.5}), {.threads = 1});
        // Buffers grow to the busiest step so far: a longer run has fewer left to come.
        CHECK(allocations_of_steps(world, 1500, 200) == 0);
    }

    TEST_CASE(
        "a warm world with gravity, drag, mixed sizes, spin and the ledger steps without an allocation") {
        Scene scene = box_of_discs(300, {0.2, 0.6});
        scene.gravity = {0, -4};
        scene.drag = {.linear = 0.02, .angular = 0.2};
        scene.bodies[7].angular_velocity = 3;
        scene.effects.ledger = true;
        World world(scene, {.threads = 1});
        CHECK(allocations_of_steps(world, 600, 100) == 0);
    }

    TEST_CASE_TEMPLATE(
        "a warm drum with friction, sizes and edges, under solver soft, steps without an allocation", Real,
        float, double) {
        Scene scene = discs_in_a_container(15, 0.7);
        scene.effects.ledger = true;
        scene.bodies[7].material.rolling_resistance = 0.1;
        scene.bodies[8].material.restitution = 0.5;
        BasicWorld<Real> world(scene, {.threads = 1});
        REQUIRE(world.plan().solver == "soft");
        CHECK(allocations_of_steps(world, 5000, 200) == 0);
    }

    TEST_CASE_TEMPLATE("discs that sleep and are woken again and again allocate nothing in the end", Real,
                       float, double) {
        Scene scene = discs_in_a_container(8, 0);
        scene.effects.sleep = true;
        for (Body& body : scene.bodies) body.material.rolling_resistance = 0.1;
        BasicWorld<Real> world(scene, {.threads = 1});
        const BodyId one{5, 0};
        int times_asleep = 0;
        // Kicked up every three seconds, it wakes the others.
        const auto allocations = [&](int kicks) {
            long count = 0;
            for (int kick = 0; kick < kicks; ++kick) {
                times_asleep += world.is_asleep(one);
                world.set_velocity(one, {0.3, 4});
                const long before = allocation_count.load();
                for (int i = 0; i < 180; ++i) world.step(kStep);
                count += allocation_count.load() - before;
            }
            return count;
        };
        allocations(140);  // until blows and wedges have called for their room
        times_asleep = 0;
        CHECK(allocations(10) == 0);
        CHECK(times_asleep > 5);
    }

    TEST_CASE("memory a body stays below what docs/how-a-step-works.md can count on") {
        constexpr double kMostBytes = 300;  // a body; in float, all scratch memory included
        for (const std::int64_t count : {10'000, 50'000}) {
            World world(box_of_discs(count, {0.5, 0.5}), {.threads = 1});
            for (int i = 0; i < 60; ++i) world.step(kStep);
            const double bytes = static_cast<double>(world.profile().bytes) / static_cast<double>(count);
            test::report("memory of a gas of ", count, ": ", bytes, " bytes a body");
            CHECK(bytes < kMostBytes);
            CHECK(bytes > 32);  // the columns alone
        }
    }

    TEST_CASE("a small world is made of little memory, and has little when it has run") {
        Scene scene = discs_in_a_container(8, 0);
        scene.bodies.resize(31);  // thirty discs in their container
        World world(scene, {.solver = Solver::soft, .threads = 1});
        const auto made = world.profile().bytes;
        for (int i = 0; i < 300; ++i) world.step(kStep);
        const auto run = world.profile().bytes;
        test::report("memory of thirty discs: ", made, " bytes when made, ", run, " bytes when run");
        CHECK(made <= 40 * 1024);
        CHECK(run <= 100 * 1024);
    }

    TEST_CASE("one body flying off to the limit costs no memory") {
        Scene scene = box_of_discs(2000, {0.5, 0.5});
        scene.walls.reset();
        World near_by(scene, {.threads = 1});
        scene.bodies[3].position = {0.9e8, -0.9e8};
        World far_off(scene, {.threads = 1});
        for (int i = 0; i < 20; ++i) near_by.step(kStep), far_off.step(kStep);
        CHECK(static_cast<double>(far_off.profile().bytes) <
              1.5 * static_cast<double>(near_by.profile().bytes));
    }
}

}  // namespace test_memory
