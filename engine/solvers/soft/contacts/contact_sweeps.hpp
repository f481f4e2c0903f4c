#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "parallel/phases.hpp"
#include "solvers/soft/contacts/step_view.hpp"

namespace carom {

/// Some of the runs of pairs of a step, those of a group together.
template <class Real>
struct PairRuns {
    using Run = typename ContactRows<Real>::Run;
    std::vector<Run> runs;
    std::vector<std::size_t> first;  ///< [groups + 1]: group g has runs [first[g], first[g + 1])

    /// Those of the groups that have bodies of chunks which are marked.
    void list(const ContactGraph<Real>& graph, const std::vector<std::uint8_t>& chunks) {
        const ContactRows<Real>& pairs = graph.pairs;
        runs.clear(), first.assign(1, 0);
        for (std::size_t group = 0; group < pairs.groups(); ++group) {
            const Run* const run = pairs.run.data() + pairs.first_place(group) / kContactBlock;
            if (graph.groups.touches(group, chunks))
                runs.insert(runs.end(), run, run + pairs.run_count[group]);
            first.push_back(runs.size());
        }
    }
    std::span<const Run> of_group(std::size_t group) const {
        return std::span(runs).subspan(first[group], first[group + 1] - first[group]);
    }
    std::size_t bytes() const {
        return runs.capacity() * sizeof(Run) + first.capacity() * sizeof(std::size_t);
    }
};

/// Sweeps over all contacts of a step: a kernel is run once over each pair and each support, always in the
/// same order, on several threads if there are any.
///
/// The order is that of constraints/task_groups.hpp: chunks of rows side by side, then contacts of chunks
/// that are no neighbours, then the borders between chunks and supports, then supports of crowded bodies. One
/// colour of a group follows the other; no two contacts of a batch share a body that moves.
template <class Real>
class ContactSweeps {
  public:
    /// Factor by which next sweeps go farther where masses are uneven: with more, light bodies rattle
    /// (docs/decisions/0064-uneven-masses-in-sweeps.md).
    static constexpr double kUnevenOverRelaxation = 1.4;
    /// Pairs that a sweep looks at: all; all, to mark the blocks that are not calm; those marked alone.
    enum class Blocks { all, all_and_mark, restless };
    struct Sweep {
        typename ContactKernels<Real>::Solve pair_kernel, support_kernel;
        Blocks blocks = Blocks::all;
        int times = 1;                            ///< that it is repeated, >= 0
        double over_relaxation = 1;               ///< factor by which normal impulses of pairs go farther
        const PairRuns<Real>* of_runs = nullptr;  ///< pairs that it keeps to; null: all that can touch
    };

    /// The sweeps after the first: all but the last are over-relaxed where contacts are smooth.
    /// @param times  how many there are
    static std::array<Sweep, 2> next(const StepView<Real>& step, Blocks blocks, int times);

    /// What kernels are told of contacts of one kind, in a substep.
    /// @param rows  the pairs or the supports of the step
    static SolveContacts<Real> arguments(const StepView<Real>& step, ContactRows<Real>& rows);
    /// The same for contacts of another kind: their columns alone are others.
    static SolveContacts<Real> with_rows(SolveContacts<Real> k, ContactRows<Real>& rows) {
        k.contacts = rows.columns(), k.needs_second_sweep = rows.needs_second_sweep.data();
        return k;
    }

    /// To be called when the contacts of a step are found.
    /// @param contacts  how many there are: the executor wants to know how long a sweep takes
    void begin_step(std::int64_t contacts) { contacts_ = contacts; }

    /// Runs the sweeps one after the other.
    void run(const StepView<Real>& step, std::span<const Sweep> sweeps, const SolveContacts<Real>& on_pairs,
             const SolveContacts<Real>& on_supports);
    /// Runs sweeps with the arguments that are above.
    void run(const StepView<Real>& step, std::span<const Sweep> sweeps) {
        const SolveContacts<Real> on_pairs = arguments(step, step.graph.pairs);
        run(step, sweeps, on_pairs, with_rows(on_pairs, step.supports));
    }

    std::size_t bytes() const { return phases_.capacity() * sizeof(PhaseKind); }

  private:
    /// What a sweep is cut into for threads, in this order.
    enum class Part : std::uint8_t { chunks, far, borders, crowded_supports };
    void list_phases(std::size_t sweeps, bool has_far, bool has_crowded);

    std::int64_t contacts_ = 0;  // of this step
    std::array<Part, 4> part_{};
    std::uint32_t parts_ = 0;  // of a sweep; zero: not listed yet
    bool has_far_ = false, has_crowded_ = false;
    /// The list holds the phases of as many sweeps as there have been at once. Each sweep has the same ones,
    /// so that they are listed anew only when contacts of chunks that are no neighbours, or crowded bodies,
    /// have come or gone.
    std::vector<PhaseKind> phases_;
};

extern template class ContactSweeps<float>;
extern template class ContactSweeps<double>;

}  // namespace carom
