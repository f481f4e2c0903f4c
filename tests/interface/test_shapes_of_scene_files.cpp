#include "interface/refused_scene.hpp"

#include <doctest/doctest.h>

#include <string>

namespace test_shapes_of_scene_files {

using namespace carom;
using namespace carom::test;
using namespace carom::tool;

namespace {

std::string scene_with(const std::string& shape) {
    return R"({"carom": 1, "bodies": [{"name": "it", "shape": )" + shape + "}]}";
}

template <class Kind>
Kind read(const std::string& shape) {
    return std::get<Kind>(parse_scene(scene_with(shape), "test.json").bodies.at(0).shape);
}

void check_refused(const std::string& shape, ErrorCode code, const std::string& pointer,
                   const std::string& words) {
    check_refused_scene(scene_with(shape), code, "/bodies/0/shape/" + pointer, words);
}

}  // namespace

TEST_CASE("scene files have boxes, capsules and polygons") {
    const Box box = read<Box>(R"({"box": {"width": 3, "height": 0.5}})");
    CHECK(box.width == 3);
    CHECK(box.height == 0.5);
    const Capsule capsule = read<Capsule>(R"({"capsule": {"length": 2, "radius": 0.25}})");
    CHECK(capsule.length == 2);
    CHECK(capsule.radius == 0.25);
    const Polygon sharp = read<Polygon>(R"({"polygon": {"vertices": [[1, 1], [2, 1], [1, 4]]}})");
    CHECK(sharp.vertices.size() == 3);
    CHECK(sharp.vertices[2] == Vec2{1, 4});
    CHECK(sharp.radius == 0);
    CHECK(read<Polygon>(R"({"polygon": {"vertices": [[1, 1], [2, 1], [1, 4]], "radius": 1}})").radius == 1);
}

TEST_CASE("what is wrong with a shape in a scene file is said with its place there") {
    using enum ErrorCode;
    check_refused(R"({"box": {"width": 1}})", missing, "box", "\"height\" is missing");
    check_refused(R"({"box": {"width": 1, "heigh": 1}})", unknown_name, "box/heigh",
                  "nearest known one is \"height\"");
    check_refused(R"({"box": {"width": 0, "height": 1}})", out_of_range, "box/width",
                  "body 0 (\"it\") has width 0 m; expected 1e-09 <= width <= 1e+07 m");
    check_refused(R"({"capsule": {"length": 1, "radius": "1"}})", wrong_type, "capsule/radius", "a string");
    check_refused(R"({"polygon": {"vertices": 3}})", wrong_type, "polygon/vertices", "3");
    check_refused(R"({"polygon": {"vertices": [[0, 0], [1]]}})", wrong_type, "polygon/vertices/1", "");
    check_refused(R"({"polygon": {"vertices": [[0, 0], [1, 0], [0.2, 0.2], [0, 1]]}})", inconsistent,
                  "polygon/vertices/2", "a dent at vertex 2, [0.2, 0.2]; expected a convex polygon");
}

}  // namespace test_shapes_of_scene_files
