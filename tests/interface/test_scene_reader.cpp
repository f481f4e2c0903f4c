#include "scene_file/scene_reader.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace test_scene_reader {

using namespace carom;
using namespace carom::tool;

namespace {

struct Refusal {
    ErrorCode code;
    std::string pointer;
    std::string message;
};

Refusal refusal(const std::string& text, const SceneFileLimits& limits = {}) {
    try {
        parse_scene(text, "test.json", limits);
    } catch (const SceneFileError& error) {
        CHECK(error.file() == "test.json");
        return {error.code(), error.pointer(), error.what()};
    }
    FAIL_CHECK("accepted: " << text.substr(0, 200));
    return {};
}

struct Case {
    std::string text;
    ErrorCode code;
    std::string pointer;
    std::vector<std::string> words;  // each is in the message
};

void check_refused(const Case& one) {
    CAPTURE(one.text);
    const Refusal got = refusal(one.text);
    CAPTURE(got.message);
    CHECK(got.code == one.code);
    CHECK(got.pointer == one.pointer);
    CHECK(got.message.starts_with(one.pointer.empty() ? "test.json: " : "test.json: " + one.pointer + ": "));
    for (const std::string& words : one.words) CHECK(got.message.find(words) != std::string::npos);
}

/// A scene with that body beside a sound one.
std::string with_body(const std::string& body) {
    return R"({"carom": 1, "bodies": [{"shape": {"disc": {"radius": 0.5}}}, )" + body + "]}";
}

std::string with_generator(const std::string& generator) {
    return R"({"carom": 1, "walls": {"min": [0, 0], "max": [10, 10]}, "generate": [)" + generator + "]}";
}

std::string repeated(const std::string& text, std::size_t times) {
    std::string out;
    for (std::size_t i = 0; i < times; ++i) out += text;
    return out;
}

const std::vector<Case> kSyntax{
    {"", ErrorCode::malformed, "", {"the file is empty"}},
    {" \n\t", ErrorCode::malformed, "", {"the file is empty"}},
    {R"({"carom": 1, "bodies": [{"sha)", ErrorCode::malformed, "/bodies/0", {"ends too early"}},
    {"{\"carom\": 1,\n  // two balls\n\"bodies\": []}",
     ErrorCode::malformed,
     "/carom",
     {"line 2, column 3", "comments are not JSON"}},
    {R"({"carom": 1 /* one */})", ErrorCode::malformed, "/carom", {"comments are not JSON"}},
    {R"({"carom": 1, "gravity": [0, NaN]})", ErrorCode::malformed, "/gravity/1", {"JSON has no NaN"}},
    {R"({"carom": 1, "gravity": [nan, 0]})", ErrorCode::malformed, "/gravity/0", {"JSON has no NaN"}},
    {R"({"carom": 1, "gravity": [0, -Infinity]})", ErrorCode::malformed, "/gravity/1", {"no infinity"}},
    {R"({"carom": 1, "gravity": [0, 1e999]})", ErrorCode::not_finite, "/gravity/1", {"1e999", "too large"}},
    {R"({"carom": 1, "gravity": [0, -1e999]})", ErrorCode::not_finite, "/gravity/1", {"-1e999"}},
    {R"({"carom": 1, "gravity": [0, +1]})", ErrorCode::malformed, "/gravity/1", {"no plus sign"}},
    {R"({"carom": 1, "gravity": [0, .5]})", ErrorCode::malformed, "/gravity/1", {"write 0.5, not .5"}},
    {R"({"carom": 1, "gravity": [0, 1,]})", ErrorCode::malformed, "/gravity/2", {"comma before it"}},
    {R"({"carom": 1,})", ErrorCode::malformed, "/carom", {"comma before it"}},
    {R"({'carom': 1})", ErrorCode::malformed, "", {"double quotes"}},
    {R"({"carom": 1, "effects": {"ledger": True}})",
     ErrorCode::malformed,
     "/effects/ledger",
     {"small letters"}},
    {R"({"carom": 1}})", ErrorCode::malformed, "", {"line 1, column 13"}},
    {R"({"carom": 1, "name": "a", "name": "b"})", ErrorCode::duplicate_name, "/name", {"twice"}},
    {R"({"carom": 1, "walls": {"min": [0, 0], "min": [1, 1]}})", ErrorCode::duplicate_name, "/walls/min", {}},
    {"{\"carom\": 1, \"name\": \"\xff\xfe\"}", ErrorCode::malformed, "/name", {"UTF-8", "\\xff"}},
    {"{\"carom\": 1, \"name\": \"a\nb\"}",
     ErrorCode::malformed,
     "/name",
     {"line 1, column 24", "control character"}},
    {std::string("{\"carom\"\0: 1}", 13), ErrorCode::malformed, "/carom", {"line 1, column 9"}},
};

const std::vector<Case> kMeaning{
    {"[]", ErrorCode::wrong_type, "", {"expected a scene"}},
    {"{}", ErrorCode::missing, "", {"\"carom\" is missing"}},
    {R"({"carom": 2, "new": 1})", ErrorCode::out_of_range, "/carom", {"version is 2", "expected 1"}},
    {R"({"carom": "1"})", ErrorCode::wrong_type, "/carom", {"\"1\" is a string", "whole number"}},
    {R"({"carom": 1, "gravty": 0})",
     ErrorCode::unknown_name,
     "/gravty",
     {"nearest known one is \"gravity\""}},
    {R"({"carom": 1, "Bodies": []})",
     ErrorCode::unknown_name,
     "/Bodies",
     {"nearest known one is \"bodies\""}},
    {R"({"carom": 1, "gravity": [0, "NaN"]})", ErrorCode::wrong_type, "/gravity/1", {"\"NaN\"", "no NaN"}},
    {R"({"carom": 1, "gravity": [0, "-inf"]})", ErrorCode::wrong_type, "/gravity/1", {"no infinity"}},
    {R"({"carom": 1, "gravity": [0, "-10"]})", ErrorCode::wrong_type, "/gravity/1", {"without quotes"}},
    {R"({"carom": 1, "gravity": [0, null]})",
     ErrorCode::wrong_type,
     "/gravity/1",
     {"null; expected a number"}},
    {R"({"carom": 1, "gravity": [0, 1, 2]})", ErrorCode::wrong_type, "/gravity", {"[0,1,2]", "[x, y]"}},
    {R"({"carom": 1, "drag": {"linaer": 1}})", ErrorCode::unknown_name, "/drag/linaer", {"\"linear\""}},
    {R"({"carom": 1, "drag": {"linear": -1}})", ErrorCode::out_of_range, "/drag/linear", {"drag -1 1/s"}},
    {R"({"carom": 1, "walls": {"min": [0, 0]}})", ErrorCode::missing, "/walls", {"\"max\" is missing"}},
    {R"({"carom": 1, "walls": {"min": [0, 0], "max": [1, -1]}})",
     ErrorCode::inconsistent,
     "/walls/max",
     {"max [1, -1] m", "Swap"}},
    {R"({"carom": 1, "walls": {"min": [0, 0], "max": [1, 1], "sides": ["letf"]}})",
     ErrorCode::unknown_name,
     "/walls/sides/0",
     {"\"letf\"", "nearest known one is \"left\""}},
    {R"({"carom": 1, "walls": {"min": [0, 0], "max": [1, 1], "material": "wood"}})",
     ErrorCode::unknown_name,
     "/walls/material",
     {"no material \"wood\""}},
    {R"({"carom": 1, "materials": {"rubber": {}}, "default_material": "ruber"})",
     ErrorCode::unknown_name,
     "/default_material",
     {"nearest known one is \"rubber\""}},
    {R"({"carom": 1, "materials": {"a/b": {"restitution": 2}}})",
     ErrorCode::out_of_range,
     "/materials/a~1b/restitution",
     {"restitution 2"}},
    {R"({"carom": 1, "accuracy": {"solver": "impulse"}, "gravity": [0, -2],
         "bodies": [{"shape": {"disc": {"radius": 1}}, "material": {"friction": 0.5}}]})",
     ErrorCode::inconsistent,
     "/bodies/0/material/friction",
     {"friction 0.5 and gravity is [0, -2] m/s²", "none where bodies rest", "\"soft\""}},
    {R"({"carom": 1, "step": {"dt": 0}})", ErrorCode::out_of_range, "/step/dt", {"dt 0 s"}},
    {R"({"carom": 1, "step": {"dt": -0.016}})", ErrorCode::out_of_range, "/step/dt", {"dt -0.016 s"}},
    {R"({"carom": 1, "step": {"count": 1.5}})",
     ErrorCode::wrong_type,
     "/step/count",
     {"1.5", "whole number"}},
    {R"({"carom": 1, "step": {"count": 1e30}})", ErrorCode::out_of_range, "/step/count", {"1e+30"}},
    {R"({"carom": 1, "step": {"count": 18446744073709551615}})",
     ErrorCode::out_of_range,
     "/step/count",
     {"2^63"}},
    {R"({"carom": 1, "accuracy": {"solver": "rigid"}})",
     ErrorCode::not_built_yet,
     "/accuracy/solver",
     {"\"rigid\"", "not built yet", "\"impulse\""}},
    {R"({"carom": 1, "accuracy": {"solver": "impuls"}})",
     ErrorCode::unknown_name,
     "/accuracy/solver",
     {"\"impuls\"", "nearest known one is \"impulse\""}},
    {R"({"carom": 1, "accuracy": {"substeps": 99999999999}})",
     ErrorCode::out_of_range,
     "/accuracy/substeps",
     {"99999999999"}},
    {R"({"carom": 1, "accuracy": {"solver": "impulse"}, "effects": {"sleep": true}})",
     ErrorCode::inconsistent,
     "/effects/sleep",
     {"sleep forced on", "\"impulse\" does not have it", "\"soft\""}},
    {R"({"carom": 1, "effects": {"ledger": 1}})",
     ErrorCode::wrong_type,
     "/effects/ledger",
     {"true or false"}},
    {R"({"carom": 1, "gravity": [0, -1], "effects": {"gravity": false}})",
     ErrorCode::inconsistent,
     "/effects/gravity",
     {"forced off"}},
    {R"({"carom": 1, "record": {"every": 0}})", ErrorCode::out_of_range, "/record/every", {"every 0"}},
    {R"({"carom": 1, "joints": [{"revolut": {"a": 0}}]})",
     ErrorCode::unknown_name,
     "/joints/0/revolut",
     {"nearest known one is \"revolute\""}},
};

const std::vector<Case> kBodies{
    {with_body("{}"), ErrorCode::missing, "/bodies/1", {"\"shape\" is missing"}},
    {with_body("3"), ErrorCode::wrong_type, "/bodies/1", {"3; expected an object"}},
    {with_body(R"({"shape": {"disc": {"radius": -0.4}}, "name": "ball"})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/disc/radius",
     {"body 1 (\"ball\") has radius -0.4 m", "1e-09 <= radius <= 1e+07 m"}},
    {with_body(R"({"shape": {"disc": {"radius": 0}}})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/disc/radius",
     {}},
    {with_body(R"({"shape": {"disc": {"raduis": 1}}})"),
     ErrorCode::unknown_name,
     "/bodies/1/shape/disc/raduis",
     {"nearest known one is \"radius\""}},
    {with_body(R"({"shape": {"disk": {"radius": 1}}})"),
     ErrorCode::unknown_name,
     "/bodies/1/shape/disk",
     {"nearest known one is \"disc\""}},
    {with_body(R"({"shape": {"segment": {"a": [0, 0], "b": [1, 0]}}, "name": "line", "type": "dynamic"})"),
     ErrorCode::inconsistent,
     "/bodies/1/type",
     {"body 1 (\"line\") has the shape \"segment\" but is dynamic", "static or kinematic"}},
    {with_body(R"({"shape": {"segment": {"a": [0, 1], "b": [0, 1]}}, "type": "static"})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/segment/b",
     {"an edge of length 0 m", "at least 1e-09 m"}},
    {with_body(R"({"shape": {"segment": {"a": [0, 1], "b": [3, 2e8]}}, "type": "static"})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/segment/b/1",
     {"point y 2e+08 m"}},
    {with_body(R"({"shape": {"chain": {"points": [[0, 1], [1, 1]], "loop": true}}, "type": "static"})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/chain/points",
     {"a chain of 2 points that is a loop; expected at least 3", "loop to false"}},
    {with_body(R"({"shape": {"chain": {"points": [[0, 1], [1, 1], [1, 1]]}}, "type": "kinematic"})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/chain/points/2",
     {"points 1 and 2"}},
    {with_body(R"({"shape": {"chain": {"points": [[0, 1], [1, 1], [1, 2], [0, 1]], "loop": true}},
        "type": "static"})"),
     ErrorCode::out_of_range,
     "/bodies/1/shape/chain/points/3",
     {"which a loop joins by itself"}},
    {with_body(R"({"shape": {}})"), ErrorCode::missing, "/bodies/1/shape", {"one key that says the shape"}},
    {with_body(R"({"shape": {"disc": {"radius": 1}}, "mass": 0})"),
     ErrorCode::out_of_range,
     "/bodies/1/mass",
     {"mass 0 kg"}},
    {with_body(R"({"shape": {"disc": {"radius": 1}}, "mass": -3})"),
     ErrorCode::out_of_range,
     "/bodies/1/mass",
     {}},
    {with_body(R"({"shape": {"disc": {"radius": 1}}, "type": "statc"})"),
     ErrorCode::unknown_name,
     "/bodies/1/type",
     {"nearest known one is \"static\""}},
    {with_body(R"({"shape": {"disc": {"radius": 1}}, "material": {"restitution": -1}})"),
     ErrorCode::out_of_range,
     "/bodies/1/material/restitution",
     {"restitution -1"}},
    {with_body(R"({"shape": {"disc": {"radius": 1e-9}}, "material": {"density": 1e-20}})"),
     ErrorCode::out_of_range,
     "/bodies/1/material/density",
     {"density times area"}},
    {with_body(R"({"shape": {"disc": {"radius": 1}}, "color": "red"})"),
     ErrorCode::out_of_range,
     "/bodies/1/color",
     {"\"#rrggbb\""}},
    {R"({"carom": 1, "bodies": [{"name": "a", "shape": {"disc": {"radius": 1}}},
        {"name": "a", "shape": {"disc": {"radius": 1}}}]})",
     ErrorCode::duplicate_name,
     "/bodies/1/name",
     {"\"a\"", "body 0"}},
    {R"({"carom": 1, "walls": {"min": [0, 0], "max": [4, 4]}, "bodies": [
        {"shape": {"disc": {"radius": 1}}, "position": [5, 1]}]})",
     ErrorCode::out_of_range,
     "/bodies/0/position/0",
     {"outside the right wall"}},
};

const std::vector<Case> kGenerators{
    {with_generator(R"({"pyramid": {"base": 3, "shape": {"disc": {"radius": 1}}}})"),
     ErrorCode::inconsistent,
     "/generate/0/pyramid/shape",
     {"the shape \"disc\"; expected a box"}},
    {with_generator(R"({"stack": {"count": 2, "type": "static",
        "shape": {"segment": {"a": [0, 0], "b": [1, 0]}}}})"),
     ErrorCode::inconsistent,
     "/generate/0/stack/shape",
     {"\"segment\"", "expected a disc, box, capsule, polygon or compound"}},
    {with_generator(R"({"chain": {}})"), ErrorCode::missing, "/generate/0/chain", {"\"count\" is missing"}},
    {with_generator(R"({"net": {"count": [2, 2], "spacing": 0, "shape": {"disc": {"radius": 0.1}}}})"),
     ErrorCode::out_of_range,
     "/generate/0/net/spacing",
     {"spacing 0 m"}},
    {with_generator(R"({"latice": {}})"), ErrorCode::unknown_name, "/generate/0/latice", {"\"lattice\""}},
    {with_generator(R"({"kind": "gass"})"), ErrorCode::unknown_name, "/generate/0/kind", {"\"gas\""}},
    {with_generator(R"({"lattice": {"count": [1000000000, 1000000000], "spacing": [1, 1],
        "radius_range": [1, 1]}})"),
     ErrorCode::out_of_range,
     "/generate/0/lattice/count/0",
     {"1e+09"}},
    {with_generator(R"({"lattice": {"count": [60000000, 1], "spacing": [1, 1], "radius_range": [1, 1]}})"),
     ErrorCode::too_large,
     "/generate/0/lattice/count",
     {"4096 MiB", "expected at most"}},
    {with_generator(R"({"gas": {"count": 67108864, "radius": 1e-5}})"),
     ErrorCode::too_large,
     "/generate/0/gas/count",
     {"4096 MiB"}},
    {with_generator(R"({"gas": {"count": 67108865, "radius": 1e-5}})"),
     ErrorCode::too_large,
     "/generate/0/gas/count",
     {}},
    {with_generator(R"({"gas": {"count": 1e300, "radius": 1e-5}})"),
     ErrorCode::out_of_range,
     "/generate/0/gas/count",
     {"1e+300"}},
    {with_generator(R"({"gas": {"count": 500, "radius": 0.5}})"),
     ErrorCode::out_of_range,
     "/generate/0/gas/count",
     {"does not fit", "3.93"}},
    {with_generator(R"({"gas": {"count": 5, "radius": -1}})"),
     ErrorCode::out_of_range,
     "/generate/0/gas/radius",
     {"radius -1 m"}},
    {with_generator(R"({"gas": {"count": 5, "shape": {"disc": {"radius": 0}}}})"),
     ErrorCode::out_of_range,
     "/generate/0/gas/shape/disc/radius",
     {"radius 0 m"}},
    {with_generator(R"({"gas": {"count": 5, "radius": 1, "radius_range": [1, 2]}})"),
     ErrorCode::inconsistent,
     "/generate/0/gas/radius",
     {"twice"}},
    {with_generator(R"({"kind": "gas", "count": 5, "radius": 0.1, "velocity_rms": -3})"),
     ErrorCode::out_of_range,
     "/generate/0/velocity_rms",
     {"-3 m/s"}},
    {with_generator(R"({"stack": {"count": 30, "origin": [5, 0.5], "shape": {"disc": {"radius": 0.5}}}})"),
     ErrorCode::out_of_range,
     "/generate/0",
     {"of the bodies made here, body 10 has position y 10.5 m"}},
    {R"({"carom": 1, "generate": [{"gas": {"count": 5, "radius": 1}}]})",
     ErrorCode::inconsistent,
     "/generate/0/gas",
     {"no walls"}},
};

}  // namespace

TEST_SUITE("interface/scene_reader") {
    TEST_CASE("text that is not JSON is refused with line, column and a hint") {
        for (const Case& one : kSyntax) check_refused(one);
    }

    TEST_CASE("a wrong setting is refused with its pointer, its value and what was expected") {
        for (const Case& one : kMeaning) check_refused(one);
    }

    TEST_CASE("a wrong body is refused with its pointer, its value and what was expected") {
        for (const Case& one : kBodies) check_refused(one);
    }

    TEST_CASE("a wrong generator is refused with its pointer, its value and what was expected") {
        for (const Case& one : kGenerators) check_refused(one);
    }

    TEST_CASE("a million nested arrays or objects are refused, closed or not") {
        for (const std::string& text :
             {repeated("[", 1000000), repeated("[", 1000000) + repeated("]", 1000000),
              repeated("{\"a\":", 1000000), "{\"carom\": 1, \"joints\": " + repeated("[{\"a\":", 500000)}) {
            const Refusal got = refusal(text);
            CHECK(got.code == ErrorCode::too_large);
            CHECK(got.message.find("nested more than 64 deep") != std::string::npos);
            CHECK(got.message.size() < 1000);
        }
    }

    TEST_CASE("limits of size are kept: bytes, values, bodies") {
        const std::string text = R"({"carom": 1, "bodies": [{"shape": {"disc": {"radius": 1}}}]})";
        CHECK(parse_scene(text, "test.json", {.file_bytes = text.size(), .depth = 5, .values = 7})
                  .bodies.size() == 1);
        CHECK(refusal(text, {.file_bytes = text.size() - 1}).code == ErrorCode::too_large);
        CHECK(refusal(text, {.depth = 4}).code == ErrorCode::too_large);
        CHECK(refusal(text, {.values = 6}).code == ErrorCode::too_large);
        const std::string many = with_generator(R"({"gas": {"count": 11, "radius": 0.1}})");
        CHECK(parse_scene(many, "test.json", {.body_bytes = 11 * sizeof(Body)}).bodies.size() == 11);
        CHECK(refusal(many, {.body_bytes = 10 * sizeof(Body)}).code == ErrorCode::too_large);
    }

    TEST_CASE("messages stay short and printable whatever the file holds") {
        const std::string long_key = repeated("k", 100000);
        const Refusal by_key = refusal("{\"carom\": 1, \"" + long_key + "\": 1}");
        CHECK(by_key.message.size() < 1000);
        const Refusal by_value = refusal("{\"carom\": 1, \"gravity\": \"" + long_key + "\"}");
        CHECK(by_value.message.size() < 1000);
        const Refusal by_syntax = refusal("{\"carom\": 1, \"name\": \"" + long_key + "\x01");
        CHECK(by_syntax.message.size() < 1000);
        for (const std::string& evil :
             {std::string("\\u001b[31mred"), std::string("\\u009b31m"), std::string("a\\nb")}) {
            const Refusal got = refusal("{\"carom\": 1, \"" + evil + "\": 1}");
            for (const char c : got.message) CHECK(static_cast<unsigned char>(c) >= 0x20);
            CHECK(got.message.find("\xc2\x9b") == std::string::npos);
        }
    }

    TEST_CASE("everything a file can say arrives in the scene") {
        const Scene scene = parse_scene(R"({"carom": 1, "name": "all", "gravity": [0, -4],
            "drag": {"linear": 1.5, "angular": 0.5},
            "walls": {"min": [-10, -10], "max": [10, 8], "sides": ["left", "bottom"], "material": "soft"},
            "materials": {"rubber": {"density": 3, "restitution": 0.8}, "soft": {"restitution": 0.1}},
            "default_material": "rubber",
            "bodies": [
                {"name": "ball", "shape": {"disc": {"radius": 0.4}}, "position": [2, 6.5], "angle": 0.25,
                 "velocity": [3.5, -0.5], "angular_velocity": 2, "mass": 2, "color": "#E74C3C"},
                {"type": "static", "shape": {"disc": {"radius": 1}}, "material": {"density": 7}},
                {"type": "kinematic", "shape": {"disc": {"radius": 1}}, "material": "soft", "fixed_rotation": true}],
            "generate": [{"stack": {"count": 2, "origin": [1, 1], "gap": 0.5, "shape": {"disc": {"radius": 0.5}},
                          "type": "static", "material": "soft", "fixed_rotation": true, "color": "#000000"}}],
            "joints": [],
            "step": {"dt": 0.016, "count": 500},
            "accuracy": {"solver": "soft", "substeps": 4, "iterations": 3, "precision": "double"},
            "effects": {"sleep": false, "continuous": true, "ledger": true, "gravity": true, "drag": true,
                        "rotation": true, "restitution": true},
            "record": {"every": 3, "trail": 80}})",
                                        "test.json");
        CHECK(scene.name == "all");
        CHECK(scene.gravity == Vec2{0, -4});
        CHECK(scene.drag.linear == 1.5);
        CHECK(scene.drag.angular == 0.5);
        REQUIRE(scene.walls.has_value());
        CHECK(scene.walls->min == Vec2{-10, -10});
        CHECK(scene.walls->max == Vec2{10, 8});
        CHECK((scene.walls->left && scene.walls->bottom && !scene.walls->right && !scene.walls->top));
        CHECK(scene.walls->material.restitution == 0.1);
        REQUIRE(scene.bodies.size() == 5);
        const Body& ball = scene.bodies[0];
        CHECK(ball.name == "ball");
        CHECK(ball.type == BodyType::dynamic_body);
        CHECK(std::get<Disc>(ball.shape).radius == 0.4);
        CHECK(ball.position == Vec2{2, 6.5});
        CHECK(ball.angle == 0.25);
        CHECK(ball.velocity == Vec2{3.5, -0.5});
        CHECK(ball.angular_velocity == 2);
        CHECK(ball.mass == 2);
        CHECK(ball.material == Material{.density = 3, .restitution = 0.8});
        CHECK(ball.color == "#E74C3C");
        CHECK(scene.bodies[1].type == BodyType::static_body);
        CHECK(scene.bodies[1].material == Material{.density = 7});
        CHECK(scene.bodies[2].type == BodyType::kinematic_body);
        CHECK(scene.bodies[2].fixed_rotation);
        CHECK(scene.bodies[2].material == Material{.restitution = 0.1});
        CHECK(scene.bodies[4].position == Vec2{1, 2.5});
        CHECK(scene.bodies[4].type == BodyType::static_body);
        CHECK(scene.bodies[4].fixed_rotation);
        CHECK(scene.bodies[4].color == "#000000");
        CHECK(scene.step.dt == 0.016);
        CHECK(scene.step.count == 500);
        CHECK(scene.accuracy.solver == Solver::soft);
        CHECK(scene.accuracy.substeps == 4);
        CHECK(scene.accuracy.iterations == 3);
        CHECK(scene.accuracy.precision == Precision::double_);
        CHECK(scene.effects.sleep == false);
        CHECK(scene.effects.ledger == true);
        CHECK(scene.effects.restitution == true);
        CHECK(scene.record.every == 3);
        CHECK(scene.record.trail == 80);
    }

    TEST_CASE("what a file leaves out has the defaults of the API") {
        const Scene scene = parse_scene(R"({"carom": 1})", "test.json"), fresh;
        CHECK(scene.step.dt == fresh.step.dt);
        CHECK(scene.step.count == fresh.step.count);
        CHECK(scene.accuracy.solver == Solver::automatic);
        CHECK_FALSE(scene.walls.has_value());
        CHECK_FALSE(scene.effects.ledger.has_value());
    }

    TEST_CASE("the seed scene reads as what its issue says") {
        const Scene scene = read_scene(CAROM_SOURCE_DIR "/docs/scenes/seed.json");
        REQUIRE(scene.bodies.size() == 5);
        CHECK(scene.gravity == Vec2{0, -4});
        CHECK(scene.step.dt == 0.016);
        CHECK(scene.step.count == 500);
        CHECK(scene.bodies[4].mass == 0.8);
        CHECK(scene.bodies[4].position == Vec2{8, 3});
        CHECK(scene.bodies[0].material.restitution == 0.8);
    }

    TEST_CASE("files that cannot be read are refused by name") {
        const auto code = [](const std::string& path) {
            try {
                read_scene(path);
            } catch (const SceneFileError& error) {
                CHECK(std::string(error.what()).starts_with(path));
                return error.code();
            }
            return ErrorCode::stale_handle;
        };
        CHECK(code("no/such/file.json") == ErrorCode::unreadable);
        CHECK(code(std::filesystem::temp_directory_path().string()) == ErrorCode::unreadable);
    }
}

}  // namespace test_scene_reader
