#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "isa/convex_kernels.hpp"
#include "parallel/executor.hpp"
#include "solvers/manifolds/poses/contact_distance.hpp"
#include "state/columns/changed_rows.hpp"
#include "state/columns/column.hpp"
#include "state/world_state.hpp"

namespace carom {

/// The poses of bodies as the find kernels see them, how far each body has come since the step before, and
/// whether it has come so far since its contacts were found that they must be found again. Contacts of two
/// bodies that have hardly moved are carried on: their separations follow to first order, and what is left
/// out is of the second order of what the bodies moved.
///
/// Cost: about 3 ns a body that is awake and does not stand.
template <class Real>
class PoseWatch {
  public:
    Column<Real> pose;  ///< [rows][4]: x, y [m], cosine, sine of the angle

    /// Reads the poses at the start of a step.
    /// @param near  of the contacts
    /// @param forgets  whether contacts of all bodies are to be found
    void look(const WorldState<Real>& world, double dt, const ContactDistance& near, bool forgets,
              const ConvexKernels<Real>& kernels, const Executor& executor);
    /// How far the surface of each body can have come [m] is to be counted from here on; rows may have
    /// changed.
    void begin_paths() { begins_paths_ = true; }
    /// What is known of bodies goes with them when rows change; contacts of those that came or were put
    /// elsewhere are to be found.
    /// @param now  present row of each former one, or negative
    /// @param is_elsewhere  a present row, whether its body was put elsewhere
    void follow_rows(const Bodies<Real>& bodies, std::span<const std::int32_t> now,
                     std::span<const std::uint8_t> is_elsewhere);
    /// Rows that the last look was at: all, or those of what can move where what stands and what sleeps is
    /// where it was and has been seen to be still.
    std::size_t rows_looked_at() const { return rows_looked_at_; }
    /// m, how far the surface of a row can have come up to now, in both directions and by turning;
    double path(std::size_t row) const { return path_[row]; }
    /// m, and what it can come in this step alone, with what motors may add.
    Real way(std::size_t row) const { return way_[row]; }
    /// m, what motors may add to that of both bodies of a contact: a flipper at rest strikes what is just
    /// above it.
    Real way_of_motors(std::size_t a, std::size_t b) const;
    /// Whether the contacts of a row must be found again.
    bool has_moved(std::int32_t row) const { return has_moved_[static_cast<std::size_t>(row)] != 0; }
    /// Tells that a row has a contact of this thickness [m]: what it moves is measured in the thinnest.
    void note_thickness(std::int32_t row, Real thickness) {
        Real& thinnest = thinnest_[static_cast<std::size_t>(row)];
        thinnest = std::min(thinnest, thickness);
    }

    /// m, of the thinnest contact that a row has had since all were found; infinite: none is known.
    Real thinnest(std::size_t row) const { return thinnest_[row]; }

    /// [rows][2], m, what each body that is awake has come in the step before, and m of its rim. Rows up to
    /// `rows`, of what else there is, have zero.
    const Real* come(std::size_t rows);
    const Real* turned() const { return turned_.data(); }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.pose, self.angle_, self.base_, self.thinnest_, self.path_);
        if constexpr (!std::is_const_v<Self>)
            self.joints_version_ = -1, self.looks_at_others_ = kLooksAtOthers;  // of the world's own joints
    }

  private:
    WatchPoses<Real> arguments(const Bodies<Real>& bodies, double dt, const ContactDistance& near);
    void turn(const Bodies<Real>& bodies, const ConvexKernels<Real>& kernels, std::size_t first,
              std::size_t last);
    void look_at_immovable(const Bodies<Real>& bodies, std::size_t first, std::size_t last);
    void follow_paths(std::size_t first, std::size_t last);
    void look_at_motors(const WorldState<Real>& world, double dt);

    // What stands or sleeps is looked at where rows may have changed, and then once more: it has come
    // nowhere.
    static constexpr int kLooksAtOthers = 2;

    std::size_t awake_ = 0;  // rows of bodies that may move
    int looks_at_others_ = kLooksAtOthers;
    std::size_t rows_looked_at_ = 0;
    Column<Real> angle_;     // rad, by row
    Column<Real> base_;      // [rows][4]: x, y [m], angle [rad] at which contacts were found; unused
    Column<Real> thinnest_;  // m, by row
    Column<std::uint8_t> has_moved_;
    Column<Real> come_, turned_, moved_, way_;
    Column<double> path_;  // m, by row: small steps must not get lost in a long way
    bool begins_paths_ = false;
    ChangedRows changed_;                   // scratch of follow_rows
    std::vector<std::int32_t> fresh_rows_;  // whose contacts are to be found, since the last look
    struct Driven {
        std::size_t row;
        Real way;  // m
    };
    std::vector<Driven> driven_;              // by row
    std::vector<std::uint32_t> with_motors_;  // slots of joints
    std::int64_t joints_version_ = -1;        // JointStore::version of that list
};

extern template class PoseWatch<float>;
extern template class PoseWatch<double>;

}  // namespace carom
