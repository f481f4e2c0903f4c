#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace carom {

/// Time spent in one stage of the step since the world was made.
struct StageTime {
    std::string_view name;
    std::int64_t calls = 0;
    double seconds = 0;
};

/// What a world has done since it was made. Counting costs below 1 % of a step.
struct Profile {
    /// Those that have run so far, in the order of the step: one may stand elsewhere in a later profile.
    std::vector<StageTime> stages;
    std::int64_t steps = 0;
    std::int64_t rebuilds = 0;         ///< times that the candidate pairs were found anew
    std::int64_t candidate_pairs = 0;  ///< now
    std::int64_t pair_tests = 0;       ///< pairs looked at; counted by solver `event` alone
    std::int64_t impacts = 0;          ///< collisions resolved, walls included
    std::int64_t wall_impacts = 0;
    std::int64_t simultaneous_impacts = 0;  ///< of these, solved together with others at the same instant
    std::int64_t resting_contacts = 0;      ///< in the last step
    std::int64_t contacts = 0;              ///< that could touch in the last step (solver `soft`)
    std::int64_t colours = 0;               ///< groups of contacts that share no body (solver `soft`)
    std::int64_t overflow = 0;              ///< contacts that found no colour and are solved one by one
    std::int64_t path_solves = 0;           ///< times that contacts of shapes were solved along paths
    std::int64_t path_cuts = 0;             ///< steps that cut contacts of shapes into paths anew
    std::int64_t bounces = 0;               ///< impacts with restitution (solver `soft`)
    std::int64_t touching = 0;  ///< contacts that push in the last step (solver `impulse`: that are at rest)
    /// m/s, what another sweep would still change in the relative normal velocities of contacts that push:
    /// root mean square and largest, at the end of the last step. Zero for solvers that converge.
    double residual = 0;
    double residual_max = 0;
    std::int64_t overlaps_corrected = 0;  ///< pairs or walls pushed apart
    std::int64_t unresolved_impacts = 0;  ///< left to the next step at the limit of impacts a body and step
    std::int64_t asleep = 0;              ///< bodies that sleep now
    std::int64_t islands_asleep = 0;      ///< the islands they are
    std::int64_t islands_woken = 0;       ///< ever
    std::int64_t quarantined = 0;         ///< bodies disabled because their state left the limits
    std::size_t bytes = 0;                ///< memory the world holds now
};

/// One effect, and why it is on or off.
struct EffectReport {
    std::string name;
    bool on = false;
    std::string reason;
};

/// One stage of the step as planned.
struct StageReport {
    std::string name;
    std::string kernel;  ///< the variant chosen
    std::string reads;
    std::string writes;
};

struct ColumnReport {
    std::string name;
    std::string unit;
    std::size_t bytes_per_body = 0;
};

/// What a world runs and why: `carom explain` prints it.
struct Plan {
    std::string solver;
    std::string solver_reason;
    int substeps = 1;
    int iterations = 1;  ///< sweeps over the contacts a substep (solver `soft`); 1: the solver does none
    std::string joints;  ///< how they are solved, and how many in which way; empty without joints
    std::string precision;
    std::string isa;
    int threads = 1;
    std::vector<EffectReport> effects;
    std::vector<StageReport> stages;
    std::vector<ColumnReport> columns;
    std::size_t bytes_per_body = 0;  ///< the columns' sum; scratch memory is in Profile::bytes
    /// Distinct geometries that bodies share: 0 where all are discs, segments and chains.
    std::size_t shapes = 0;
    std::size_t bytes_per_shape = 0;
    /// Where the precision ends as the bodies are now, and the remedy, in words; empty where it does not
    /// matter.
    std::vector<std::string> limits;
};

}  // namespace carom
