#pragma once

#include <carom/scene.hpp>

#include "scene/validation/wording.hpp"

namespace carom {

// Every quantity a scene holds, with its limits (scene.hpp) and what to do about a value outside them.
inline constexpr std::string_view kUseMetres = "Give lengths in metres, or scale the scene.";
inline constexpr Quantity kRadius{"radius", "m", kSmallestRadius, kLargestRadius, kUseMetres};
inline constexpr Quantity kWidth{"width", "m", kSmallestRadius, kLargestRadius, kUseMetres};
inline constexpr Quantity kHeight{"height", "m", kSmallestRadius, kLargestRadius, kUseMetres};
inline constexpr Quantity kCapsuleLength{
    "length", "m", kSmallestRadius, kLargestRadius,
    "It goes from centre to centre; a capsule without length is a disc. Give lengths in metres."};
inline constexpr Quantity kCornerRadius{"radius", "m", 0, kLargestRadius,
                                        "Give the radius of the corners, 0 for sharp ones."};
inline constexpr Quantity kPositionX{"position x", "m", -kLargestPosition, kLargestPosition, kUseMetres};
inline constexpr Quantity kPositionY{"position y", "m", -kLargestPosition, kLargestPosition, kUseMetres};
inline constexpr Quantity kAngle{"angle", "rad", -kLargestAngle, kLargestAngle, "Give angles in radians."};
inline constexpr Quantity kVelocityX{"velocity x", "m/s", -kLargestSpeed, kLargestSpeed,
                                     "Give velocities in metres a second."};
inline constexpr Quantity kVelocityY{"velocity y", "m/s", -kLargestSpeed, kLargestSpeed,
                                     "Give velocities in metres a second."};
inline constexpr Quantity kSpeed{"speed", "m/s", 0, kLargestSpeed, "Give velocities in metres a second."};
inline constexpr Quantity kAngularVelocity{"angular velocity", "rad/s", -kLargestAngularVelocity,
                                           kLargestAngularVelocity, "Give it in radians a second."};
inline constexpr Quantity kMass{
    "mass", "kg", kSmallestMass, kLargestMass,
    "Make what must not move static instead of giving it a mass of 0 or infinity."};
inline constexpr Quantity kMassOfDensity{"mass (density times area)", "kg", kSmallestMass, kLargestMass,
                                         "Change the density, or give a mass."};

inline constexpr Quantity kDensity{"density", "kg/m²", kSmallestMass, kLargestMass,
                                   "Make what must not move static instead of giving it a density of 0."};
inline constexpr Quantity kFriction{"friction", "", 0, 1e9, "Give a Coulomb coefficient, 0 for none."};
inline constexpr Quantity kRestitution{"restitution", "", 0, 1,
                                       "It is the normal speed after an impact over the one before."};
inline constexpr Quantity kRollingResistance{"rolling resistance", "", 0, 1e9,
                                             "Give the lever arm as a share of the radius, 0 for none."};

inline constexpr Quantity kGravityX{"gravity x", "m/s²", -kLargestAcceleration, kLargestAcceleration,
                                    "Give accelerations in metres a second squared."};
inline constexpr Quantity kGravityY{"gravity y", "m/s²", -kLargestAcceleration, kLargestAcceleration,
                                    "Give accelerations in metres a second squared."};
inline constexpr Quantity kLinearDrag{"linear drag", "1/s", 0, kLargestDrag,
                                      "Velocity decays as exp(-drag t); give 0 for none."};
inline constexpr Quantity kAngularDrag{"angular drag", "1/s", 0, kLargestDrag,
                                       "Angular velocity decays as exp(-drag t); give 0 for none."};
inline constexpr Quantity kStep{"dt", "s", kSmallestStep, kLargestStep,
                                "Give the length of a step in seconds, e.g. 0.0166667."};
inline constexpr Quantity kStepOrZero{"dt", "s", 0, kLargestStep,
                                      "Give the length of a step in seconds, e.g. 0.0166667."};
inline constexpr double kLargestCount = 9223372036854775807.0;  // of a 64-bit integer
inline constexpr Quantity kStepCount{"count", "", 0, kLargestCount, "Give the number of steps to take."};
inline constexpr Quantity kRecordEvery{"every", "", 1, kLargestCount, "Give the steps from frame to frame."};
inline constexpr Quantity kRecordTrail{"trail", "", 0, kLargestCount, "Give the frames a trail shows."};
inline constexpr Quantity kSubsteps{"substeps", "", 1, 1024, "Leave it out for the solver's own default."};
inline constexpr Quantity kIterations{"iterations", "", 1, 1024,
                                      "Leave it out for the solver's own default."};

}  // namespace carom
