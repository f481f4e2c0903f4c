#pragma once

#include <vector>

#include "solvers/contact_sets/contact_relaxation.hpp"
#include "solvers/contact_sets/local_solve.hpp"
#include "solvers/soft/contacts/contact_sweeps.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/substeps/body_masses.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What the sweeps of a substep leave where masses are uneven.
///
/// Few contacts around light bodies are solved by themselves (solvers/contact_sets/local_solve.hpp).
/// Many are swept again until that changes little, where masses differ by up to a thousand times, without
/// friction up to three hundred: docs/decisions/0064-uneven-masses-in-sweeps.md. Where masses differ by more
/// and the impulses are still off, since heavy and light bodies are mixed in a pile, all contacts of the
/// world are relaxed for the velocities of bodies (solvers/contact_sets/contact_relaxation.hpp) from then on,
/// until the sweeps alone have left little for a while: docs/decisions/0032-piles-of-uneven-masses.md.
/// What overlaps is parted by equal shares whatever the masses: a light body between two heavy ones cannot
/// make room.
template <class Real>
class UnevenContacts {
  public:
    /// Pairs are new. Cost: O(pairs) where masses are uneven.
    void find(const ContactRows<Real>& pairs, const BodyMasses<Real>& masses, std::size_t rows);
    void clear() { local_.clear(), blocks_.clear(); }
    /// Whether contacts are swept again.
    bool are_swept() const { return !blocks_.empty(); }
    /// To be called when the contacts of a step are found.
    /// @param are_mixed  whether bodies that differ by more than is swept are mixed
    void begin_step(const StepView<Real>& step, const WorldState<Real>& world, bool are_mixed);
    /// After the sweeps of a substep. Cost: O(contacts), times a few dozen while piles of uneven masses move.
    /// @param is_last  in the last substep contacts at rest are swept again as well
    /// @return how often many contacts were swept again; 0 where few are solved, or all relaxed
    int solve(const StepView<Real>& step, ContactSweeps<Real>& sweeps, bool is_last);

    std::size_t bytes() const {
        return local_.bytes() + blocks_.capacity() + runs_.bytes() +
               deep_.capacity() * sizeof(std::uint32_t) + before_.capacity() * sizeof(Real) +
               smooth_.bytes() + rough_.bytes() + contacts_.capacity() * sizeof(LocalContact) +
               (number_of_.capacity() + rows_.capacity() + swept_.capacity()) * sizeof(std::int32_t);
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.steps_left_);
    }

  private:
    void list_runs(const ContactRows<Real>& pairs);
    void list_swept(const StepView<Real>& step);
    bool has_changed(const StepView<Real>& step, double limit);
    int sweep(const StepView<Real>& step, ContactSweeps<Real>& sweeps, bool is_last);
    void list(const StepView<Real>& step);
    void load(const StepView<Real>& step, const SolveContacts<Real>& k, LocalContact& contact) const;
    double residual(const StepView<Real>& step) const;
    template <int kSize>
    void relax(const StepView<Real>& step, ContactRelaxation<kSize>& relaxation);
    void part(const StepView<Real>& step, const SolveContacts<Real>& k, std::size_t contact, std::int32_t a,
              std::int32_t b, double slop) const;

    LocalSolve<Real> local_;
    std::vector<std::uint8_t> blocks_;  // of pairs: which are swept again; empty: none
    PairRuns<Real> runs_;               // of these blocks, as far as they can touch in this step
    int most_relaxed_ = 0;              // over-relaxed sweeps of a substep
    double enough_ = 0;                 // change of a velocity by the last of them, of what gravity adds
    std::vector<std::uint32_t> deep_;   // of these pairs, those whose overlaps are parted in this step
    std::vector<std::int32_t> swept_;   // rows that these pairs have
    std::vector<Real> before_;          // [of these][4]: velocity records when they were looked at last
    ContactRelaxation<2> smooth_;
    ContactRelaxation<3> rough_;
    bool may_relax_ = false;              // in this step
    bool is_listed_ = false;              // likewise
    bool is_first_ = false;               // substep of the step
    bool has_many_left_ = false;          // contacts, the local solve, when it was asked last
    int steps_left_ = 0;                  // for which all contacts are looked at
    std::vector<LocalContact> contacts_;  // of the step: pairs, then supports
    std::size_t pair_count_ = 0;
    std::vector<std::int32_t> rows_;       // of the bodies that have contacts
    std::vector<std::int32_t> number_of_;  // by row, in rows_
};

extern template class UnevenContacts<float>;
extern template class UnevenContacts<double>;

}  // namespace carom
