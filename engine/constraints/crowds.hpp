#pragma once

#include <cstdint>
#include <vector>

#include "broadphase/candidates.hpp"
#include "state/bodies.hpp"

namespace carom {

/// Heaps of very many bodies in one place. In a crowd each body needs only some of the others to be pushed
/// out of it: of pairs that overlap deeply a share is looked at, another one whenever pairs are found anew.
/// What merely touches is always looked at.
template <class Real>
class Crowds {
  public:
    void clear() { candidates_of_.clear(); }
    /// Counts the candidates of each disc, if they are many.
    void find(const Candidates<Real>& candidates, const Bodies<Real>& bodies);
    /// Whether no body has so many that pairs are left out.
    bool empty() const { return candidates_of_.empty(); }
    /// Whether a pair is left out, where some are.
    /// @param draw  another share is left out for another number
    bool leave_out(std::int32_t a, std::int32_t b, const Bodies<Real>& bodies, std::int64_t draw) const;

    std::size_t bytes() const { return candidates_of_.capacity() * sizeof(std::uint32_t); }

  private:
    std::vector<std::uint32_t> candidates_of_;  // a row
};

extern template class Crowds<float>;
extern template class Crowds<double>;

}  // namespace carom
