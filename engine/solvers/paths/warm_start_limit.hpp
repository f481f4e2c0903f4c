#pragma once

#include <cstdint>
#include <vector>

#include "solvers/paths/path_solver.hpp"

namespace carom {

/// Keeps the impulses that contacts of shapes begin a step with from making energy.
///
/// A body that is squeezed has impulses that are far larger than what they add up to, and do so only as long
/// as normals and levers stay as they were when they were solved. Where a squeeze turns, slips or comes free,
/// what they add up to throws the body. What a body really needs of its contacts brings it to about the
/// velocity that it had: where the impulses of the step before make one far faster than that, its contacts
/// forget theirs. docs/decisions/0040-squeezes.md.
template <class Real>
class WarmStartLimit {
  public:
    /// To be called when the bodies have been given the impulses.
    /// @param joined  [rows], above zero for bodies that have joints, which are left alone: what these give
    /// them comes later; null where there are none
    /// Cost: 1 ns a body; where there is such a body, 5 ns a contact a round.
    void apply(PathSolver<Real>& paths, const Bodies<Real>& bodies, const SubstepTerms& terms,
               BodyRecords<Real>& records, const Real* joined, const StepLoops<Real>& loops);

    std::size_t bytes() const { return is_thrown_.capacity() + has_thrown_.capacity(); }

  private:
    std::vector<std::uint8_t> is_thrown_;   // [rows]
    std::vector<std::uint8_t> has_thrown_;  // by chunk of rows
};

extern template class WarmStartLimit<float>;
extern template class WarmStartLimit<double>;

}  // namespace carom
