#include "scene_file/nearest_name.hpp"
#include "scene_file/parts.hpp"

#include <array>
#include <vector>

namespace carom::tool {
namespace {

constexpr std::array<std::string_view, 4> kMaterialKeys{"density", "friction", "restitution",
                                                        "rolling_resistance"};

/// Checked here and not with the scene, so that a fault of a named material is shown where the material is.
Material read_inline_material(const Node& node) {
    node.expect_keys(kMaterialKeys);
    Material material;
    node.read("density", material.density);
    node.read("friction", material.friction);
    node.read("restitution", material.restitution);
    node.read("rolling_resistance", material.rolling_resistance);
    if (const auto found = find_problem(material)) {
        const auto member = node.find(std::string_view(found->pointer).substr(1));
        (member ? *member : node).fail(found->code, found->statement);
    }
    return material;
}

[[noreturn]] void fail_unknown_material(const Node& node, const Materials& materials) {
    std::string words = "there is no material " + short_text(node.json());
    if (materials.named.empty())
        node.fail(ErrorCode::unknown_name,
                  words + "; the file has no \"materials\". Add them, or give an object.");
    std::vector<std::string_view> known;
    for (const auto& [name, material] : materials.named) known.push_back(name);
    node.fail(ErrorCode::unknown_name, words + "; " + known_names(node.text(), known) + ".");
}

}  // namespace

Material read_material(const Node& node, const Materials& materials) {
    if (node.json().is_object()) return read_inline_material(node);
    if (!node.json().is_string()) node.fail_type("the name of a material, or an object, {...}");
    const auto found = materials.named.find(node.text());
    if (found == materials.named.end()) fail_unknown_material(node, materials);
    return found->second;
}

Materials read_materials(const Node& root) {
    Materials materials;
    if (const auto named = root.find("materials")) {
        if (!named->json().is_object()) named->fail_type("an object of materials by name, {...}");
        for (const auto& [name, value] : named->json().get_ref<const Node::Json::object_t&>())
            materials.named.emplace(name, read_inline_material(named->at(name)));
    }
    if (const auto standard = root.find("default_material"))
        materials.standard = read_material(*standard, materials);
    return materials;
}

}  // namespace carom::tool
