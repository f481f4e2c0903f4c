#pragma once

#include "scene_file/node.hpp"

#include <map>
#include <string>
#include <string_view>

namespace carom::tool {

/// The materials of a file: those with names, and the one for whom names none.
struct Materials {
    std::map<std::string, Material, std::less<>> named;
    Material standard;
};

// Each reads one part of the document (interfaces: docs/scene-format.md). They check types, keys and names;
// values are checked by Scene::find_problem. All throw SceneFileError.

Materials read_materials(const Node& root);
/// A name, or an object in its place.
Material read_material(const Node& node, const Materials& materials);

/// Everything but bodies, generators and joints.
Materials read_settings(const Node& root, Scene& scene);
Shape read_shape(const Node& node);
BodyType read_body_type(const Node& node);
void read_bodies(const Node& root, const Materials& materials, Scene& scene);
/// Makes the bodies of one generator.
void read_generator(const Node& node, const Materials& materials, const SceneFileLimits& limits,
                    Scene& scene);
/// No kind of joint is built yet: says so if there is one.
void refuse_joints(const Node& root);

}  // namespace carom::tool
