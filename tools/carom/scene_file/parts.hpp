#pragma once

#include "scene_file/node.hpp"

#include <map>
#include <string>
#include <string_view>

namespace carom::tool {

/// The materials of a file: those with names, and the one of what names none.
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
Shape read_shape(const Node& node, const Materials& materials);
BodyType read_body_type(const Node& node);
void read_bodies(const Node& root, const Materials& materials, Scene& scene);
/// Makes the bodies and the joints of one generator.
void read_generator(const Node& node, const Materials& materials, const SceneFileLimits& limits,
                    Scene& scene);
/// The kind of the joints of a generator: its name, or an object as in "joints", without bodies.
JointKind read_link(const Node& node);
/// Puts the listed joints before those that generators made. To be called when all bodies are there.
void read_joints(const Node& root, Scene& scene);

}  // namespace carom::tool
