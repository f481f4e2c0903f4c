#pragma once

#include <cstdint>
#include <vector>

#include "solvers/contact_sets/local_contact.hpp"
#include "solvers/contact_sets/support_normals.hpp"
#include "solvers/soft/contacts/step_view.hpp"

namespace carom {

/// Solves what the sweeps leave of bodies in a wedge: between two surfaces that nothing moves and that face
/// each other at an acute angle.
///
/// A sweep takes from such a body first what one surface stops and then what the other one does, and leaves
/// cos² of the angle: 0.9975 at 0.05 rad. Its impulses last, and are given again in each substep, so that a
/// body comes back out as if the surfaces were springs. Here the normal impulses of all supports of the body
/// are found at once (solvers/contact_sets/support_normals.hpp), in turns with friction.
/// Numbers: docs/decisions/0054-wedges.md.
template <class Real>
class WedgedBodies {
  public:
    /// To be called when the supports of a step are found. Cost: O(supports); nothing where walls are the
    /// only ones.
    void begin_step(const StepView<Real>& step, const Bodies<Real>& bodies);
    bool empty() const { return bodies_.empty(); }
    /// After the sweeps of a substep. Cost: O(bodies in a wedge), see docs/decisions/0054-wedges.md.
    void solve(const StepView<Real>& step, const SolveContacts<Real>& on_supports);

    std::size_t bytes() const;

  private:
    /// Supports [first, last) of supports_.
    struct Wedged {
        std::int32_t row;
        std::uint32_t first, last;
    };
    /// A support of a body that has others.
    struct Support {
        std::int32_t row;
        std::uint32_t support;
    };

    void list_shared(const ContactRows<Real>& supports);
    bool keeps_off(const Wedged& body, const ContactRows<Real>& supports, Vec2 velocity,
                   double tolerance) const;
    void solve(const Wedged& body, const StepView<Real>& step, const SolveContacts<Real>& on_supports);

    std::vector<std::int32_t> latest_;  // by row: the last support of it that was seen; -1: none
    std::vector<Support> shared_;       // of bodies that have more than one, by row
    std::vector<std::uint32_t> supports_;
    std::vector<Wedged> bodies_;
    std::vector<LocalContact> contacts_;  // of one body
    std::vector<SupportNormal> normals_;  // likewise
    int further_turns_ = 0;               // left to the bodies of this substep
};

extern template class WedgedBodies<float>;
extern template class WedgedBodies<double>;

}  // namespace carom
