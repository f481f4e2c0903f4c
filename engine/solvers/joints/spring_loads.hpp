#pragma once

#include <cstdint>
#include <vector>

#include "state/world_state.hpp"

namespace carom {

/// Finds the springs that are slow enough for a substep alone, and too stiff for it together.
///
/// Springs i with the angular frequencies w_i alone swing together with w² up to the largest eigenvalue of
/// the matrix of sqrt(k_i k_j) J_i M^-1 J_j^T, which is at most its largest sum of a row (Gershgorin). Where
/// i and j meet at a body, their entry is at most f_i f_j by Cauchy and Schwarz, where f = w sqrt(r) and r is
/// the body's share of the inverse mass of the row. So
///
///     w² <= w_i² + sum over the two bodies of f_i (sum over the other springs at the body of f_j),
///
/// which is 2 w² for masses in a line and n w² for one mass on n springs. What joints hold besides makes all
/// of this less.
///
/// What swings with n times the (w h)² of its springs has n times the alpha and gamma of their rows
/// (constraints/joints/spring_law.hpp), and is stable below n h alpha = 4 + 2 n gamma. With the load
/// L = n (w h)², and as h alpha <= (w h)² without damping, that is so for gamma >= (w h)² (L - 4) / 2 L. Rows
/// that are solved in turns leave a part of what they would do together: each is damped for all of them.
class SpringLoads {
  public:
    /// Notes the springs of the world. To be called when rows, masses or joints have changed. Cost:
    /// O(joints).
    template <class Real>
    void find(const WorldState<Real>& world);
    /// Finds those that are too stiff for substeps of h [s]. Cost: O(1) where none can be, else O(springs).
    void begin_step(double h);
    /// The least gamma of a spring's row, if all springs that meet are solved at once; 0: any.
    double least_gamma_at_once(std::size_t slot) const {
        return damping_.empty() ? 0 : damping_[slot].least_gamma_at_once;
    }
    /// Likewise, if they are solved in turns.
    double least_gamma_in_turns(std::size_t slot) const {
        return damping_.empty() ? 0 : damping_[slot].least_gamma_in_turns;
    }
    std::size_t bytes() const;

  private:
    struct Spring {
        std::uint32_t slot;
        std::int32_t row_a, row_b;  // -1: nothing moves it
        double frequency;           // rad/s, alone
        double by_a, by_b;          // rad/s: f of the formula above
    };
    struct Damping {
        double least_gamma_at_once = 0, least_gamma_in_turns = 0;
    };
    void sum_up(double most);
    double square_of(const Spring& spring) const;

    std::vector<Spring> springs_;
    std::vector<double> sums_;      // rad/s, by row: of f
    std::vector<Damping> damping_;  // by slot; empty: none is too stiff
    double largest_ = 0;            // rad²/s²: of all springs together
    std::size_t slots_ = 0;
};

}  // namespace carom
