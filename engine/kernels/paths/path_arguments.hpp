#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/contacts/contact_arguments.hpp"

// Plain arguments of the kernels that solve the contacts of convex shapes along paths: from body to body,
// over one contact after the other. docs/decisions/0027-paths-of-contacts.md says why.

namespace carom {

/// Paths of a bundle: they share no body that moves, so each has a lane. A batch of any width is in one.
inline constexpr std::size_t kPathLanes = 16;

/// Stands for the speed of a path that did not settle: it does not rest.
inline constexpr double kUnsettled = 1e30;  // m/s

/// One contact of each path of a bundle: between the body where the path stands (the near one) and `body`
/// (the far one), where it goes on. The normal leads from the near body to the far one, the tangent is the
/// normal turned by a quarter counter-clockwise; impulses act on the far body, minus on the near one.
///
/// Levers are in rims of their body, as in effects/contact_law.hpp: r x n / rim of the contact's points,
/// r . n / rim of both. Lanes of paths that are shorter have levers and friction zero, no points, and a row
/// at rest.
template <class Real>
struct alignas(64) PathLink {
    std::int32_t body[kPathLanes];                          // row in the records
    Real normal_x[kPathLanes], normal_y[kPathLanes];        // no unit
    Real near1[kPathLanes], near2[kPathLanes];              // levers of the near body
    Real near_t[kPathLanes];                                //
    Real far1[kPathLanes], far2[kPathLanes];                // levers of the far body
    Real far_t[kPathLanes];                                 //
    Real separation1[kPathLanes], separation2[kPathLanes];  // m, at the start of the step; negative =
                                                            // overlapping, kNoPoint = there is no such point
    Real normal1[kPathLanes], normal2[kPathLanes];          // N s, of a substep, >= 0
    Real tangent[kPathLanes];                               // N s, on the far body along the tangent
    Real friction[kPathLanes];                              // Coulomb coefficient
    Real thickness[kPathLanes];                             // m, smaller inradius of the two
    Real floor1[kPathLanes], floor2[kPathLanes];            // m/s, least relative normal velocities
};

/// Calls fn(column of `from`, column of `to`) for each.
template <class Real, class Fn>
void for_each_column(const PathLink<Real>& from, PathLink<Real>& to, const Fn& fn) {
    fn(from.body, to.body), fn(from.normal_x, to.normal_x), fn(from.normal_y, to.normal_y);
    fn(from.near1, to.near1), fn(from.near2, to.near2), fn(from.near_t, to.near_t);
    fn(from.far1, to.far1), fn(from.far2, to.far2), fn(from.far_t, to.far_t);
    fn(from.separation1, to.separation1), fn(from.separation2, to.separation2);
    fn(from.normal1, to.normal1), fn(from.normal2, to.normal2), fn(from.tangent, to.tangent);
    fn(from.friction, to.friction), fn(from.thickness, to.thickness);
    fn(from.floor1, to.floor1), fn(from.floor2, to.floor2);
}

/// What the loads of contacts are corrected by: engine/solvers/contact_sets/coarse_correction.hpp.
template <class Real>
struct PathLoads {
    Real* load = nullptr;          // [rows][4], kernels/contacts/coarse_correction.hpp
    Real* stress = nullptr;        // [rows][4], likewise
    const Real* scale = nullptr;   // [rows], s; zero for what is no body
    const Real* motion = nullptr;  // [rows][4]: x, y [m] in the first two
    std::int32_t last_row = 0;     // of `motion`
    Real kept = 0;                 // share of what scaling added
    bool is_beside = false;        // the bundles are of contacts beside the paths, which may share bodies
};

/// Bodies that impulses have thrown: solvers/paths/warm_start_limit.hpp. Columns by row.
template <class Real>
struct FindThrown {
    const Real* velocity;      // [rows][4], kernels/contacts/contact_arguments.hpp
    StartColumns<Real> start;  // m/s, of before
    const Real* inradius;      // m; null where one value serves all
    Real uniform_inradius;     // m
    const Real* joined;        // above zero where joints hold a body, which is never thrown; null: none does
    Real times, fall;          // as fast as it was and m/s, so many times as much is thrown,
    Real none;                 // 1/s, if it is more than this in inradii
    std::uint8_t* is_thrown;   // out
};

/// Paths of contacts, a bundle after the other.
template <class Real>
struct SolvePaths {
    PathLink<Real>* links;          // of bundle i: first_link[i] ... first_link[i + 1]
    const std::size_t* first_link;  //
    const std::int32_t* heads;      // [bundles][kPathLanes]: rows where the paths begin
    Real* velocity;                 // [rows][4], kernels/contacts/contact_arguments.hpp
    Real* displacement;             // [rows][2], m, since the start of the step
    Real* turn;                     // [rows], m, rim displacement since the start of the step
    const Real* come;               // [rows][2], m, in the step before, for carry_paths
    const Real* turned;             // [rows], m, rim displacement in the step before, likewise
    Real h;                         // s, of the substep
    Real inverse_h;                 // 1/s
    Real recovery;                  // share of an overlap that a substep takes away, by displacement
    Real push;                      // 1/s: largest displacement of that kind in thicknesses a second
    Real slop;                      // share of the thickness by which a contact that is slow may overlap
    Real slow;                      // m/s: contacts whose points are slower than this are slow
    Real velocity_tolerance;        // m/s, by which a contact may miss its law
    Real fall;                      // m/s, what gravity adds to a velocity in a substep
    Real* restless;                 // [bundles][kPathLanes], m/s: the largest relative speed that each path
                                    // had when it was solved last, where bodies thinner than
                                    // resting_thickness count as faster in proportion; kUnsettled if it
                                    // did not settle
    const std::uint8_t*
        is_slender;           // [bundles]: not 0 = of paths that alone hold their bodies, never left out
    Real resting_speed;       // m/s: bundles of which no path is more restless are left out
    Real resting_thickness;   // m
    int bold_iterations;      // that change all rows of the active set that are wrong; the others
                              // change the worst alone
    int most_iterations;      // of the active set
    int most_of_slender;      // likewise, of bundles that are slender
    bool tries_pieces;        // whether paths that do not settle as a whole are solved in pieces
    int sweeps_of_unsettled;  // over paths that do not settle so either
    PathLoads<Real> coarse;   // for the kernels of path_loads.hpp alone
    std::uint32_t* closing;   // [bundles]: of contacts beside the paths, a bit for each lane that closes
    Real fast, light_press;   // for find_fast: m/s; share of the impulse that would stop both bodies
    std::uint32_t* is_fast;   // [links], likewise, out: a bit for each lane that may come faster and meet
    void* scratch;            // of path_scratch_bytes(longest bundle) bytes, aligned to 64
    Real surely_fast;         // for find_fast: m/s, what is faster comes fast whatever joints do
    const Real* foreseen;     // [rows][4], likewise: velocities at the end of the substep
    std::uint32_t* comes;     // [links], likewise, out: a bit for each lane that comes so, but does not meet
};

/// Bytes that a link needs while its path is solved, in the widest batch.
inline constexpr std::size_t kPathScratchBytes = 64 * 56;
/// The same for a path, and room for it among those that do not settle (kernels/paths/unsettled_paths.hpp).
inline constexpr std::size_t path_scratch_bytes(std::size_t longest) {
    return (longest + 1) * (kPathScratchBytes + sizeof(PathLink<double>));
}

/// What the kernel met.
struct PathCounts {
    std::size_t unsettled = 0;  // lanes
    std::size_t closing = 0;    // contacts beside the paths
};

}  // namespace carom
