#pragma once

#include "isa/convex_kernels.hpp"
#include "kernels/broadphase/broadphase_arguments.hpp"
#include "kernels/contacts/contact_arguments.hpp"
#include "kernels/flight/flight_arguments.hpp"
#include "kernels/joints/joint_arguments.hpp"

#include <array>
#include <string_view>

namespace carom {

/// The contact kernels with some effects compiled in.
template <class Real>
struct ContactKernels {
    using Solve = void (*)(const SolveContacts<Real>&, std::size_t first, std::size_t last);
    Solve warm_start_pairs, warm_start_supports;
    Solve first_pairs, first_supports;
    Solve next_pairs, next_supports;
    Solve sum_loads_pairs, sum_loads_supports;
    Solve scale_loads_pairs, scale_loads_supports;
    Solve keep_loads_pairs, keep_loads_supports;
    using SumWork = void (*)(const SolveContacts<Real>&, std::size_t first, std::size_t last, WorkSums&);
    SumWork sum_work_pairs, sum_work_supports;
};

/// The sweeps over one kind of joints: one that gives impulses at the start of a step, the first of a
/// substep, and the others.
template <class Real>
struct JointKernels {
    using Sweep = void (*)(const SweepJoints<Real>&, std::size_t first, std::size_t last);
    Sweep give, first, next;
};

/// The kernels of one instruction set in one precision. A new kernel: an argument struct in kernels/, a line
/// here, a line in make_table.hpp.
template <class Real>
struct KernelTable {
    std::string_view isa;  // "scalar", "sse2", "avx2", "avx512": the value CAROM_ISA takes
    void (*find_bounds)(FindBounds<Real>&);
    void (*find_cells)(const FindCells<Real>&);
    std::size_t (*find_candidates)(FindCandidates<Real>&);
    std::size_t (*find_near)(const GridLevel<Real>&, const FindNear<Real>&);

    FlightCounts<Real> (*begin_flight)(const BeginFlight<Real>&, std::size_t first, std::size_t last);
    FlightCounts<Real> (*begin_flight_uniform_radius)(const BeginFlight<Real>&, std::size_t first,
                                                      std::size_t last);
    // The same without a list of rows near walls.
    FlightCounts<Real> (*pack_motion)(const BeginFlight<Real>&, std::size_t first, std::size_t last);
    FlightCounts<Real> (*pack_motion_uniform_radius)(const BeginFlight<Real>&, std::size_t first,
                                                     std::size_t last);
    std::size_t (*find_impacts)(const FindImpacts<Real>&, std::size_t first, std::size_t last);
    std::size_t (*find_impacts_uniform_radius)(const FindImpacts<Real>&, std::size_t first, std::size_t last);
    std::size_t (*find_impacts_near)(const GridLevel<Real>&, const FindImpactsNear<Real>&);
    std::size_t (*find_impacts_near_uniform_radius)(const GridLevel<Real>&, const FindImpactsNear<Real>&);
    void (*end_flight)(const EndFlight<Real>&, std::size_t first, std::size_t last);
    std::size_t (*find_contacts)(const FindContacts<Real>&, std::size_t first, std::size_t last);
    bool (*find_deep)(const SolveContacts<Real>&, const DeepPairs<Real>&, std::size_t first,
                      std::size_t last);
    // smooth; rough; rough, and some bodies do not turn; the last two with rolling resistance; smooth, and
    // some bodies do not turn
    std::array<ContactKernels<Real>, 6> contacts;
    // rods between centres, between anchors; hinges; springs and ropes; wheels and sliders; what acts on
    // angles
    std::array<JointKernels<Real>, 6> joints;
    void (*begin_bundles)(const BeginBundles<Real>&, std::size_t first, std::size_t last);
    void (*sweep_bundles)(const SweepBundles<Real>&, std::size_t first, std::size_t last);
    std::size_t (*close_bundles)(const CloseBundles<Real>&, std::size_t first, std::size_t last);
    // These two or four: without and with rotation; then the same where bodies come to rest or have joints.
    std::array<void (*)(const BeginSubsteps<Real>&, std::size_t first, std::size_t last), 2> begin_substeps;
    std::array<void (*)(const AdvanceBodies<Real>&, std::size_t first, std::size_t last), 4> advance_bodies;
    std::array<EnergyGain (*)(const MeasureGain<Real>&, std::size_t first, std::size_t last), 4> measure_gain;
    // These four: without and with rotation; then the same with drag.
    std::array<void (*)(const TakeMeans<Real>&, std::size_t first, std::size_t last, FlightSums&), 4>
        take_means;
    std::array<std::size_t (*)(const EndSubsteps<Real>&, std::size_t first, std::size_t last), 2>
        end_substeps;
    void (*advance_rotation)(const AdvanceRotation<Real>&, std::size_t first, std::size_t last);

    const ConvexKernels<Real>* convex;
};

struct KernelTables {
    KernelTable<float> single_precision;
    KernelTable<double> double_precision;

    template <class Real>
    const KernelTable<Real>& of() const {
        if constexpr (sizeof(Real) == sizeof(float))
            return single_precision;
        else
            return double_precision;
    }
};

}  // namespace carom
