#pragma once

#include <carom/scene.hpp>

namespace carom {

inline constexpr double kPi = 3.14159265358979323846;

inline bool is_disc(const Shape& shape) {
    return std::holds_alternative<Disc>(shape);
}

/// Zero for what is no disc.
inline double radius_of(const Shape& shape) {
    const Disc* disc = std::get_if<Disc>(&shape);
    return disc ? disc->radius : 0;
}

inline double area_of(const Shape& shape) {  // m²
    const double radius = radius_of(shape);
    return kPi * (radius * radius);
}

inline double mass_of(const Body& body) {  // kg
    return body.mass ? *body.mass : body.material.density * area_of(body.shape);
}

}  // namespace carom
