#pragma once

#include <carom/ledger.hpp>

#include <cstdint>

#include "solvers/soft/contact_sweeps.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Restitution of solver `soft`: what came to touch in a step leaves with its share of the speed it came
/// with.
template <class Real>
class Bounces {
  public:
    /// Contacts have not pushed yet. To be called in steps with restitution, when the contacts are found.
    static void begin_step(const StepView<Real>& step);
    /// Sweeps until every impact of the step leaves with its speed. @return how many contacts bounce
    std::int64_t bounce(const StepView<Real>& step, ContactSweeps<Real>& sweeps,
                        const WorldState<Real>& world, Books& books);

    std::size_t bytes() const { return before_.bytes(); }

  private:
    std::int64_t find(ContactRows<Real>& live, const StepView<Real>& step, const WorldState<Real>& world);
    void sweep(const StepView<Real>& step, ContactSweeps<Real>& sweeps) const;

    double fastest_ = 0;   // m/s, of this step
    Column<Real> before_;  // velocity records; only with the ledger
};

extern template class Bounces<float>;
extern template class Bounces<double>;

}  // namespace carom
