#pragma once

#include <vector>

#include "solvers/impulse/impulse_solver.hpp"
#include "solvers/shared/simulation.hpp"

namespace carom {

/// A world that solver `impulse` steps.
template <class Real>
class ImpulseSimulation : public Simulation<Real> {
  public:
    ImpulseSimulation() : Simulation<Real>(MarginRule::common) {}

    Solver solver() const override { return Solver::impulse; }
    bool has_long_loops() const override { return this->executor.is_parallel(this->world.bodies.count); }
    void forget_derived_state() override;
    void report(Profile& profile) const override;
    std::size_t bytes() const override;
    void visit_state(StateSize& archive) const override { visit_all(*this, archive); }
    void visit_state(StateWriter& archive) const override { visit_all(*this, archive); }
    void visit_state(StateReader& archive) override { visit_all(*this, archive); }

    void forget_start_of_substep() { has_start_ = false; }
    /// Keeps what a substep writes before its end, if it may be interrupted. To be called when its rows are
    /// in their order.
    void keep_start_of_substep();
    /// Gives up the present substep: the state is that of its start.
    void take_back_substep();

    struct Turn {
        Real angle, spin;  // rad, rad/s
    };

    ImpulseSolver<Real> impulse;
    /// Whether the flights of standing bodies are those of the present rows and places.
    bool knows_standing = false;
    // The lists below are those of the present substep.
    ChunkedList wall_rows;
    FoundMeetings meetings;             ///< that the solver has to look at
    std::vector<Turn> immovable_turns;  ///< kept over the turn of all others

  private:
    /// What holds at the start of the present substep; nothing if no substep has come that far.
    struct Start {
        Books books;
        std::vector<Real> angle, spin;  // rad, rad/s, [rows] or empty
    };
    Start start_;
    bool has_start_ = false;

    template <class Self, class Archive>
    static void visit_all(Self& self, Archive& archive) {
        Simulation<Real>::visit_common(self, archive);
        archive(self.impulse);
        if constexpr (!std::is_const_v<Self>) self.knows_standing = false;
    }
};

extern template class ImpulseSimulation<float>;
extern template class ImpulseSimulation<double>;

}  // namespace carom
