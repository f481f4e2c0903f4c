// An embedding program's parallel-for that throws: the world finishes its step without it, and the exception
// comes out of the call.
#include "support/effort.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace test_failing_host {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// What a host was told to do wrong.
struct HostFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class Failure { before_all, in_the_middle, after_all };

/// Fails in loop `failing` of those it is asked for, by itself or on one of two threads.
class Host {
  public:
    Host(Failure failure, int failing) : failure_(failure), failing_(failing) {}

    ParallelFor parallel_for() {
        return [this](std::size_t count, const std::function<void(std::size_t)>& task) {
            const bool fails = loops_++ == failing_;
            if (fails && failure_ == Failure::before_all) throw HostFailure("no thread");
            const std::size_t end = fails && failure_ == Failure::in_the_middle ? count / 2 : count;
            std::thread other([&] {
                for (std::size_t i = 0; i < end; i += 2) task(i);
            });
            for (std::size_t i = 1; i < end; i += 2) task(i);
            other.join();
            if (fails) throw HostFailure("a thread broke down");
        };
    }
    int loops() const { return loops_; }

  private:
    Failure failure_;
    int failing_, loops_ = 0;
};

/// A heap under solver `soft`, with walls, spin, bounces and unlike masses.
Scene heap() {
    Scene scene;
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.4, .restitution = 0.3};
    scene.walls = Walls{.min = {0, 0}, .max = {150, 200}, .top = false, .material = rough};
    Lattice lattice;
    lattice.count_x = 120, lattice.count_y = 80;
    lattice.origin = {0.7, 0.7}, lattice.spacing = {1.02, 1.01};
    lattice.jitter = 0.005;
    lattice.radius_range = RadiusRange{0.4, 0.5};
    lattice.body.material = rough;
    add_lattice(scene, lattice);
    return scene;
}

/// Three steps, the second with a failure in its loop `failing`. @return whether that loop exists
bool check_failure(const Scene& scene, const World& untouched, std::uint64_t after_first, Failure failure,
                   int loops_before, int failing) {
    Host host(failure, loops_before + failing);
    World world(scene, {.threads = 2, .parallel_for = host.parallel_for()});
    world.step(kStep);
    REQUIRE(host.loops() == loops_before);
    CHECK(world.state_hash() == after_first);
    bool failed = false;
    try {
        world.step(kStep);
    } catch (const HostFailure&) {
        failed = true;
    }
    CHECK(world.time() == doctest::Approx(2 * kStep));
    world.step(kStep);
    CHECK(world.state_hash() == untouched.state_hash());
    CHECK(failed == (host.loops() > loops_before + failing));
    return failed;
}

void check_failures(const Scene& scene, int fewest_loops) {
    World untouched(scene, {.threads = 1});
    untouched.step(kStep);
    const std::uint64_t after_first = untouched.state_hash();
    untouched.step(kStep), untouched.step(kStep);
    Host sound(Failure::before_all, -1);
    World counted(scene, {.threads = 2, .parallel_for = sound.parallel_for()});
    counted.step(kStep);
    const int before = sound.loops();
    counted.step(kStep);
    const int loops = sound.loops() - before;
    REQUIRE(loops >= fewest_loops);
    for (const Failure failure : {Failure::before_all, Failure::in_the_middle, Failure::after_all})
        for (int failing = 0; failing < loops; failing += 1 + loops / scaled(8, 4)) {
            CAPTURE(static_cast<int>(failure));
            CAPTURE(failing);
            CHECK(check_failure(scene, untouched, after_first, failure, before, failing));
        }
}

}  // namespace

TEST_SUITE("world/failing host") {
    TEST_CASE("a step of soft whose host fails in any loop is finished, with the same bits") {
        check_failures(heap(), 12);
    }

    TEST_CASE("a step of impulse whose host fails in any loop is finished, with the same bits") {
        check_failures(gas_scene({.count = 17000, .packing_fraction = 0.3}), 2);
    }

    TEST_CASE("a host that fails while overlaps are measured is told so, and the next answer is right") {
        const Scene scene = gas_scene({.count = 17000, .packing_fraction = 0.3});
        Host host(Failure::in_the_middle, 0);
        World world(scene, {.threads = 2, .parallel_for = host.parallel_for()}), untouched(scene);
        CHECK_THROWS_AS(world.overlaps(), HostFailure);
        CHECK(world.overlaps().candidates == untouched.overlaps().candidates);
        world.step(kStep), untouched.step(kStep);
        CHECK(world.state_hash() == untouched.state_hash());
    }

    TEST_CASE("a host that leaves tasks out does not leave bodies out") {
        const Scene scene = heap();
        const ParallelFor lazy = [](std::size_t count, const std::function<void(std::size_t)>& task) {
            for (std::size_t i = 0; i < count; i += 3) task(i);
        };
        World world(scene, {.threads = 2, .parallel_for = lazy}), untouched(scene, {.threads = 1});
        for (int i = 0; i < 3; ++i) world.step(kStep), untouched.step(kStep);
        CHECK(world.state_hash() == untouched.state_hash());
    }
}

}  // namespace test_failing_host
