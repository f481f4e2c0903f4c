#pragma once

#include <carom/scene.hpp>

#include "scene/validation/wording.hpp"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace carom {

// Checks of single values, for calls that take them one by one. `where` opens the message: "World::add".

/// Checks everything of a body but the name's uniqueness and the walls. @throws Error
void validate_body(const Body& body, std::string_view where);
/// Checks that a dynamic body starts between the closed walls, and fits there. @throws Error
void validate_inside(const Body& body, const Walls& walls, std::string_view where);
void validate_position(Vec2 position, std::string_view where);
void validate_velocity(Vec2 velocity, std::string_view where);
void validate_angular_velocity(double angular_velocity, std::string_view where);
/// Checks a step's length [s]: 0, or kSmallestStep ... kLargestStep. @throws Error
void validate_dt(double dt, std::string_view where);
/// Checks solver (`pairwise` passes), substeps, iterations. @throws Error
void validate_accuracy(const Accuracy& accuracy, std::string_view where);
/// Checks that no effect is forced off which the scene needs, and none on which is not built. `effects`:
/// those in force, in place of the scene's own. Cost: O(bodies) if rotation or restitution is forced off.
/// @throws Error
void validate_effects(const Scene& scene, const EffectOverrides& effects, std::string_view where);

// These find the same faults without throwing, for Scene::find_problem and the generators.

std::optional<Problem> find_body_problem(const Item& item, const Body& body);
/// Looks at the body's shape alone, and at its type where the shape asks for one.
std::optional<Problem> find_shape_problem(const Item& item, const Body& body);
/// The shape's name in scene files: "disc".
std::string_view name_of(const Shape& shape);
/// What a body may do: a static or quarantined one stands still, one of fixed rotation does not turn.
enum class Mobility : std::uint8_t { all, no_rotation, none, quarantined };
/// Checks that the velocity is zero where nothing moves the body. Kinematic bodies move as they are told.
std::optional<Problem> find_velocity_problem(const Item& item, Mobility mobility, Vec2 velocity);
std::optional<Problem> find_angular_velocity_problem(const Item& item, Mobility mobility, double spin);
std::optional<Problem> find_inside_problem(const Item& item, const Body& body, const Walls& walls);
/// Everything of a joint but which bodies there are.
std::optional<Problem> find_joint_problem(const Item& item, const Joint& joint);
/// Whether a joint can turn its bodies: all but those at centres.
bool turns_bodies(const Joint& joint);
/// The bodies of a scene's joint, and where they stand.
std::optional<Problem> find_joint_bodies_problem(const Item& item, const Joint& joint, const Scene& scene);
/// The same of two bodies in numbers. @param moves_a, moves_b  whether they are bodies that move freely
/// @param a, b  place of the joint's anchor on each [m], where that is fixed by the joint
std::optional<Problem> find_joint_mobility_problem(const Item& item, bool moves_a, bool moves_b);
std::optional<Problem> find_material_problem(const Item& item, std::string_view tail,
                                             const Material& material);
/// Looks at gravity, drag, walls, step, record and accuracy.
std::optional<Problem> find_settings_problem(const Scene& scene);
std::optional<Problem> find_accuracy_problem(const Accuracy& accuracy);
std::optional<Problem> find_effects_problem(const Scene& scene, const EffectOverrides& effects);
/// The first body whose name an earlier one has. Cost: O(bodies), nothing if none has a name.
std::optional<Problem> find_duplicate_name(const std::vector<Body>& bodies);

}  // namespace carom
