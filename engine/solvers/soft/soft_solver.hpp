#pragma once

#include <carom/ledger.hpp>

#include <span>
#include <vector>

#include "constraints/contact_graph.hpp"
#include "constraints/contact_rows.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "solvers/shared/coarse_correction.hpp"
#include "solvers/shared/local_solve.hpp"
#include "solvers/shared/project_positions.hpp"
#include "solvers/shared/rebalance.hpp"
#include "solvers/soft/impacts.hpp"
#include "state/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

struct SupportSurface;

inline constexpr int kDefaultIterations = 2;  // sweeps a substep: docs/decisions/0004-soft-solver.md

/// What the soft solver counts (the docstrings of Profile say what each means).
struct SoftCounters {
    std::int64_t contacts = 0;  ///< in the last step
    std::int64_t colours = 0;
    std::int64_t overflow = 0;
    std::int64_t bounces = 0;  ///< ever
};

/// How well the last step's contacts were solved.
struct SolveQuality {
    std::int64_t touching = 0;  ///< contacts that push
    double residual = 0;      ///< m/s, root mean square over contacts that push, or would after a sweep more
    double residual_max = 0;  ///< m/s
};

/// Solver `soft`: contacts at rest, with friction and rotation.
///
/// A step finds the contacts once and is then cut into substeps. In each, two Gauss-Seidel sweeps over the
/// coloured contacts bring the velocities to what the contact laws allow; the first also takes away a share
/// of every overlap, by displacement, never by velocity. Contacts keep their impulses from substep to substep
/// and from step to step (warm start), which is what carries a pile. Restitution comes last, at the speed of
/// the impact, repeated until it has converged.
///
/// Why overlaps are soft and velocities hard: docs/decisions/0004-soft-solver.md.
/// Cost: about 8 sweeps a step at 4 substeps, docs/decisions/0004-soft-solver.md.
/// Source: small steps (Macklin et al. 2019), the Soft Step of Box2D 3 (Catto 2024), here with split
/// displacement.
template <class Real>
class SoftSolver {
  public:
    ContactGraph<Real> graph;
    Impacts<Real> impacts;
    SoftCounters counters;
    /// Sweeps over the contacts a substep, >= 1: a first one and next ones. With 1 the first is not
    /// over-relaxed and loads are not corrected on the coarse grid; with more than 2 no contact is left out.
    int iterations = kDefaultIterations;

    /// Velocity records of all bodies at the start of a step.
    void begin_substeps(const WorldState<Real>& world, const Column<Real>& motion, double h,
                        const Vec2 gravity, const KernelTable<Real>& kernels, const Executor& executor);

    /// Contacts that can touch in this step, by colour.
    /// @param motion  [rows][4] at the start of the step; gets rows for the padding of groups
    void find_contacts(const WorldState<Real>& world, const Candidates<Real>& candidates,
                       const EdgeCandidates<Real>& edges, Column<Real>& motion, double dt);

    /// Whether bodies are gone on which others rested.
    bool has_lost_loads() const { return !graph.lost.empty(); }
    /// Spreads what they carried over other contacts.
    void rebalance_loads(const Bodies<Real>& bodies);

    /// Gives the bodies last step's impulses.
    void warm_start();

    /// Both sweeps of substep `number`, or the first alone if correct_loads is due. The second leaves out
    /// what is calm, but not in the last substep.
    void solve_contacts(int number, bool is_last);
    /// Corrects the loads of large piles between the sweeps of the last substep, if that is due, and sweeps
    /// once more.
    /// @param motion  of the bodies at the start of the step
    void correct_loads(const Column<Real>& motion);
    /// Solves what the sweeps leave where masses are uneven; nothing where they are not.
    void solve_uneven_contacts();
    /// Moves the bodies through the substep that was solved.
    void advance_bodies(bool is_last);
    /// Tells what bounces from what rests (impacts.hpp).
    void mark_impacts(const WorldState<Real>& world);
    /// Carries out the impacts of a substep.
    void carry_out_impacts(const Column<Real>& motion, Books& books);
    /// Restitution.
    void bounce(const WorldState<Real>& world, Books& books);
    /// The impulses back to the candidates.
    void end_contacts();
    /// Parts who has ended the step deep in somebody else (project_positions.cpp): by displacement alone.
    /// @param fastest  m/s, of all bodies at the start
    /// Cost: nothing unless the fastest moves by four radii of the smallest disc, or a pair started deep in
    /// each other; O(bodies + pairs), to look for discs that are small enough, unless one of them was
    /// deflected.
    void project_positions(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                           const Column<Real>& motion, const Candidates<Real>& candidates, double fastest);
    /// Columns from records.
    /// @param lost  rows whose state left the limits; they stand still where they were
    void end_substeps(Bodies<Real>& bodies, std::vector<std::int32_t>& lost);
    /// Puts discs that have got past an edge in this step back to it.
    /// @param fastest  m/s, of all bodies at the start
    void undo_tunnelling(WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                         const Column<Real>& motion, const Candidates<Real>& candidates, double fastest);

    /// What the impulses of this substep did (books.cpp); only the walls' impulses if the ledger is
    /// closed.
    void book_substep(const WorldState<Real>& world, Books& books);
    /// What the pushes of this step did against gravity.
    void book_displacements(const WorldState<Real>& world, const Column<Real>& motion, Books& books);

    /// What a row that end_substeps lists as lost had by the books: the velocity that the impulses gave it,
    /// at the place where it stays.
    Sums sums_of_lost(const WorldState<Real>& world, std::size_t row) const;

    /// Masses, shapes or rows have changed: what was derived from them is made anew.
    void forget_rows() { masses_are_known_ = false; }

    /// Looks at the contacts of the last step again. Cost: O(contacts), and nothing in the step itself.
    SolveQuality quality() const;
    /// Length of the substep that the impulses of contacts belong to [s].
    double substep_of_impulses() const { return impulses_of_h_; }

    /// How loops over bodies are cut: a thread then gets the bodies that it has in its cache from the sweeps.
    std::size_t rows_per_task() const;

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.graph, self.counters, self.impulses_of_h_, self.coarse_);
        if constexpr (!std::is_const_v<Self>) self.forget_step();
    }

  private:
    /// Nothing of the last step is known any more.
    void forget_step() { masses_are_known_ = false, count_ = 0; }

    using ContactKernel = void (*)(const SolveContacts<Real>&, std::size_t, std::size_t);
    /// What a sweep does to each contact.
    struct Sweep {
        ContactKernel pair_kernel, support_kernel;
        /// Of pairs: those alone whose block is marked, or all, to mark them anew.
        enum class Blocks { all, all_and_mark, restless } blocks = Blocks::all;
        int times = 1;
    };
    /// What sweeps are cut into for threads: `kind` of sweep `sweep`.
    struct SweepPart {
        enum class Kind { chunks, far, borders, crowded_supports } kind;
        const Sweep* sweep;
    };
    /// What a body felt from an edge that it has left.
    struct LeftEdge {
        std::int32_t row, body, candidate;  // of the disc; number of the edge's body
        Real normal_impulse, friction_impulse, rolling_impulse;
    };
    /// A disc whose centre crossed an edge.
    struct Tunnelled {
        std::int32_t row, edge;
        double time;       // share of the step
        Vec2 from, point;  // m, in the frame of the edge's body: before, and where it crossed
    };
    void note_tunnelled(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                        const Column<Real>& motion, std::int32_t disc, std::int32_t number);
    void find_tunnelled(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                        const Column<Real>& motion);
    void put_back(WorldState<Real>& world, const EdgeCandidates<Real>& edges, const Tunnelled& passed,
                  bool to_start);

    Vec2 place_of(std::size_t row, const Column<Real>& motion) const;
    bool mark_deflected(const WorldState<Real>& world, const Column<Real>& motion, double largest);
    bool mark_stuck(const WorldState<Real>& world, const Column<Real>& motion, double largest);
    void mark_deep();
    void list_parted_pair(const Bodies<Real>& bodies, const Column<Real>& motion, std::int32_t row_a,
                          std::int32_t row_b, bool is_loaded);
    bool is_loaded(std::size_t pair) const;
    void put_back_thrown(const Bodies<Real>& bodies, const Column<Real>& motion,
                         const Candidates<Real>& candidates);
    void find_thrown(const Bodies<Real>& bodies, const Candidates<Real>& candidates);
    void list_pairs_of_thrown(const Bodies<Real>& bodies, const Column<Real>& motion,
                              const Candidates<Real>& candidates);
    void list_parted_pairs(const Bodies<Real>& bodies, const Column<Real>& motion);
    void list_parted_supports(const WorldState<Real>& world, const EdgeCandidates<Real>& edges);

    /// Separation up to which bodies at rest are in contact [m], whose smaller radius is `radius`.
    double contact_distance(double radius) const;
    /// Overlap that the sweeps do not take away soon enough [m].
    double deep_overlap(double radius) const;
    /// The smaller radius of the two bodies of a pair [m].
    double smaller_radius(std::size_t pair) const {
        return radius_varies_ ? static_cast<double>(graph.pairs.smaller[pair]) : uniform_radius_;
    }
    void rescale_impulses(ContactRows<Real>& candidates) const;
    void derive_masses(const Bodies<Real>& bodies);
    void find_pairs(const Bodies<Real>& bodies, const Column<Real>& motion);
    void describe_group(const Bodies<Real>& bodies, std::size_t group);
    void list_runs(std::size_t group);
    void find_supports(const WorldState<Real>& world, const EdgeCandidates<Real>& edges);
    void find_supports_of(std::size_t group, const WorldState<Real>& world,
                          const EdgeCandidates<Real>& edges);
    void add_support(const SupportSurface& surface, std::size_t candidate, std::size_t at,
                     const WorldState<Real>& world);
    void note_left_edge(std::size_t candidate, std::size_t group, const WorldState<Real>& world);
    void hand_on_impulses(const WorldState<Real>& world);
    ContactEffects contact_effects() const;
    SolveContacts<Real> arguments(ContactRows<Real>& live);
    StartColumns<Real> start_columns();
    void sweep(std::span<const Sweep> sweeps, const SolveContacts<Real>& on_pairs,
               const SolveContacts<Real>& on_supports);
    void sweep_pairs(std::size_t group, const Sweep& sweep, const SolveContacts<Real>& on_pairs);
    void sweep_supports(std::size_t group, const Sweep& sweep, const SolveContacts<Real>& on_supports) const;
    SolveContacts<Real> coarse_arguments(ContactRows<Real>& live);
    Sweep next_sweep(typename Sweep::Blocks blocks, int times = 1) const;
    void retain_correction();
    /// Row that the padding of a group of supports names.
    std::int32_t padding_row_of_supports(std::size_t group) const {
        return static_cast<std::int32_t>(count_ + graph.groups.count() + group);
    }
    const ContactKernels<Real>& contact_kernels() const;
    bool find_bounces(ContactRows<Real>& live, const WorldState<Real>& world);
    double restitution_of(const ContactRows<Real>& live, std::size_t contact,
                          const WorldState<Real>& world) const;
    double impact_speed(const ContactRows<Real>& live, std::size_t contact) const;
    void sweep_bounces();
    void book_bounces(Books& books) const;
    struct Impulses;
    template <class From>
    void book_contacts(const ContactRows<Real>& contacts, const Impulses& impulses, const From& from,
                       Books& books) const;
    void book_supports(const Impulses& impulses, Books& books) const;
    template <class From>
    void book_kinds(const Impulses& of_supports, const Impulses& of_pairs, const From& from,
                    Books& books) const;
    void book_free_flight(const WorldState<Real>& world, Books& books);
    double change_of_bounces(ContactRows<Real>& live) const;

    // These members hold for the present step alone.
    const KernelTable<Real>* kernels_ = nullptr;
    const Executor* executor_ = nullptr;
    std::size_t count_ = 0;
    double substep_dt_ = 0, dt_ = 0, elapsed_ = 0, largest_radius_ = 0;
    double uniform_radius_ = 1;  // m, of all; 1 where radii vary, so that what follows is a share of them
    double push_ = 0;            // m, or a share of the smaller radius: largest displacement by an overlap
    double fall_ = 0;            // m, what a body falls from rest in a step, by substeps
    Vec2 gravity_change_;
    double decay_ = 1, spin_decay_ = 1;
    bool has_friction_ = false, has_rotation_ = false, some_are_fixed_ = false, bounces_ = false;
    bool friction_varies_ = false, rolls_ = false, rolling_varies_ = false, radius_varies_ = false;
    double uniform_friction_ = 0, uniform_rolling_ = 0;

    bool masses_are_known_ = false;
    bool masses_vary_ = false, are_masses_uneven_ = false;
    Column<Real> inverse_mass_;  // signed as in the records

    Column<Real> velocity_, displacement_, turn_;
    Column<Real> start_x_, start_y_, start_rim_;  // velocities at the start of the substep
    ContactRows<Real> supports_;                  // those of graph.supports that can touch in this step
    std::vector<SweepPart> sweep_parts_;          // of the sweeps of now
    std::vector<PhaseKind> sweep_phases_;
    // Of the graph whose pairs' masses and reaches are known.
    std::int64_t described_version_ = -1, described_renewal_ = -1;
    std::vector<LeftEdge> left_edges_;                  // of this step
    std::vector<std::vector<LeftEdge>> left_edges_of_;  // a group of supports
    std::vector<Tunnelled> tunnelled_;                  // likewise
    std::vector<std::int32_t> strayed_;                 // rows that have left their margins in this step
    ChunkedList lost_rows_;
    bool is_crowded_ = false;  // some pair started the step deeper than the sweeps take away soon enough
    PositionProjection parting_;
    std::vector<std::int32_t> thrown_;  // rows, by x
    Column<std::int32_t> near_rows_;
    double impulses_of_h_ = 0;  // s, substep of the candidates' impulses; 0 = there are none
    bool are_impulses_known_ = false;
    bool is_unloaded_ = false;  // bodies are gone on which others rested
    Rebalance<Real> unloading_;
    LocalSolve<Real> uneven_;
    CoarseCorrection<Real> coarse_;
    bool is_correction_due_ = false;  // in this substep
    bool is_corrected_ = false;       // in this step
    double fastest_bounce_ = 0;       // m/s, of this step
    Column<Real> before_bounce_;      // velocity records; only with the ledger
    double gravity_work_ = 0;         // J, of this step, on velocities; only with the ledger
};

extern template class SoftSolver<float>;
extern template class SoftSolver<double>;

}  // namespace carom
