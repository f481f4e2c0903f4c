// Compounds, sensors and events of a scene file: what is read, and what is refused, where.
#include "interface/refused_scene.hpp"

#include <doctest/doctest.h>

#include <string>

namespace test_scene_compounds {

using namespace carom;
using namespace carom::test;
using namespace carom::tool;

namespace {

std::string with_body(const std::string& keys, const std::string& rest = "") {
    return R"({"carom": 1, "materials": {"lead": {"density": 11}}, "bodies": [{)" + keys + "}]" + rest + "}";
}

}  // namespace

TEST_SUITE("interface: compounds and sensors") {
    TEST_CASE("a compound is read with the places, angles and materials of its pieces") {
        const Scene scene = parse_scene(with_body(R"("shape": {"compound": {"shapes": [
            {"shape": {"box": {"width": 3, "height": 1}}, "position": [1, 2], "angle": 0.5, "material": "lead"},
            {"shape": {"disc": {"radius": 0.5}}}]}})"),
                                        "test.json");
        const auto& compound = std::get<Compound>(scene.bodies[0].shape);
        REQUIRE(compound.pieces.size() == 2);
        CHECK(std::get<Box>(compound.pieces[0].shape).width == 3);
        CHECK(compound.pieces[0].position == Vec2{1, 2});
        CHECK(compound.pieces[0].angle == 0.5);
        CHECK(compound.pieces[0].material->density == 11);
        CHECK(std::get<Disc>(compound.pieces[1].shape).radius == 0.5);
        CHECK_FALSE(compound.pieces[1].material.has_value());
    }

    TEST_CASE("compounds that cannot be are refused where they stand") {
        check_refused_scene(with_body(R"("shape": {"compound": {"shapes": []}})"), ErrorCode::out_of_range,
                            "/bodies/0/shape/compound/shapes", "a compound of 0 shapes");
        check_refused_scene(
            with_body(
                R"("shape": {"compound": {"shapes": [{"shape": {"segment": {"a": [0, 0], "b": [1, 0]}}}]}})"),
            ErrorCode::unknown_name, "/bodies/0/shape/compound/shapes/0/shape/segment", "segment");
        check_refused_scene(
            with_body(R"("shape": {"compound": {"shapes": [{"shape": {"disc": {"radius": 0}}}]}})"),
            ErrorCode::out_of_range, "/bodies/0/shape/compound/shapes/0/shape/disc/radius", "radius 0 m");
        check_refused_scene(with_body(R"("shape": {"compound": {"pieces": []}})"), ErrorCode::unknown_name,
                            "/bodies/0/shape/compound/pieces", "pieces");
    }

    TEST_CASE("sensors and the events that are wanted are read") {
        const std::string sensor = R"("shape": {"disc": {"radius": 1}}, "sensor": true)";
        CHECK(parse_scene(with_body(sensor), "t").bodies[0].sensor);
        CHECK_FALSE(parse_scene(with_body(sensor), "t").events.sensor.has_value());
        CHECK(parse_scene(with_body(sensor, R"(, "events": ["sensor"])"), "t").events.sensor == true);
        CHECK(parse_scene(with_body(sensor, R"(, "events": [])"), "t").events.sensor == false);
        check_refused_scene(with_body(sensor, R"(, "events": ["hit"])"), ErrorCode::not_built_yet,
                            "/events/0", "not built in this version");
        check_refused_scene(with_body(sensor, R"(, "events": ["sensors"])"), ErrorCode::unknown_name,
                            "/events/0", "sensor");
        check_refused_scene(
            with_body(
                R"("shape": {"segment": {"a": [0, 0], "b": [1, 0]}}, "type": "static", "sensor": true)"),
            ErrorCode::inconsistent, "/bodies/0/sensor", "expected a shape with an area");
    }
}

}  // namespace test_scene_compounds
