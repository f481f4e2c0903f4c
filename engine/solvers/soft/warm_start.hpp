#pragma once

#include "solvers/shared/rebalance.hpp"
#include "solvers/soft/step_view.hpp"

namespace carom {

/// The impulses that contacts begin a step with: those of the step before, as far as they are of use.
template <class Real>
class WarmStart {
  public:
    /// Rescales the impulses of the graph to the substeps of this step, or forgets them.
    void begin_step(ContactGraph<Real>& graph, double substep_dt);
    /// Spreads what removed bodies carried over other contacts.
    void rebalance(const StepView<Real>& step, const Bodies<Real>& bodies);

    /// Factor by which `begin_step` has rescaled impulses.
    double kept() const { return kept_; }
    /// Whether this step's contacts begin without impulses.
    bool starts_anew() const { return !are_known_; }
    /// Whether impulses were spread over other contacts in this step.
    bool is_rebalanced() const { return is_rebalanced_; }
    /// Length of the substep that the impulses of contacts belong to [s].
    double substep_dt() const { return substep_dt_; }

    std::size_t bytes() const { return rebalance_.bytes(); }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.substep_dt_);
    }

  private:
    double substep_dt_ = 0;  // s, 0: there are no impulses
    double kept_ = 1;
    bool are_known_ = false, is_rebalanced_ = false;
    Rebalance<Real> rebalance_;
};

extern template class WarmStart<float>;
extern template class WarmStart<double>;

}  // namespace carom
