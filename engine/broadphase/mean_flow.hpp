#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "math/vec2_math.hpp"

namespace carom {

/// How the bodies of a region move on the whole: a field of jumps and one of velocities, each the mean of
/// what was added to a square cell, bilinear between the centres of cells and constant beyond the outermost.
///
/// Bodies that move together do little relative to this field, however far they go. Two
/// points at a distance d that jump by the field and then follow it for a time t come nearer to each other by
/// no more than d (stretch + t rate), with the `stretch` and `rate` of either, if d is no more than a cell.
///
/// All of it is arithmetic in double, in the order of the bodies: the same for any number of threads and any
/// instruction set.
class MeanFlow {
  public:
    /// Lays cells over the middle of the bodies: two root mean squares to each side. A body outside follows
    /// the nearest cell.
    /// @param smallest_cell  m, > 0
    /// Cost: O(bodies), about 1 ns each.
    template <class Real>
    void lay_out(std::size_t count, const Real* x, const Real* y, double smallest_cell);

    /// Starts new fields over the same cells.
    void begin();
    void add(Vec2 place, Vec2 jump, Vec2 velocity) {
        Cell& cell = cells_[cell_of(place)];
        ++cell.count, cell.jump += jump, cell.velocity += velocity;
    }
    /// To be called after the last `add`. Cells without a body get what their neighbours have.
    void finish();

    struct At {
        Vec2 jump, velocity;   // m, m/s
        double stretch, rate;  // no unit, 1/s
    };
    At at(Vec2 place) const {
        const double u = std::clamp((place.x - low_.x) * per_metre_, 0.0, last_u_),
                     v = std::clamp((place.y - low_.y) * per_metre_, 0.0, last_v_);
        const std::size_t i = std::min(static_cast<std::size_t>(u), width_ - 2),
                          j = std::min(static_cast<std::size_t>(v), height_ - 2);
        const double f = u - static_cast<double>(i), g = v - static_cast<double>(j);
        const Cell* low = &cells_[j * width_ + i];
        const Cell* high = low + width_;
        const double a = (1 - f) * (1 - g), b = f * (1 - g), c = (1 - f) * g, d = f * g;
        return {a * low[0].jump + b * low[1].jump + c * high[0].jump + d * high[1].jump,
                a * low[0].velocity + b * low[1].velocity + c * high[0].velocity + d * high[1].velocity,
                low->stretch, low->rate};
    }

    double side() const { return 1 / per_metre_; }  ///< m, of a cell

    /// The most of anything anywhere.
    struct Most {
        double jump = 0, speed = 0;                     // m, m/s
        double stretch = 0, rate = 0;                   // no unit, 1/s
        double gradient = 0, gradient_of_velocity = 0;  // no unit, 1/s: what vectors differ by, over distance
    };
    const Most& most() const { return most_; }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.low_, self.per_metre_, self.width_, self.height_, self.last_u_, self.last_v_);
        archive(self.cells_, self.most_);
    }

    std::size_t bytes() const { return cells_.capacity() * sizeof(Cell); }

  private:
    struct Cell {
        Vec2 jump, velocity;  // m, m/s: of all bodies, then their mean
        std::size_t count = 0;
        double stretch = 0, rate = 0;  // between this centre and the next ones, and all around
    };
    std::size_t cell_of(Vec2 place) const {
        const double u = std::clamp((place.x - low_.x) * per_metre_ + 0.5, 0.0, last_u_),
                     v = std::clamp((place.y - low_.y) * per_metre_ + 0.5, 0.0, last_v_);
        return static_cast<std::size_t>(v) * width_ + static_cast<std::size_t>(u);
    }
    /// How a field of the cells changes between four centres.
    struct Change {
        double closing, gradient;
    };
    Change change_of(Vec2 Cell::*field, std::size_t low) const;
    void fill_gaps();
    void measure_stretch();

    Vec2 low_;  // m, centre of the first cell
    double per_metre_ = 1;
    std::size_t width_ = 2, height_ = 2;
    double last_u_ = 1, last_v_ = 1;  // of the last centre
    std::vector<Cell> cells_;
    Most most_;
};

}  // namespace carom
