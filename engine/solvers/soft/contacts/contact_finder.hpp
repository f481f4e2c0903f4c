#pragma once

#include "solvers/soft/contacts/pair_finder.hpp"
#include "solvers/soft/contacts/support_finder.hpp"

namespace carom {

/// Finds which contacts of discs can touch in a step, and where.
template <class Real>
struct ContactFinder {
    PairFinder<Real> pairs;
    SupportFinder<Real> supports;

    std::size_t bytes() const { return pairs.bytes() + supports.bytes(); }
};

}  // namespace carom
