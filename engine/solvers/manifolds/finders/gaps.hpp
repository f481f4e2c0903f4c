#pragma once

#include "isa/convex_kernels.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/manifolds/meetings/held_flights.hpp"
#include "solvers/manifolds/meetings/meeting.hpp"
#include "solvers/manifolds/poses/contact_distance.hpp"
#include "solvers/manifolds/poses/piece_items.hpp"
#include "solvers/manifolds/poses/pose_watch.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Contacts of two bodies with a gap between them, as the kernels have found them: where the bodies meet, if
/// they do, and whether they can in the step.
template <class Real>
class Gaps {
  public:
    struct Inputs {
        const WorldState<Real>& world;
        const PieceItems<Real>& items;
        const PoseWatch<Real>& poses;
        const HeldFlights<Real>& flights;
        const ContactDistance& near;
        double dt;  // s, of the step
        const ConvexKernels<Real>& kernels;
    };
    Gaps(const Inputs& in, ManifoldList<Real>& contacts) : in_(in), contacts_(contacts) {}

    /// Whether a contact is a face of what stands still that holds its body in the step.
    bool holds(std::size_t i) const;
    /// Looks at the contacts first ... last of a block: they become those of the moment of meeting, or none.
    void look_at(std::size_t first, std::size_t last);

  private:
    QuestionGaps<Real> arguments() const;
    void look_at_one(std::size_t i);
    bool are_corners_beside(std::size_t i) const;
    bool stay_parted(std::size_t i) const;
    bool find_meeting(std::size_t i, double gap);
    bool do_pass(std::size_t i, const Manifold<double>& facing) const;
    bool can_close(std::size_t i) const;
    bool are_far_apart(std::size_t i, Real gap) const;
    bool may_come_together(std::size_t i) const;
    /// The velocity of body a of contact i: where b stands still, as far as others that do let it fly.
    Vec2 velocity_of_a(std::size_t i) const {
        const auto a = static_cast<std::size_t>(contacts_.a[i]), b = static_cast<std::size_t>(contacts_.b[i]);
        const Bodies<Real>& bodies = in_.world.bodies;
        if (bodies.stands(b)) return in_.flights.velocity(bodies, a);
        return {bodies.velocity_x[a], bodies.velocity_y[a]};
    }
    Vec2 velocity_of_b(std::size_t i) const {
        const auto b = static_cast<std::size_t>(contacts_.b[i]);
        return {in_.world.bodies.velocity_x[b], in_.world.bodies.velocity_y[b]};
    }
    double spin_of(std::int32_t row) const {
        const Bodies<Real>& bodies = in_.world.bodies;
        return bodies.has_rotation
                   ? static_cast<double>(bodies.angular_velocity[static_cast<std::size_t>(row)])
                   : 0;
    }
    /// The bodies of contact i as they fly.
    MovingConvex flying_a(std::size_t i) const {
        const auto a = static_cast<std::size_t>(contacts_.a[i]);
        return moving_row(in_.world, a, velocity_of_a(i), shape_of(a, contacts_.item_a, i));
    }
    MovingConvex flying_b(std::size_t i) const {
        const auto b = static_cast<std::size_t>(contacts_.b[i]);
        return moving_row(in_.world, b, velocity_of_b(i), shape_of(b, contacts_.item_b, i));
    }
    /// @param items  of contacts, of the side where `row` is
    std::int32_t shape_of(std::size_t row, const Column<std::int32_t>& items, std::size_t i) const {
        const auto number = static_cast<std::int32_t>(row);
        return in_.items.shape_of(in_.world, number, in_.items.empty() ? number : items[i]);
    }

    const Inputs in_;
    ManifoldList<Real>& contacts_;
};

extern template class Gaps<float>;
extern template class Gaps<double>;

}  // namespace carom
