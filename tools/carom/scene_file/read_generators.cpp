#include "scene_file/parts.hpp"

#include <array>
#include <utility>

namespace carom::tool {
namespace {

constexpr std::array<std::string_view, 6> kKinds{"lattice", "gas", "stack", "pyramid", "chain", "net"};

/// One generator of the file: {"lattice": {...}}, or {"kind": "lattice", ...}.
struct Request {
    const Node& node;  // where its keys are
    bool has_kind;     // one of which is "kind"
    const Materials& materials;
    const SceneFileLimits& limits;
};

/// @param known  the last of them is "kind"
void expect_keys(const Request& request, Node::Names known) {
    request.node.expect_keys(request.has_kind ? known : known.first(known.size() - 1));
}

/// The keys every generator takes, and what they say about the bodies.
struct Pattern {
    Body body;
    bool has_shape = false;
};

Pattern read_pattern(const Node& node, const Materials& materials) {
    Pattern pattern;
    if (const auto shape = node.find("shape")) {
        pattern.body.shape = read_shape(*shape, materials);
        pattern.has_shape = true;
    }
    if (const auto type = node.find("type")) pattern.body.type = read_body_type(*type);
    const auto material = node.find("material");
    pattern.body.material = material ? read_material(*material, materials) : materials.standard;
    node.read("fixed_rotation", pattern.body.fixed_rotation);
    node.read("color", pattern.body.color);
    return pattern;
}

std::optional<RadiusRange> read_range(const Node& node) {
    const auto range = node.find("radius_range");
    if (!range) return std::nullopt;
    const Vec2 ends = range->vec2();
    return RadiusRange{ends.x, ends.y};
}

void read_seed(const Node& node, std::uint64_t& into) {
    if (const auto seed = node.find("seed")) into = seed->seed();
}

/// @param key  whose value says how many bodies there are
/// @throws SceneFileError if the bodies would take more memory than the limit.
void check_memory(const Request& request, double count, const Scene& scene, const char* key = "count") {
    const SceneFileLimits& limits = request.limits;
    const double bytes = (static_cast<double>(scene.bodies.size()) + count) * sizeof(Body);
    if (bytes <= static_cast<double>(limits.body_bytes)) return;
    const Node asked = request.node.at(key);
    asked.fail(ErrorCode::too_large, key + (" " + short_text(asked.json())) +
                                         " asks for more memory than the limit of " +
                                         std::to_string(limits.body_bytes >> 20) + " MiB; expected at most " +
                                         std::to_string(limits.body_bytes / sizeof(Body)) +
                                         " bodies in a scene file. Make fewer of them.");
}

/// Says at which key of the generator a problem is. `renamed`: a pointer that the file spells otherwise.
void fail_if(const Node& node, const std::optional<Problem>& found,
             std::pair<std::string_view, std::string_view> renamed = {}) {
    if (!found) return;
    std::string pointer = found->pointer;
    if (!renamed.first.empty() && pointer.starts_with(renamed.first)) pointer = renamed.second;
    node.fail_at(pointer, found->code, found->statement);
}

void make_lattice(const Request& request, Scene& scene) {
    const Node& node = request.node;
    static constexpr std::array<std::string_view, 14> kKeys{
        "count", "origin", "spacing",  "jitter", "stagger",        "radius_range", "velocity_rms",
        "seed",  "shape",  "material", "type",   "fixed_rotation", "color",        "kind"};
    expect_keys(request, kKeys);
    Lattice lattice;
    const Node count = node.at("count");
    if (!count.json().is_array() || count.size() != 2) count.fail_type("two whole numbers, [nx, ny]");
    lattice.count_x = count[0].integer();
    lattice.count_y = count[1].integer();
    node.read("origin", lattice.origin);
    lattice.spacing = node.at("spacing").vec2();
    node.read("jitter", lattice.jitter);
    node.read("stagger", lattice.stagger);
    lattice.radius_range = read_range(node);
    node.read("velocity_rms", lattice.velocity_rms);
    read_seed(node, lattice.seed);
    Pattern pattern = read_pattern(node, request.materials);
    if (!pattern.has_shape && !lattice.radius_range) node.at("shape");
    lattice.body = std::move(pattern.body);
    fail_if(node, find_problem(lattice));
    check_memory(request, static_cast<double>(lattice.count_x) * static_cast<double>(lattice.count_y), scene);
    add_lattice(scene, lattice);
}

void make_stack(const Request& request, Scene& scene) {
    const Node& node = request.node;
    static constexpr std::array<std::string_view, 9> kKeys{
        "count", "origin", "gap", "shape", "material", "type", "fixed_rotation", "color", "kind"};
    expect_keys(request, kKeys);
    Stack stack;
    stack.count = node.at("count").integer();
    node.read("origin", stack.origin);
    node.read("gap", stack.gap);
    node.at("shape");
    stack.body = read_pattern(node, request.materials).body;
    fail_if(node, find_problem(stack));
    check_memory(request, static_cast<double>(stack.count), scene);
    add_stack(scene, stack);
}

void make_pyramid(const Request& request, Scene& scene) {
    const Node& node = request.node;
    static constexpr std::array<std::string_view, 9> kKeys{
        "base", "origin", "gap", "shape", "material", "type", "fixed_rotation", "color", "kind"};
    expect_keys(request, kKeys);
    Pyramid pyramid;
    pyramid.base = node.at("base").integer();
    node.read("origin", pyramid.origin);
    node.read("gap", pyramid.gap);
    node.at("shape");
    pyramid.body = read_pattern(node, request.materials).body;
    fail_if(node, find_problem(pyramid));
    const auto base = static_cast<double>(pyramid.base);
    check_memory(request, base * (base + 1) / 2, scene, "base");
    add_pyramid(scene, pyramid);
}

void make_gas(const Request& request, Scene& scene) {
    const Node& node = request.node;
    static constexpr std::array<std::string_view, 11> kKeys{
        "count",    "radius", "radius_range", "velocity_rms",   "seed", "shape",
        "material", "type",   "color",        "fixed_rotation", "kind"};
    expect_keys(request, kKeys);
    Gas gas;
    gas.count = node.at("count").integer();
    node.read("velocity_rms", gas.velocity_rms);
    read_seed(node, gas.seed);
    Pattern pattern = read_pattern(node, request.materials);
    const auto range = read_range(node);
    const auto radius = node.find("radius");
    if (radius && (range || pattern.has_shape))
        radius->fail(ErrorCode::inconsistent,
                     std::string("the radius is there twice; expected one of \"radius\", ") +
                         "\"radius_range\" and \"shape\". Take one away.");
    if (!radius && !range && !pattern.has_shape) node.at("radius");
    const Disc* disc = std::get_if<Disc>(&pattern.body.shape);
    if (!disc)
        node.at("shape").fail(ErrorCode::inconsistent,
                              "the shape is no disc; expected a disc, as a gas is of discs. Use a lattice.");
    const double one = radius ? radius->number() : disc->radius;
    gas.radius = range ? *range : RadiusRange{one, one};
    gas.body = std::move(pattern.body);
    check_memory(request, static_cast<double>(gas.count), scene);
    const std::string_view place = range ? "/radius_range" : radius ? "/radius" : "/shape/disc/radius";
    fail_if(node, find_problem(gas, scene), {"/radius_range", place});
    add_gas(scene, gas);
}

void make_chain(const Request& request, Scene& scene) {
    const Node& node = request.node;
    static constexpr std::array<std::string_view, 12> kKeys{
        "count", "origin",   "direction", "spacing",        "joint", "pinned",
        "shape", "material", "type",      "fixed_rotation", "color", "kind"};
    expect_keys(request, kKeys);
    BodyChain chain;
    chain.count = node.at("count").integer();
    node.read("origin", chain.origin);
    node.read("direction", chain.direction);
    chain.spacing = node.at("spacing").number();
    if (const auto joint = node.find("joint")) chain.link = read_link(*joint);
    node.read("pinned", chain.pinned);
    node.at("shape");
    chain.body = read_pattern(node, request.materials).body;
    fail_if(node, find_problem(chain));
    check_memory(request, static_cast<double>(chain.count), scene);
    add_chain(scene, chain);
}

void make_net(const Request& request, Scene& scene) {
    const Node& node = request.node;
    static constexpr std::array<std::string_view, 11> kKeys{"count",          "origin", "spacing",  "joint",
                                                            "pinned",         "shape",  "material", "type",
                                                            "fixed_rotation", "color",  "kind"};
    expect_keys(request, kKeys);
    Net net;
    const Node count = node.at("count");
    if (!count.json().is_array() || count.size() != 2) count.fail_type("two whole numbers, [nx, ny]");
    net.count_x = count[0].integer();
    net.count_y = count[1].integer();
    node.read("origin", net.origin);
    const Node spacing = node.at("spacing");
    const bool is_one = spacing.json().is_number();
    net.spacing = is_one ? Vec2{spacing.number(), spacing.number()} : spacing.vec2();
    if (const auto joint = node.find("joint")) net.link = read_link(*joint);
    if (const auto pinned = node.find("pinned")) {
        static constexpr std::array<std::string_view, 2> kPinned{"corners", "top"};
        net.pinned = pinned->one_of(kPinned, "way to pin") == 0 ? Net::Pinned::corners : Net::Pinned::top;
    }
    node.at("shape");
    net.body = read_pattern(node, request.materials).body;
    const auto found = find_problem(net);
    fail_if(node, found,
            is_one ? std::pair<std::string_view, std::string_view>{"/spacing", "/spacing"}
                   : std::pair<std::string_view, std::string_view>{});
    check_memory(request, static_cast<double>(net.count_x) * static_cast<double>(net.count_y), scene);
    add_net(scene, net);
}

}  // namespace

void read_generator(const Node& node, const Materials& materials, const SceneFileLimits& limits,
                    Scene& scene) {
    const auto kind = node.find("kind");
    const Node inner = kind ? node : node.only_member(kKinds, "generator");
    const std::string_view name = kind ? kKinds[kind->one_of(kKinds, "generator")] : inner.key();
    const Request request{inner, kind.has_value(), materials, limits};
    if (name == "lattice") return make_lattice(request, scene);
    if (name == "gas") return make_gas(request, scene);
    if (name == "stack") return make_stack(request, scene);
    if (name == "pyramid") return make_pyramid(request, scene);
    if (name == "chain") return make_chain(request, scene);
    make_net(request, scene);
}

}  // namespace carom::tool
