#pragma once

#include <type_traits>

#include "broadphase/edge_candidates.hpp"
#include "sleeping/sleepers.hpp"
#include "solvers/shared/simulation.hpp"
#include "solvers/soft/impacts/shape_tunnelling.hpp"
#include "solvers/soft/impacts/tunnelling.hpp"
#include "solvers/soft/soft_solver.hpp"
#include "solvers/substeps/step_flights.hpp"

namespace carom {

/// A world that solver `soft` steps: a step is a flight for the broadphase, or several, each cut into
/// substeps for the contacts.
template <class Real>
class SoftSimulation : public Simulation<Real> {
  public:
    SoftSimulation() : Simulation<Real>(MarginRule::own) {}

    Solver solver() const override { return soft.joints.is_rattle ? Solver::rattle : Solver::soft; }
    /// Whether contacts are looked for: under `rattle` never.
    bool can_touch() const { return !soft.joints.is_rattle && this->can_meet(); }
    bool has_long_loops() const override {
        return soft.graph.groups.chunks > 1 || soft.paths.has_long_loops() || soft.joints.has_long_loops();
    }
    void forget_derived_state() override;
    void remove(std::size_t row) override;
    void note_added(std::size_t row) override;
    void note_velocity(std::size_t) override {}  // each step looks at the motion anew
    void note_place_before(std::size_t row) override;
    void note_place(std::size_t row) override;
    std::uint32_t kinds_of_columns() const;
    /// Whether bodies came, went or were put elsewhere since the last step.
    bool has_changes() const { return changes_ > 0; }
    /// Follows them without making the candidate pairs void, where that is possible.
    void follow_changes();
    /// Where nothing can touch, contacts are not kept up to date: those of bodies that are gone must not be
    /// looked at.
    void drop_contacts() {
        if (graph_of_rebuild < 0) return;
        soft.drop_contacts();
        graph_of_rebuild = -1;
    }
    void wake_at(Vec2 place, double reach) override;
    void wake_all() override;
    std::size_t wake_body(std::size_t row) override;
    void set_iterations(std::optional<int> wanted) override { soft.asked_iterations = wanted; }
    int iterations() const override { return soft.iterations(this->world); }
    void report(Profile& profile) const override;
    std::size_t bytes() const override;
    void visit_state(StateSize& archive) const override { visit_all(*this, archive); }
    void visit_state(StateWriter& archive) const override { visit_all(*this, archive); }
    void visit_state(StateReader& archive) override { visit_all(*this, archive); }

    /// Substeps that joints call for where a scene asks for no number: nets of rods and hinges are swept, and
    /// stretch less the more there are (docs/decisions/0026-joints.md).
    int substeps_for_joints() const override {
        if (this->has_asked_for_substeps || this->world.joints.empty()) return 1;
        soft.joints.find_groups(this->world);
        return soft.joints.has_nets() ? SweptJoints<Real>::kSubsteps : 1;
    }

    std::string describe_joints() const override {
        if (this->world.joints.empty()) return {};
        soft.joints.find_groups(this->world);
        return soft.joints.describe();
    }

    /// Length and substeps of the present flight.
    void set_flight();
    /// Halves the present flight where it would make too many pairs; it then begins anew.
    /// @return whether it did
    bool shorten_flight();
    /// Cuts a step of dt [s] into as many flights as the one before, or half as many where those made few
    /// pairs.
    void begin_flights(double dt);

    /// Keeps what a flight writes before its end, if it may be interrupted: the books alone.
    void keep_start_of_flight() {
        if (this->interruption.question()) start_books_ = this->world.books;
    }
    /// Gives up the present flight: the state is that of its start.
    void take_back_flight();

    /// Where bodies began the present flight.
    StepFlight<Real> flight() const {
        return {motion, this->candidates, edge_candidates, this->flight_dt, this->fastest};
    }

    EdgeCandidates<Real> edge_candidates;
    mutable SoftSolver<Real> soft;  // finds groups of joints when asked for a plan
    Tunnelling<Real> tunnelling;
    ShapeTunnelling<Real> shape_tunnelling;
    Sleepers<Real> sleepers;
    StepFlights flights;
    std::int64_t graph_of_rebuild = -1;  ///< which candidate pairs the contact graph was made of
    std::uint32_t kinds_of_graph = 0;    ///< what columns of contacts it was described with
    // These members hold for the present flight alone.
    Column<Real> motion;  ///< [rows][4]: x, y [m], vx, vy [m/s] of each body at its start
    int substep = 0, substep_count = 1;
    double substep_dt = 0;       ///< s
    double longest_substep = 0;  ///< s, that gravity allows; 0: any

  private:
    double rate_against_gravity() const;
    int substeps_for_speed(double dt) const;
    void note_change(bool may_follow);
    bool can_follow(std::size_t row) const;
    void note_leaving(std::size_t row);

    Books start_books_;  // of the present flight
    // Changes since the last step.
    std::uint64_t changes_ = 0;
    std::vector<BodyId> elsewhere_;           // bodies that were put elsewhere
    std::vector<std::uint8_t> is_elsewhere_;  // a row

    template <class Self, class Archive>
    static void visit_all(Self& self, Archive& archive) {
        Simulation<Real>::visit_common(self, archive);
        // It is mutable for plans; a state that is saved forgets nothing of it.
        std::conditional_t<std::is_const_v<Self>, const SoftSolver<Real>, SoftSolver<Real>>& solver =
            self.soft;
        archive(self.edge_candidates, solver, self.sleepers, self.graph_of_rebuild);
        archive(self.kinds_of_graph, self.changes_, self.elsewhere_, self.flights);
        if constexpr (!std::is_const_v<Self>) self.sleepers.use(*self.kernels);
    }
};

extern template class SoftSimulation<float>;
extern template class SoftSimulation<double>;

}  // namespace carom
