#pragma once

#include "isa/kernel_table.hpp"
#include "kernels/broadphase/find_bounds.hpp"
#include "kernels/broadphase/find_candidates.hpp"
#include "kernels/broadphase/find_cells.hpp"
#include "kernels/broadphase/find_near.hpp"
#include "kernels/contacts/advance_bodies.hpp"
#include "kernels/contacts/coarse_correction.hpp"
#include "kernels/contacts/find_contacts.hpp"
#include "kernels/contacts/find_deep.hpp"
#include "kernels/contacts/measure_gain.hpp"
#include "kernels/contacts/solve_contacts.hpp"
#include "kernels/contacts/sum_work.hpp"
#include "kernels/contacts/take_means.hpp"
#include "kernels/flight/begin_flight.hpp"
#include "kernels/flight/end_flight.hpp"
#include "kernels/flight/find_impacts.hpp"
#include "kernels/joints/begin_bundles.hpp"
#include "kernels/joints/close_bundles.hpp"
#include "kernels/joints/sweep_axles.hpp"
#include "kernels/joints/sweep_bundles.hpp"
#include "kernels/joints/sweep_drives.hpp"
#include "kernels/joints/sweep_joints.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

template <unsigned kVariant, class Real, class Isa>
constexpr ContactKernels<Real> make_contact_kernels() {
    return {
        .warm_start_pairs = &warm_start<kVariant, true, Real, Isa>,
        .warm_start_supports = &warm_start<kVariant, false, Real, Isa>,
        .first_pairs = &solve_contacts<kVariant, true, true, Real, Isa>,
        .first_supports = &solve_contacts<kVariant, true, false, Real, Isa>,
        .next_pairs = &solve_contacts<kVariant, false, true, Real, Isa>,
        .next_supports = &solve_contacts<kVariant, false, false, Real, Isa>,
        .sum_loads_pairs = &sum_loads<kVariant, true, Real, Isa>,
        .sum_loads_supports = &sum_loads<kVariant, false, Real, Isa>,
        .scale_loads_pairs = &scale_loads<kVariant, true, Real, Isa>,
        .scale_loads_supports = &scale_loads<kVariant, false, Real, Isa>,
        .keep_loads_pairs = &retain_correction<kVariant, true, Real, Isa>,
        .keep_loads_supports = &retain_correction<kVariant, false, Real, Isa>,
        // (Work asks for no masses.)
        .sum_work_pairs = &sum_work<kVariant & ~kFixedAngles, true, Real, Isa>,
        .sum_work_supports = &sum_work<kVariant & ~kFixedAngles, false, Real, Isa>,
    };
}

/// The one list of kernels, instantiated for each instruction set by its file.
template <class Real, class Isa>
constexpr KernelTable<Real> make_table(std::string_view isa, const ConvexKernels<Real>* convex) {
    return {
        .isa = isa,
        .find_bounds = &find_bounds<Real, Isa>,
        .find_cells = &find_cells<Real, Isa>,
        .find_candidates = &find_candidates<Real, Isa>,
        .find_near = &find_near<Real, Isa>,
        .begin_flight = &begin_flight<false, true, Real, Isa>,
        .begin_flight_uniform_radius = &begin_flight<true, true, Real, Isa>,
        .pack_motion = &begin_flight<false, false, Real, Isa>,
        .pack_motion_uniform_radius = &begin_flight<true, false, Real, Isa>,
        .find_impacts = &find_impacts<false, Real, Isa>,
        .find_impacts_uniform_radius = &find_impacts<true, Real, Isa>,
        .find_impacts_near = &find_impacts_near<false, Real, Isa>,
        .find_impacts_near_uniform_radius = &find_impacts_near<true, Real, Isa>,
        .end_flight = &end_flight<Real, Isa>,
        .find_contacts = &find_contacts<Real, Isa>,
        .find_deep = &find_deep<Real, Isa>,
        .contacts = {make_contact_kernels<0, Real, Isa>(), make_contact_kernels<kRough, Real, Isa>(),
                     make_contact_kernels<kRough | kFixedAngles, Real, Isa>(),
                     make_contact_kernels<kRough | kRolling, Real, Isa>(),
                     make_contact_kernels<kRough | kFixedAngles | kRolling, Real, Isa>(),
                     make_contact_kernels<kFixedAngles, Real, Isa>()},
        .joints =
            {{{&give_rods<false, Real, Isa>, &sweep_rods<false, true, Real, Isa>,
               &sweep_rods<false, false, Real, Isa>},
              {&give_rods<true, Real, Isa>, &sweep_rods<true, true, Real, Isa>,
               &sweep_rods<true, false, Real, Isa>},
              {&give_hinges<Real, Isa>, &sweep_hinges<true, Real, Isa>, &sweep_hinges<false, Real, Isa>},
              {&give_springs<Real, Isa>, &sweep_springs<true, Real, Isa>, &sweep_springs<false, Real, Isa>},
              {&give_axles<Real, Isa>, &sweep_axles<true, Real, Isa>, &sweep_axles<false, Real, Isa>},
              {&give_angles<Real, Isa>, &sweep_angles<true, Real, Isa>, &sweep_angles<false, Real, Isa>}}},
        .begin_bundles = &begin_bundles<Real, Isa>,
        .sweep_bundles = &sweep_bundles<Real, Isa>,
        .close_bundles = &close_bundles<Real, Isa>,
        .begin_substeps = {&begin_substeps<false, Real, Isa>, &begin_substeps<true, Real, Isa>},
        .advance_bodies = {&advance_bodies<false, false, Real, Isa>, &advance_bodies<true, false, Real, Isa>,
                           &advance_bodies<false, true, Real, Isa>, &advance_bodies<true, true, Real, Isa>},
        .measure_gain = {&measure_gain<false, false, Real, Isa>, &measure_gain<true, false, Real, Isa>,
                         &measure_gain<false, true, Real, Isa>, &measure_gain<true, true, Real, Isa>},
        .take_means = {&take_means<false, false, Real, Isa>, &take_means<true, false, Real, Isa>,
                       &take_means<false, true, Real, Isa>, &take_means<true, true, Real, Isa>},
        .end_substeps = {&end_substeps<false, Real, Isa>, &end_substeps<true, Real, Isa>},
        .advance_rotation = &advance_rotation<Real, Isa>,
        .convex = convex,
    };
}

template <class Isa>
constexpr KernelTables make_tables(std::string_view isa, const ConvexKernelTables& convex) {
    return {make_table<float, Isa>(isa, &convex.single_precision),
            make_table<double, Isa>(isa, &convex.double_precision)};
}

}  // namespace
}  // namespace carom
