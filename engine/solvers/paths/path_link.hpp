#pragma once

#include <cstdint>

#include "kernels/paths/path_arguments.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/substeps/body_records.hpp"
#include "state/bodies.hpp"

namespace carom {

/// A contact's place in the links of paths.
template <class Real>
struct LinkPlace {
    PathLink<Real>& link;
    std::size_t lane;
    bool is_reversed;      ///< the path goes from b to a
    std::int32_t far_row;  ///< of b in the records

    /// Writes the body that the path comes to with this contact, which is where the next one begins.
    void write_body(const ManifoldList<Real>& list, std::size_t i) const {
        link.body[lane] = is_reversed ? list.a[i] : far_row;
    }
};

/// Writes a contact, as it was found or as it is carried on, where the kernels look for it. Two points that
/// no impulse can tell apart become one, in the list as well; impulses along another normal are forgotten.
/// @param found  whether separations are those of the list; else those that its memory has
template <class Real>
void write_link(const LinkPlace<Real>& to, ManifoldList<Real>& list, std::size_t i, bool found,
                const Bodies<Real>& bodies, const BodyRecords<Real>& records);

/// Gives the bodies of a contact its impulses, times `sign`.
/// @param near, far  rows of its bodies in the records
template <class Real>
void give_impulses(const PathLink<Real>& link, std::size_t lane, std::size_t near, std::size_t far, Real sign,
                   Column<Real>& velocity);

}  // namespace carom
