#pragma once

#include <cstdint>

#include "constraints/contact_rows.hpp"
#include "solvers/substeps/body_records.hpp"

namespace carom {

/// How well the last step's contacts were solved.
struct SolveQuality {
    std::int64_t touching = 0;  ///< contacts that push
    double residual = 0;      ///< m/s, root mean square over contacts that push, or would after a sweep more
    double residual_max = 0;  ///< m/s
};

/// Looks at the contacts of the last step again: what one more sweep would change in the relative normal
/// velocity of each, on its own, with the velocities at the end of the step. Impacts are no contacts.
/// Cost: O(contacts), and nothing in the step itself.
template <class Real>
SolveQuality quality_of(const ContactRows<Real>& pairs, const ContactRows<Real>& supports,
                        const BodyRecords<Real>& records);

}  // namespace carom
