#pragma once

#include <carom/accuracy.hpp>
#include <carom/effects.hpp>
#include <carom/errors.hpp>
#include <carom/ids.hpp>
#include <carom/joints.hpp>
#include <carom/materials.hpp>
#include <carom/shapes.hpp>
#include <carom/vec2.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carom {

enum class BodyType : std::uint8_t {
    dynamic_body,    ///< moved by gravity, drag and impulses
    static_body,     ///< never moves
    kinematic_body,  ///< moves at its set velocity, whatever it meets
};

/// What a body is, as bits, and what it touches, unless it says otherwise.
inline constexpr std::uint16_t kDefaultCategory = 1;
inline constexpr std::uint16_t kDefaultMask = 0xFFFF;

/// What a body touches, in a world that runs: `Body::group`, `category` and `mask`.
struct Filter {
    std::int32_t group = 0;
    std::uint16_t category = kDefaultCategory;
    std::uint16_t mask = kDefaultMask;

    friend bool operator==(const Filter&, const Filter&) = default;
};

/// One body as a person describes it. Everything has a default; SI units.
struct Body {
    std::string name{};  ///< empty, or unique in the scene
    BodyType type = BodyType::dynamic_body;
    Shape shape = Disc{};
    Vec2 position{};               ///< m, the centre of mass; each component within ±kLargestPosition
    double angle = 0;              ///< rad, counter-clockwise; within ±kLargestAngle
    Vec2 velocity{};               ///< m/s, speed at most kLargestSpeed; zero for static bodies
    double angular_velocity = 0;   ///< rad/s, within ±kLargestAngularVelocity; zero for static bodies
    std::optional<double> mass{};  ///< kg, > 0; else density times area. Without meaning unless dynamic
    Material material{};
    bool fixed_rotation = false;
    std::string color{};  ///< empty, or "#rrggbb"; for pictures only
    /// Bodies of the same group touch each other never if it is below zero, always if it is above zero,
    /// whatever category and mask say; 0: none.
    std::int32_t group = 0;
    /// Two bodies touch if each has a category, a bit, that is in the other's mask.
    std::uint16_t category = kDefaultCategory;
    std::uint16_t mask = kDefaultMask;
    /// Tells what overlaps it (`World::events`, `World::sensed`), and touches nothing. Needs the solver
    /// `soft`, and a shape with an area.
    bool sensor = false;
};

/// How a body resists being moved and turned; all zero for segments and chains. `mass` and inertia are those
/// that a dynamic body has.
struct BodyMass {
    double mass = 0;     ///< kg
    Vec2 centre{};       ///< m, centre of mass in the frame in which the shape is given
    double inertia = 0;  ///< kg m², about the centre of mass
};
/// Exact. @param body  within its limits (`Scene::validate`)
BodyMass body_mass_of(const Body& body);

/// A closed axis-aligned box around the bodies; each side can be left open.
struct Walls {
    Vec2 min{};  ///< m, lower left corner
    Vec2 max{};  ///< m, upper right corner; > min
    bool left = true;
    bool right = true;
    bool bottom = true;
    bool top = true;
    Material material{};
};

/// velocity ← velocity · exp(-linear · dt), angular velocity likewise.
struct Drag {
    double linear = 0;   ///< 1/s, 0 ... kLargestDrag
    double angular = 0;  ///< 1/s, 0 ... kLargestDrag
};

struct StepSettings {
    double dt = 1.0 / 60;     ///< s, kSmallestStep ... kLargestStep
    std::int64_t count = 60;  ///< steps a run takes, >= 0
};

/// Events a scene asks for, or says that it does not want; what is left out comes where there is something
/// to tell.
struct EventChoices {
    std::optional<bool> sensor{};  ///< left out: told if there are sensors
};

struct Record {
    std::int64_t every = 1;  ///< steps a frame of the trajectory, >= 1
    std::int64_t trail = 0;  ///< frames a body's trail shows in the report, >= 0
};

/// Limits of what a scene may hold; beyond them single precision itself fails.
inline constexpr double kLargestPosition = 1e8;         // m
inline constexpr double kLargestSpeed = 1e7;            // m/s; its fourth power must stay finite in float
inline constexpr double kSmallestRadius = 1e-9;         // m
inline constexpr double kLargestRadius = 1e7;           // m
inline constexpr double kSmallestEdge = 1e-9;           // m, of a segment and of each edge of a chain
inline constexpr double kLargestRadiusRatio = 1e7;      // largest / smallest in one scene
inline constexpr double kSmallestMass = 1e-30;          // kg, and kg/m² for densities
inline constexpr double kLargestMass = 1e30;            // kg, and kg/m² for densities
inline constexpr double kLargestAngle = 1e8;            // rad
inline constexpr double kLargestAngularVelocity = 1e7;  // rad/s
inline constexpr double kLargestDrag = 1e9;             // 1/s
inline constexpr double kSmallestStep = 1e-12;          // s; 1/dt must stay finite in float
inline constexpr double kLargestStep = 10;              // s
inline constexpr double kLargestAcceleration = 1e7;     // m/s²
inline constexpr std::size_t kLargestJointCount = 1u << 26;
inline constexpr std::size_t kLargestBodyCount = 1u << 26;  // rows are 32-bit; 64 Mi bodies need about 12 GiB

/// What is wrong with a material, with pointers as in the scene file ("/restitution"); nothing if all is
/// well.
std::optional<Problem> find_problem(const Material& material);

/// What a person describes: bodies, walls, laws, accuracy. Plain data; `World` makes columns of it.
struct Scene {
    std::string name{};
    Vec2 gravity{};  ///< m/s², each component within ±kLargestAcceleration
    Drag drag{};
    std::optional<Walls> walls{};
    std::vector<Body> bodies{};
    std::vector<Joint> joints{};
    StepSettings step{};
    Accuracy accuracy{};
    EffectOverrides effects{};
    Record record{};
    EventChoices events{};

    /// Appends a body; it is checked when a `World` is made of the scene, or by `validate`.
    /// @return the handle that body has in every world made of this scene.
    /// @throws Error (too_large) if the scene already holds kLargestBodyCount bodies.
    BodyId add(Body body);
    /// Appends a joint of bodies of this scene; it is checked likewise.
    /// @return the handle that joint has in every world made of this scene.
    /// @throws Error (too_large) if the scene already holds kLargestJointCount joints.
    JointId add(Joint joint);

    /// Checks every value: finite, within its limits, consistent, built in this version.
    /// Cost: O(bodies + joints).
    /// @throws Error naming the first item that is wrong, its value, the limit and the remedy.
    void validate() const;

    /// The first thing that is wrong, as `validate` would report it; nothing if all is well.
    std::optional<Problem> find_problem() const;
};

}  // namespace carom
