#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "broadphase/row_names.hpp"
#include "isa/kernel_table.hpp"
#include "narrowphase/rectangle_gap.hpp"
#include "state/bodies.hpp"
#include "state/shape_frames.hpp"

namespace carom {

/// Bodies that are much longer than they are thick, as planks are: the broadphase sees the disc around a
/// body, and most planks that lie in each other's discs are far from each other. So the rectangles around
/// them are asked, too. A pair is dropped if its rectangles are parted by more than what both bodies'
/// margins, and the turns they are allowed, let them come nearer. A body that has turned by more than it is
/// allowed is to get new margins and pairs, as one that has left its margin.
///
/// Where the places of bodies drift with a flow, two of them come nearer by a share of their distance: pairs
/// are void once that share is above `spread`.
///
/// Bodies that are not slim are the discs that they are in; nothing has to be known of their turns.
template <class Real>
class SlimBodies {
  public:
    /// To be called before pairs are found anew. Cost: O(shapes) where they have changed.
    void read_shapes(const ShapeStore<Real>& shapes);
    /// Whether there are none: then pairs are not asked for rectangles.
    bool empty() const { return !some_are_slim_; }
    void clear() { some_are_slim_ = false; }

    /// Starts to list rectangles anew, for the rows of all bodies.
    /// @param spread  no unit, see above
    void begin(std::size_t rows, double spread);
    double spread() const { return spread_; }
    /// A row gets a rectangle, and a turn that it is allowed.
    /// @param place  m, of its margin
    /// @param margin, reach  m
    void set(const Bodies<Real>& bodies, std::size_t row, Vec2 place, double margin, double reach, double dt);
    /// What `set` gave all rows is what pairs are found by.
    void note_all_are_first() { first_pose_ = pose_, first_size_ = size_; }
    /// Rectangles go with their bodies when rows change; fresh rows are to be `set`.
    void follow_rows(const RowNames& names);
    /// Drops the pairs that are parted.
    std::size_t drop_parted(const KernelTable<Real>& kernels, std::int32_t* a, std::int32_t* b,
                            std::size_t count) const;

    /// Whether drop_parted would have dropped a pair when all were found.
    bool were_parted(std::size_t a, std::size_t b) const {
        return are_parted(rectangle(first_pose_[a], first_size_[a], {}),
                          rectangle(first_pose_[b], first_size_[b], {}), first_size_[a], first_size_[b]);
    }
    /// Whether two rows cannot meet as long as both keep their margins and turns.
    /// @param of_a, of_b  m, how far their places have drifted since their margins were set
    bool are_parted(std::size_t a, std::size_t b, Vec2 of_a, Vec2 of_b) const {
        return are_parted(rectangle(pose_[a], size_[a], of_a), rectangle(pose_[b], size_[b], of_b), size_[a],
                          size_[b]);
    }
    /// Place that a row's margin had when it was set [m].
    Vec2 place(std::size_t row) const { return {place_x_[row], place_y_[row]}; }

    /// Adds the rows that will have turned by more than they are allowed at the end of a step.
    /// @param rows  in order, none twice; it stays so if some are added. Cost: O(bodies) where some are slim
    void add_turned(const Bodies<Real>& bodies, double dt, std::vector<std::int32_t>& rows) const;

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.some_are_slim_, self.spread_, self.pose_, self.size_, self.first_pose_,
                self.first_size_);
        archive(self.place_x_, self.place_y_, self.angle_, self.turn_);
        if constexpr (!std::is_const_v<Self>) self.frames_.forget(), self.revision_ = 0;
    }

  private:
    using Record = std::array<Real, 4>;
    static Rectangle<Real> rectangle(const Record& pose, const Record& size, Vec2 drift) {
        return {pose[0] + static_cast<Real>(drift.x),
                pose[1] + static_cast<Real>(drift.y),
                pose[2],
                pose[3],
                size[0],
                size[1]};
    }
    static bool are_parted(const Rectangle<Real>& a, const Rectangle<Real>& b, const Record& size_a,
                           const Record& size_b) {
        return !(rectangle_gap(a, b) <= size_a[2] + size_b[2]);
    }
    bool is_slim(std::int32_t shape) const { return is_slim_[static_cast<std::size_t>(shape)] != 0; }

    ShapeFrames<Real> frames_;
    std::vector<std::uint8_t> is_slim_;  // by shape
    std::uint64_t revision_ = 0;         // of the shapes
    bool some_are_slim_ = false;
    double spread_ = 0;
    // By row: centre of the rectangle [m], cosine and sine of its angle; half sides, what it may grow by [m].
    Column<Record> pose_, size_, first_pose_, first_size_;
    Column<Real> place_x_, place_y_;  // m
    Column<Real> angle_, turn_;  // rad, where the rectangle was set; rad, that the body may turn from there
};

extern template class SlimBodies<float>;
extern template class SlimBodies<double>;

}  // namespace carom
