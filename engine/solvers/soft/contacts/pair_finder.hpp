#pragma once

#include <cstdint>
#include <vector>

#include "solvers/soft/contacts/flight_frames.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/substeps/body_masses.hpp"

namespace carom {

/// Finds which of the coloured pairs can touch in a step, and where (kernels/contacts/find_contacts.hpp).
/// Masses, radii and coefficients of pairs are computed when the pairs are new.
template <class Real>
class PairFinder {
  public:
    /// Masses, shapes or rows have changed.
    void forget() { version_ = renewal_ = -1; }
    /// @param motion  [rows][4] at the start of the step, with rows for the padding of groups
    /// @param flies_together  whether bodies may be so fast together that it pays to look at them by their
    /// relative motion
    /// @return whether pairs were new. Cost: O(pairs)
    bool find(const StepView<Real>& step, const Bodies<Real>& bodies, const BodyMasses<Real>& masses,
              const Column<Real>& motion, bool flies_together);
    /// Whether some pair started the step deeper than the sweeps take away soon enough.
    bool has_deep_pairs() const { return has_deep_pairs_; }

    /// Chunks of rows in which bodies are hit in the step, not 0 for each; empty where none are.
    const std::vector<std::uint8_t>& struck_chunks() const { return has_thrown_; }

    std::size_t bytes() const {
        return frames_.bytes() + thrown_.capacity() * sizeof(Real) + has_thrown_.capacity();
    }

  private:
    bool find_thrown(const StepView<Real>& step, const FindContacts<Real>& k);
    void reach_thrown(const StepView<Real>& step, const FindContacts<Real>& k);

    FlightFrames<Real> frames_;                 // of this step
    std::int64_t version_ = -1, renewal_ = -1;  // of the graph whose pairs are described
    bool has_deep_pairs_ = false;
    // Speeds at which others throw bodies in this step [m/s], by row, and whether the rows of a chunk have
    // any; empty where nothing is hit.
    std::vector<Real> thrown_;
    std::vector<std::uint8_t> has_thrown_;
};

extern template class PairFinder<float>;
extern template class PairFinder<double>;

}  // namespace carom
