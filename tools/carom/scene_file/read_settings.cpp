#include "scene_file/parts.hpp"

#include <array>
#include <limits>

namespace carom::tool {
namespace {

void read_drag(const Node& node, Drag& drag) {
    static constexpr std::array<std::string_view, 2> kKeys{"linear", "angular"};
    node.expect_keys(kKeys);
    node.read("linear", drag.linear);
    node.read("angular", drag.angular);
}

void read_sides(const Node& node, Walls& walls) {
    static constexpr std::array<std::string_view, 4> kSides{"left", "right", "bottom", "top"};
    bool* const closed[] = {&walls.left, &walls.right, &walls.bottom, &walls.top};
    node.expect_array("sides, e.g. [\"left\", \"bottom\"]");
    for (bool* side : closed) *side = false;
    for (std::size_t i = 0; i < node.size(); ++i) {
        const Node name = node[i];
        bool& side = *closed[name.one_of(kSides, "side")];
        if (side) name.fail(ErrorCode::duplicate_name, "the side is there twice; expected each side once.");
        side = true;
    }
}

Walls read_walls(const Node& node, const Materials& materials) {
    static constexpr std::array<std::string_view, 4> kKeys{"min", "max", "sides", "material"};
    node.expect_keys(kKeys);
    Walls walls;
    walls.min = node.at("min").vec2();
    walls.max = node.at("max").vec2();
    if (const auto sides = node.find("sides")) read_sides(*sides, walls);
    const auto material = node.find("material");
    walls.material = material ? read_material(*material, materials) : materials.standard;
    return walls;
}

void read_step(const Node& node, StepSettings& step) {
    static constexpr std::array<std::string_view, 2> kKeys{"dt", "count"};
    node.expect_keys(kKeys);
    node.read("dt", step.dt);
    node.read("count", step.count);
}

/// Limits are checked with the scene; here only that the number can be held.
void read_count(const Node& node, std::string_view key, std::optional<int>& into) {
    const auto member = node.find(key);
    if (!member) return;
    const std::int64_t count = member->integer();
    if (count < std::numeric_limits<int>::min() || count > std::numeric_limits<int>::max())
        member->fail(ErrorCode::out_of_range, short_text(member->json()) +
                                                  "; expected 1 <= " + std::string(key) +
                                                  " <= 1024. Leave it out for the solver's own default.");
    into = static_cast<int>(count);
}

void read_accuracy(const Node& node, Accuracy& accuracy) {
    static constexpr std::array<std::string_view, 4> kKeys{"solver", "substeps", "iterations", "precision"};
    static constexpr std::array<std::string_view, 7> kSolvers{"auto",  "pairwise", "impulse", "soft",
                                                              "rigid", "event",    "rattle"};
    static constexpr std::array<std::string_view, 2> kPrecisions{"float", "double"};
    node.expect_keys(kKeys);
    if (const auto solver = node.find("solver"))
        accuracy.solver = *solver_named(kSolvers[solver->one_of(kSolvers, "solver")]);
    read_count(node, "substeps", accuracy.substeps);
    read_count(node, "iterations", accuracy.iterations);
    if (const auto precision = node.find("precision"))
        accuracy.precision =
            precision->one_of(kPrecisions, "precision") == 0 ? Precision::single_ : Precision::double_;
}

void read_effects(const Node& node, EffectOverrides& effects) {
    static constexpr std::array<std::string_view, 9> kKeys{"sleep",       "continuous", "ledger",
                                                           "gravity",     "drag",       "rotation",
                                                           "restitution", "friction",   "rolling_resistance"};
    node.expect_keys(kKeys);
    node.read("sleep", effects.sleep);
    node.read("continuous", effects.continuous);
    node.read("ledger", effects.ledger);
    node.read("gravity", effects.gravity);
    node.read("drag", effects.drag);
    node.read("rotation", effects.rotation);
    node.read("restitution", effects.restitution);
    node.read("friction", effects.friction);
    node.read("rolling_resistance", effects.rolling_resistance);
}

void read_record(const Node& node, Record& record) {
    static constexpr std::array<std::string_view, 2> kKeys{"every", "trail"};
    node.expect_keys(kKeys);
    node.read("every", record.every);
    node.read("trail", record.trail);
}

/// The kinds of events that are wanted; those left out are not told.
void read_events(const Node& node, EventChoices& events) {
    static constexpr std::array<std::string_view, 6> kEventKinds{"sensor", "begin", "end",
                                                                 "hit",    "break", "sleep"};
    node.expect_array("kinds of events, e.g. [\"sensor\"]");
    events.sensor = false;
    for (std::size_t i = 0; i < node.size(); ++i) {
        const Node kind = node[i];
        const std::size_t which = kind.one_of(kEventKinds, "kind of event");
        if (which > 0)
            kind.fail(ErrorCode::not_built_yet, "events \"" + std::string(kEventKinds[which]) +
                                                    "\" are not built in this version; expected \"sensor\".");
        events.sensor = true;
    }
}

void read_version(const Node& root) {
    const Node version = root.at("carom");
    if (version.integer() != 1)
        version.fail(ErrorCode::out_of_range, "the format's version is " + short_text(version.json()) +
                                                  "; expected 1, the version this program reads.");
}

}  // namespace

Materials read_settings(const Node& root, Scene& scene) {
    static constexpr std::array<std::string_view, 16> kKeys{
        "carom",    "name",   "gravity", "drag",     "walls",   "materials", "default_material", "bodies",
        "generate", "joints", "step",    "accuracy", "effects", "record",    "events",           "$schema"};
    read_version(root);  // first: another version may have other keys
    root.expect_keys(kKeys);
    Materials materials = read_materials(root);
    std::string schema;  // for editors; any text will do
    root.read("$schema", schema);
    root.read("name", scene.name);
    root.read("gravity", scene.gravity);
    if (const auto drag = root.find("drag")) read_drag(*drag, scene.drag);
    if (const auto walls = root.find("walls")) scene.walls = read_walls(*walls, materials);
    if (const auto step = root.find("step")) read_step(*step, scene.step);
    if (const auto accuracy = root.find("accuracy")) read_accuracy(*accuracy, scene.accuracy);
    if (const auto effects = root.find("effects")) read_effects(*effects, scene.effects);
    if (const auto events = root.find("events")) read_events(*events, scene.events);
    if (const auto record = root.find("record")) read_record(*record, scene.record);
    return materials;
}

}  // namespace carom::tool
