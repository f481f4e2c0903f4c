#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "state/shapes.hpp"

namespace carom {

/// The rectangle around a shape, in the frame of its body [m].
template <class Real>
struct ShapeFrame {
    Real x, y, half_x, half_y;
};

/// The rectangles around all shapes of a world, by their number.
template <class Real>
class ShapeFrames {
  public:
    /// To be called before frames are asked for. Cost: O(shapes) where they have changed since.
    void follow(const ShapeStore<Real>& shapes) {
        if (revision_ == shapes.revision()) return;
        revision_ = shapes.revision();
        frames_.resize(shapes.size());
        for (std::size_t shape = 0; shape < shapes.size(); ++shape)
            frames_[shape] = frame_of(shapes, static_cast<std::int32_t>(shape));
    }
    void forget() { revision_ = 0; }
    const ShapeFrame<Real>& operator[](std::int32_t shape) const {
        return frames_[static_cast<std::size_t>(shape)];
    }
    std::size_t bytes() const { return frames_.capacity() * sizeof(ShapeFrame<Real>); }

  private:
    /// Pieces of a compound may be thicker than the compound and are anywhere within its circle.
    static ShapeFrame<Real> frame_of(const ShapeStore<Real>& shapes, std::int32_t number) {
        const ConvexShape<Real>& shape = shapes[number];
        if (!shapes.pieces(number).empty()) {
            constexpr Real all = static_cast<Real>(1e15);  // m, more than any gap
            return {0, 0, all, all};
        }
        const auto [left, right] = std::minmax_element(shape.x, shape.x + shape.count);
        const auto [low, high] = std::minmax_element(shape.y, shape.y + shape.count);
        return {(*left + *right) / 2, (*low + *high) / 2, (*right - *left) / 2 + shape.radius,
                (*high - *low) / 2 + shape.radius};
    }

    std::vector<ShapeFrame<Real>> frames_;
    std::uint64_t revision_ = 0;  // of the shapes they are of
};

}  // namespace carom
