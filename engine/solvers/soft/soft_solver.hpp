#pragma once

#include <carom/ledger.hpp>

#include <vector>

#include "constraints/contact_graph.hpp"
#include "constraints/contact_rows.hpp"
#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/books.hpp"
#include "solvers/soft/contact_gains.hpp"
#include "solvers/soft/contacts/contact_finder.hpp"
#include "solvers/soft/contacts/contact_settings.hpp"
#include "solvers/soft/contacts/contact_sweeps.hpp"
#include "solvers/soft/contacts/residual.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/soft/contacts/warm_start.hpp"
#include "solvers/soft/corrections/contact_corrections.hpp"
#include "solvers/soft/impacts/impacts.hpp"
#include "solvers/soft/joints/heavy_loads.hpp"
#include "solvers/soft/joints/soft_joints.hpp"
#include "solvers/soft/passive_substeps.hpp"
#include "solvers/soft/project_positions.hpp"
#include "solvers/substeps/body_masses.hpp"
#include "solvers/substeps/body_records.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What the soft solver counts (the docstrings of Profile say what each means).
struct SoftCounters {
    std::int64_t contacts = 0;  ///< in the last step
    std::int64_t colours = 0;
    std::int64_t overflow = 0;
    std::int64_t uneven_sweeps = 0;  ///< over contacts of uneven masses, beside those that all contacts get
};

/// Solver `soft`: contacts at rest, with friction and rotation.
///
/// A step finds the contacts once and is then cut into substeps. In each, two Gauss-Seidel sweeps over the
/// coloured contacts bring the velocities to what the contact laws allow; the first also takes away a share
/// of every overlap, by displacement, never by velocity. Contacts keep their impulses from substep to substep
/// and from step to step (warm start), which is what carries a pile. What comes fast and has restitution is
/// no contact but an impact, which is carried out at its own time in the substep (impacts.hpp).
///
/// The class owns the parts and the order of what they do within a stage; each part has a header of its own.
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
    PathSolver<Real> paths;  ///< contacts of shapes that are no discs
    SoftJoints<Real> joints;
    SoftCounters counters;
    /// Sweeps over the contacts a substep, >= 1: a first one and next ones. With 1 the first is not
    /// over-relaxed and loads are not corrected on the coarse grid; with more than 2 no contact is left out.
    /// Not set: as many as suit the world.
    std::optional<int> asked_iterations;
    int iterations(const WorldState<Real>& world) const {
        return asked_iterations.value_or(is_smooth_heap(world) ? kIterationsOfSmoothHeap
                                                               : kDefaultIterations);
    }

    /// Reads what holds for the step; velocity records of all bodies at its start.
    /// @param h  s, a substep of the present flight
    void begin_substeps(const WorldState<Real>& world, const Column<Real>& motion, const StepFlights& flights,
                        double h, const Vec2 gravity, const KernelTable<Real>& kernels,
                        const Executor& executor);
    /// Contacts that can touch in this step, by colour.
    /// @param motion  [rows][4] at the start of the step; gets rows for the padding of groups
    /// @param flies_together  whether a good part of the bodies are fast together
    /// @param longest_substep  s, that gravity allows; 0: any
    void find_contacts(WorldState<Real>& world, const EdgeCandidates<Real>& edges, Column<Real>& motion,
                       bool flies_together, double longest_substep);
    /// Finds the contacts of shapes and lays them out along paths.
    void find_manifolds(const WorldState<Real>& world, const EdgeCandidates<Real>& edges);
    /// Tells what bounces from what rests (impacts.hpp).
    void mark_impacts(const WorldState<Real>& world, const Candidates<Real>& neighbours);
    /// Whether bodies are gone on which others rested.
    bool has_lost_loads() const { return !graph.lost.empty(); }
    /// Spreads what they carried over other contacts.
    void rebalance_loads(const Bodies<Real>& bodies) { warm_start_.rebalance(view(), bodies); }
    /// Tells that a body was removed or put elsewhere between steps. @param mass  kg
    void note_lost(double mass) { corrections_.shape_turns.note_lost(mass); }
    /// Gives the bodies last step's impulses.
    void warm_start();

    /// Gives bodies last step's impulses of shapes, as far as these make no energy.
    void warm_start_paths(const WorldState<Real>& world) {
        paths.warm_start(terms_, records_, loops_);
        warm_start_.limit_paths(paths, world.bodies, terms_, records_,
                                world.joints.empty() ? nullptr : joints.joined(), loops_);
    }
    /// Carries out the impacts of shapes in a substep.
    void carry_out_shape_impacts(const Bodies<Real>& bodies, Books& books) {
        paths.counters.impacts += impacts.shapes.carry_out(paths, terms_, bodies, records_, loops_,
                                                           impacts.held, books, books_.gravity_work);
        impacts.note_deflected(records_.velocity);
    }
    /// Solves the contacts of shapes in substep `number`.
    void solve_paths(int number, bool is_last);
    /// Both sweeps of substep `number`, or the first alone if correct_loads is due. The second leaves out
    /// what is calm, but not in the last substep.
    void solve_contacts(int number, bool is_last);
    /// Corrects the loads of large piles between the sweeps of the last substep, if that is due, and sweeps
    /// once more.
    void correct_loads(const StepFlight<Real>& flight) {
        corrections_.loads.correct(view(), flight, sweeps_, paths);
    }
    /// Whether some discs stand in columns.
    bool has_chains() const { return !corrections_.chains.empty(); }
    /// Solves what the sweeps leave in columns of discs.
    void solve_chains() { corrections_.chains.solve(view()); }
    /// Whether some bodies are between supports that face each other.
    bool has_wedged_bodies() const { return !corrections_.wedged.empty(); }
    /// Solves what the sweeps leave of their supports.
    void solve_wedged_bodies();
    /// Solves what the sweeps leave where masses are uneven; nothing where they are not.
    void solve_uneven_contacts(bool is_last);
    /// Whether something may be hit in this step.
    bool expects_hits() const { return corrections_.deep.expects_hits(); }
    /// Sweeps on where something was hit and would come deep into its neighbours.
    void solve_deep_contacts() { corrections_.deep.solve(view(), sweeps_); }
    /// What the impulses of this substep did; only the walls' impulses if the ledger is closed.
    void book_substep(WorldState<Real>& world, Books& books) {
        const double before = books.restitution + books.friction;
        books_.book_substep(view(), world, books);
        books_.book_paths(paths, records_, books, *loops_.executor);
        if (!world.joints.empty()) share_with_joints(world, books, before);
    }
    /// Carries out the impacts of a substep.
    void carry_out_impacts(const WorldState<Real>& world, const Column<Real>& motion, Books& books,
                           Interruption& interruption);
    /// Whether impacts have left contacts closing that hold, in a world whose crowds are settled.
    bool has_struck_contacts(const WorldState<Real>& world) const {
        return impacts.left_closing.any() && settles_crowds(world);
    }
    /// Sweeps once more over what impacts have left closing.
    void settle_struck_contacts(const WorldState<Real>& world, const Column<Real>& motion, Books& books);
    /// Moves the bodies through substep `number`, which was solved.
    void advance_bodies(int number, bool is_last, bool has_joints) {
        // Where there are impacts, what was taken is given back before them.
        if (gains_.has_taken()) gains_.give_back(view());
        paths.advance(terms_, records_);
        records_.advance(is_last, terms_, loops_, has_joints ? joints.joined() : nullptr);
        terms_.elapsed = (number + 1) * terms_.substep_dt;
    }

    // Joints: solvers/soft/joints/.

    void begin_joints(WorldState<Real>& world, const StepFlights& flights) {
        joints.begin_step(joint_step(world), view(), paths, flights);
        paths.pushes_twice = sweeps_turns();
        impacts.held.begin_joints(joints);
        heavy_.find(held_contacts(), joint_step(world), joints);
    }
    void solve_joints(WorldState<Real>& world, int number) {
        heavy_.tell(held_contacts(), joint_step(world), joints);
        joints.solve(joint_step(world), loops_, number);
        joints.forget_blows(joint_step(world), view(), paths);
        heavy_.begin_substep(joint_step(world), joints);
    }
    /// Contacts and joints in turns, where they bear on each other.
    void solve_joints_and_contacts(WorldState<Real>& world);
    /// Scales what joints and contacts gave where that made energy, and solves them once more, in turns; of
    /// discs that bounce, whatever energy they gave.
    void bound_energy(WorldState<Real>& world);
    /// Whether contacts are kept from doing work in this step: where several discs bounce.
    bool takes_gains() const { return takes_gains_; }
    void end_joints_of_substep(WorldState<Real>& world, Books& books) {
        const double before = books.joints;
        joints.end_substep(joint_step(world), books);
        books_.work_of_joints = books.joints - before;
    }
    /// @return whether a joint broke
    bool end_joints(WorldState<Real>& world, Books& books, const StepFlights& flights) {
        return joints.end_step(joint_step(world), view(), paths, books, flights);
    }

    /// The impulses back to the candidates.
    void end_contacts();
    /// Parts bodies that have ended the step deep in others, by displacement alone.
    void project_positions(const WorldState<Real>& world, const StepFlight<Real>& flight) {
        projection_.project(view(), world, flight, finder_.pairs.has_deep_pairs());
    }
    /// Columns from records.
    /// @param lost_rows  room for `lost` by chunk
    /// @param lost  rows whose state left the limits; they stand still where they were
    void end_substeps(Bodies<Real>& bodies, ChunkedList& lost_rows, std::vector<std::int32_t>& lost) {
        records_.end(bodies, lost_rows, lost, loops_);
    }
    /// What the pushes of this step did against gravity, and what the overlaps were worth.
    void book_displacements(const WorldState<Real>& world, const Column<Real>& motion, Books& books) {
        books_.book_displacements(records_.count(), world, motion, books);
        books_.book_overlaps(view(), paths, world, books);
    }

    /// Forgets what was not booked yet of a step that is given up.
    void drop_books() { books_.gravity_work = 0; }

    /// Masses, shapes or rows have changed: what was derived from them is made anew.
    void forget_rows() { masses_.forget(), joints.forget(); }
    /// Whether nothing of that has changed since the last step.
    bool knows_rows() const { return masses_.are_known(); }
    /// Rows have changed, and the graph has followed them.
    void follow_rows() { masses_.follow_rows(), paths.turns.forget(); }

    /// Nothing can touch any more.
    void drop_contacts() {
        graph.pairs = {}, graph.supports = {}, graph.lost.clear(), supports_ = {}, corrections_.deep.clear();
    }

    const BodyRecords<Real>& records() const { return records_; }
    /// How well the last step's contacts were solved. Cost: O(contacts).
    SolveQuality quality() const { return quality_of(graph.pairs, supports_, records_); }
    /// Length of the substep that the impulses of contacts belong to [s].
    double substep_of_impulses() const { return warm_start_.substep_dt(); }
    /// How loops over bodies are cut: a thread then gets the bodies that it has in its cache from the sweeps.
    std::size_t rows_per_task() const;
    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        // Contacts that were found, and what was listed of them, are of another world, which may have none.
        if constexpr (!std::is_const_v<Self>) self.supports_ = {}, self.corrections_ = {};
        archive(self.graph, self.paths, self.counters, self.impacts.counters, self.warm_start_,
                self.corrections_, self.joints);
        if constexpr (!std::is_const_v<Self>)
            self.forget_rows(), self.records_.forget(), self.impacts.forget();
    }

  private:
    using Sweeps = ContactSweeps<Real>;
    bool is_crowd_in_touch(const WorldState<Real>& world) const;
    /// Not where masses differ much, for sweeps would undo what corrections of uneven ones do, nor where
    /// there are contacts or joints that these sweeps do not know: docs/decisions/0093-crowds-that-bounce.md.
    bool settles_crowds(const WorldState<Real>& world) const;
    /// Whether there is nothing but discs that move, and walls: of even masses these gain too little to be
    /// solved anew.
    static bool is_crowd_of_discs(const WorldState<Real>& world) {
        return !world.bodies.has_shapes && world.joints.empty() && world.immovable_rows.empty();
    }
    void share_with_joints(WorldState<Real>& world, Books& books, double before);
    bool solve_turn(WorldState<Real>& world, double settled, bool is_again, bool sweeps);
    /// Whether turns of joints and contacts sweep over contacts of shapes in place of solving them: where
    /// free mechanisms are swept, too, and where contacts are so many that paths are short; not beside a
    /// group that is solved exactly, unless contacts come and go.
    /// docs/decisions/0090-crowds-of-mechanisms.md, 0091-wild-and-restless-crowds.md,
    /// 0104-what-rests-takes-no-time.md.
    bool sweeps_turns() const {
        return joints.touches() && (joints.has_free_crowd() || paths.manifolds.is_crowd()) &&
               (!joints.touches_exactly() || paths.is_wild_crowd());
    }
    JointStep<Real> joint_step(WorldState<Real>& world) {
        return {world, records_, terms_, books_.gravity_work, joints.springs()};
    }
    HeldContacts<Real> held_contacts() { return {view(), paths}; }
    StepView<Real> view() { return {graph, supports_, records_, settings_, terms_, loops_}; }

    // What holds for the present step.
    bool bounces_ = false, takes_gains_ = false;
    StepLoops<Real> loops_;
    SubstepTerms terms_;
    ContactSettings settings_;

    BodyMasses<Real> masses_;
    BodyRecords<Real> records_;
    ContactRows<Real> supports_;  // those of graph.supports that can touch in this step
    ContactFinder<Real> finder_;
    WarmStart<Real> warm_start_;
    ContactSweeps<Real> sweeps_;
    ContactCorrections<Real> corrections_;
    EndProjection<Real> projection_;
    HeavyLoads<Real> heavy_;
    PassiveSubsteps<Real> passive_;
    ContactGains<Real> gains_;
    SubstepBooks<Real> books_;
};

extern template class SoftSolver<float>;
extern template class SoftSolver<double>;

}  // namespace carom
