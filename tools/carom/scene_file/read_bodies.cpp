#include "scene_file/parts.hpp"

#include <array>

namespace carom::tool {
namespace {

constexpr std::array<std::string_view, 13> kBodyKeys{
    "name", "type",     "shape",          "position", "angle",  "velocity", "angular_velocity",
    "mass", "material", "fixed_rotation", "color",    "filter", "sensor"};

/// Bits of a category or mask.
std::uint16_t read_bits(const Node& node, std::string_view what) {
    const std::int64_t value = node.integer();
    if (value < 0 || value > UINT16_MAX)
        node.fail(ErrorCode::out_of_range, std::string(what) + " " + std::to_string(value) +
                                               "; expected 0 to 65535: each of 16 bits is a category.");
    return static_cast<std::uint16_t>(value);
}

std::int32_t read_group(const Node& node) {
    const std::int64_t value = node.integer();
    if (value < INT32_MIN || value > INT32_MAX)
        node.fail(ErrorCode::out_of_range,
                  "group " + std::to_string(value) +
                      "; expected -2147483648 to 2147483647. Bodies of one group never touch each other if "
                      "it is below zero, always if it is above; 0 is none.");
    return static_cast<std::int32_t>(value);
}

void read_filter(const Node& filter, Body& body) {
    static constexpr std::array<std::string_view, 3> kKeys{"category", "mask", "group"};
    filter.expect_keys(kKeys);
    if (const auto category = filter.find("category")) body.category = read_bits(*category, "category");
    if (const auto mask = filter.find("mask")) body.mask = read_bits(*mask, "mask");
    if (const auto group = filter.find("group")) body.group = read_group(*group);
}

Body read_body(const Node& node, const Materials& materials) {
    node.expect_keys(kBodyKeys);
    Body body;
    node.read("name", body.name);
    if (const auto type = node.find("type")) body.type = read_body_type(*type);
    body.shape = read_shape(node.at("shape"), materials);
    node.read("position", body.position);
    node.read("angle", body.angle);
    node.read("velocity", body.velocity);
    node.read("angular_velocity", body.angular_velocity);
    if (const auto mass = node.find("mass")) body.mass = mass->number();
    const auto material = node.find("material");
    body.material = material ? read_material(*material, materials) : materials.standard;
    node.read("fixed_rotation", body.fixed_rotation);
    node.read("color", body.color);
    node.read("sensor", body.sensor);
    if (const auto filter = node.find("filter")) read_filter(*filter, body);
    return body;
}

Disc read_disc(const Node& shape) {
    static constexpr std::array<std::string_view, 1> kKeys{"radius"};
    shape.expect_keys(kKeys);
    return {shape.at("radius").number()};
}

Segment read_segment(const Node& shape) {
    static constexpr std::array<std::string_view, 2> kKeys{"a", "b"};
    shape.expect_keys(kKeys);
    return {shape.at("a").vec2(), shape.at("b").vec2()};
}

std::vector<Vec2> read_points(const Node& shape, std::string_view key) {
    const Node list = shape.at(key);
    list.expect_array(key);
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < list.size(); ++i) points.push_back(list[i].vec2());
    return points;
}

Chain read_chain(const Node& shape) {
    static constexpr std::array<std::string_view, 2> kKeys{"points", "loop"};
    shape.expect_keys(kKeys);
    Chain chain;
    chain.points = read_points(shape, "points");
    shape.read("loop", chain.loop);
    return chain;
}

Box read_box(const Node& shape) {
    static constexpr std::array<std::string_view, 2> kKeys{"width", "height"};
    shape.expect_keys(kKeys);
    return {shape.at("width").number(), shape.at("height").number()};
}

Capsule read_capsule(const Node& shape) {
    static constexpr std::array<std::string_view, 2> kKeys{"length", "radius"};
    shape.expect_keys(kKeys);
    return {shape.at("length").number(), shape.at("radius").number()};
}

Polygon read_polygon(const Node& shape) {
    static constexpr std::array<std::string_view, 2> kKeys{"vertices", "radius"};
    shape.expect_keys(kKeys);
    Polygon polygon;
    polygon.vertices = read_points(shape, "vertices");
    shape.read("radius", polygon.radius);
    return polygon;
}

Piece read_piece(const Node& node, const Materials& materials) {
    static constexpr std::array<std::string_view, 4> kKeys{"shape", "position", "angle", "material"};
    static constexpr std::array<std::string_view, 4> kShapes{"disc", "box", "capsule", "polygon"};
    node.expect_keys(kKeys);
    Piece piece;
    const Node shape = node.at("shape").only_member(kShapes, "shape in a compound");
    if (shape.key() == "disc") piece.shape = read_disc(shape);
    if (shape.key() == "box") piece.shape = read_box(shape);
    if (shape.key() == "capsule") piece.shape = read_capsule(shape);
    if (shape.key() == "polygon") piece.shape = read_polygon(shape);
    node.read("position", piece.position);
    node.read("angle", piece.angle);
    if (const auto material = node.find("material")) piece.material = read_material(*material, materials);
    return piece;
}

Compound read_compound(const Node& shape, const Materials& materials) {
    static constexpr std::array<std::string_view, 1> kKeys{"shapes"};
    shape.expect_keys(kKeys);
    Compound compound;
    const Node pieces = shape.at("shapes");
    pieces.expect_array("shapes, each with a place");
    for (std::size_t i = 0; i < pieces.size(); ++i)
        compound.pieces.push_back(read_piece(pieces[i], materials));
    return compound;
}

}  // namespace

BodyType read_body_type(const Node& node) {
    static constexpr std::array<std::string_view, 3> kTypes{"dynamic", "static", "kinematic"};
    static constexpr std::array kValues{BodyType::dynamic_body, BodyType::static_body,
                                        BodyType::kinematic_body};
    return kValues[node.one_of(kTypes, "type of body")];
}

Shape read_shape(const Node& node, const Materials& materials) {
    static constexpr std::array<std::string_view, 7> kShapes{"disc",    "box",   "capsule", "polygon",
                                                             "segment", "chain", "compound"};
    const Node shape = node.only_member(kShapes, "shape");
    if (shape.key() == "compound") return read_compound(shape, materials);
    if (shape.key() == "box") return read_box(shape);
    if (shape.key() == "capsule") return read_capsule(shape);
    if (shape.key() == "polygon") return read_polygon(shape);
    if (shape.key() == "segment") return read_segment(shape);
    if (shape.key() == "chain") return read_chain(shape);
    return read_disc(shape);
}

void read_bodies(const Node& root, const Materials& materials, Scene& scene) {
    const auto bodies = root.find("bodies");
    if (!bodies) return;
    bodies->expect_array("bodies");
    scene.bodies.reserve(bodies->size());
    for (std::size_t i = 0; i < bodies->size(); ++i) scene.add(read_body((*bodies)[i], materials));
}

}  // namespace carom::tool
