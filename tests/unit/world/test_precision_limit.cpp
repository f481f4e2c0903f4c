// Where single precision ends is said, with the remedy.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <string>

namespace test_precision_limit {

namespace {

using namespace carom;

/// A disc of half a metre 1 m from the origin, and a body of another type and size at `far`.
Scene scene_with(double radius, double far, BodyType type = BodyType::dynamic_body) {
    Scene scene;
    scene.add({.shape = Disc{0.5}, .position = {1, 0}});
    scene.add({.type = type, .shape = Disc{radius}, .position = {3, -far}});
    return scene;
}

template <class World>
std::vector<std::string> limits_of(const Scene& scene) {
    return World(scene, {.threads = 1}).plan().limits;
}

TEST_CASE("a body so far from the origin that its coordinates are coarse is named, with the remedy") {
    CHECK(limits_of<World>(scene_with(0.5, 1000)).empty());
    CHECK(limits_of<World>(scene_with(500, 1e6)).empty());
    CHECK(limits_of<World>(scene_with(0.5, 1e6, BodyType::static_body)).empty());
    CHECK(limits_of<World64>(scene_with(0.5, 1e6)).empty());
    const std::vector<std::string> limits = limits_of<World>(scene_with(0.5, 1e6));
    REQUIRE(limits.size() == 1);
    for (const char* part : {"body 1 ", "1e+06 m", "0.062 m", "12 %", "double precision"})
        CHECK_MESSAGE(limits[0].find(part) != std::string::npos, limits[0]);
}

TEST_CASE("a small body nearer to the origin may be the coarsest, and a capsule counts by its thickness") {
    Scene scene = scene_with(0.5, 1e5);
    scene.add({.shape = Capsule{1, 0.001}, .position = {1000, 0}});
    const std::vector<std::string> limits = limits_of<World>(scene);
    REQUIRE(limits.size() == 1);
    CHECK_MESSAGE(limits[0].find("body 2 ") != std::string::npos, limits[0]);
}

TEST_CASE("a mass that contacts of shapes have no numbers for is named, with the remedy") {
    Scene scene;
    for (const double mass : {1.0, 2e-11, 3e-14, 2e13, 1e11})
        scene.add({.shape = Box{1, 1}, .position = {mass < 1 ? -3.0 : 3.0, 0}, .mass = mass});
    CHECK(limits_of<World64>(scene).empty());
    const std::vector<std::string> limits = limits_of<World>(scene);
    REQUIRE(limits.size() == 1);
    for (const char* part : {"body 2 ", "3e-14 kg", "1e-12", "1e+12 kg", "double precision"})
        CHECK_MESSAGE(limits[0].find(part) != std::string::npos, limits[0]);
    for (Body& body : scene.bodies) body.shape = Disc{0.5};
    CHECK(limits_of<World>(scene).empty());
}

}  // namespace

}  // namespace test_precision_limit
