#pragma once

#include <carom/scene.hpp>

#include <vector>

namespace carom::torture {

enum class Fence { walls, segments, chain };

/// A convex polygon that bodies do not leave, and what it is built of.
class Enclosure {
  public:
    /// @param corners  m, counter-clockwise; of `Fence::walls` those of a box along the axes
    Enclosure(Fence fence, std::vector<Vec2> corners) : fence_(fence), corners_(std::move(corners)) {}

    /// From a point to the nearest edge's line [m]; negative outside.
    double clearance(Vec2 point) const;
    /// Height of the lowest centre a disc of that radius could have [m].
    double lowest_centre(double radius) const;
    double area() const;  ///< m²
    Vec2 low() const;     ///< m, lower left corner of the box around it
    Vec2 high() const;
    /// Appends what it is built of, after the bodies.
    void add_to(Scene& scene, const Material& material) const;

  private:
    Fence fence_;
    std::vector<Vec2> corners_;
};

/// A box from (0, 0).
Enclosure box_of(Fence fence, double width, double height);
/// A regular polygon around (0, 0), turned by `angle`.
Enclosure polygon_of(Fence fence, int sides, double area, double angle);

}  // namespace carom::torture
