#pragma once

#include <array>

#include "solvers/contact_sets/rebalance.hpp"
#include "solvers/paths/warm_start_limit.hpp"
#include "solvers/soft/contacts/step_view.hpp"

namespace carom {

/// The impulses that contacts begin a step with: those of the step before, as far as they are of use.
template <class Real>
class WarmStart {
  public:
    /// Rescales the impulses of the graph to the substeps of this step.
    /// @param longest_substep  s, that gravity allows for bodies of the usual radius; 0: any
    void begin_step(ContactGraph<Real>& graph, double substep_dt, double dt, double longest_substep);
    /// While steps vary in length: what the contacts keep is a mean over time. To be called when the impulses
    /// of the step are in the graph. Cost: O(contacts) then, else nothing.
    void end_step(ContactGraph<Real>& graph);
    /// Spreads what removed bodies carried over other contacts.
    void rebalance(const StepView<Real>& step, const Bodies<Real>& bodies);

    /// Takes from contacts of shapes the impulses that make energy (solvers/paths/warm_start_limit.hpp).
    void limit_paths(PathSolver<Real>& paths, const Bodies<Real>& bodies, const SubstepTerms& terms,
                     BodyRecords<Real>& records, const Real* joined, const StepLoops<Real>& loops) {
        limit_of_paths_.apply(paths, bodies, terms, records, joined, loops);
    }

    /// Factor by which `begin_step` has rescaled impulses.
    double kept() const { return kept_; }
    /// Whether this step's contacts begin without impulses.
    bool starts_anew() const { return !are_known_; }
    /// Whether impulses were spread over other contacts in this step.
    bool is_rebalanced() const { return is_rebalanced_; }
    /// Length of the substep that the impulses of contacts belong to [s].
    double substep_dt() const { return substep_dt_; }

    std::size_t bytes() const {
        std::size_t bytes = rebalance_.bytes() + limit_of_paths_.bytes();
        for (const Column<Real>& column : before_) bytes += column.bytes();
        return bytes;
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.substep_dt_, self.varying_left_);
    }

  private:
    static std::array<Column<Real>*, 6> impulses_of(ContactGraph<Real>& graph) {
        ContactRows<Real>&pairs = graph.pairs, &supports = graph.supports;
        return {&pairs.normal_impulse,    &pairs.friction_impulse,    &pairs.rolling_impulse,
                &supports.normal_impulse, &supports.friction_impulse, &supports.rolling_impulse};
    }

    double substep_dt_ = 0;  // s, 0: there are no impulses
    double kept_ = 1;
    double dt_ = 0;            // s, of the step
    double mean_over_ = 0;     // s, while steps vary
    double varying_left_ = 0;  // s, for which steps count as varying
    bool are_known_ = false, is_rebalanced_ = false;
    std::array<Column<Real>, 6> before_;  // N s, impulses at the start of the step, while steps vary
    Rebalance<Real> rebalance_;
    WarmStartLimit<Real> limit_of_paths_;
};

extern template class WarmStart<float>;
extern template class WarmStart<double>;

}  // namespace carom
