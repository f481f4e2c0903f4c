#pragma once

#include <carom/events.hpp>
#include <carom/ledger.hpp>
#include <carom/profile.hpp>
#include <carom/scene.hpp>
#include <carom/world.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report/readers/file_checksum.hpp"
#include "simulation/contact_course.hpp"

namespace carom::tool {

/// Everything a run has to tell when it is over; summary.json and the table are made of it.
struct RunOutcome {
    std::string scene_name;
    std::size_t bodies = 0;
    std::int64_t steps = 0;  ///< taken
    std::int64_t steps_asked = 0;
    bool interrupted = false;
    bool given_up = false;  ///< a step needed more work than its solver allows
    double dt = 0;          // s
    double time = 0;        // s, simulated

    Plan plan;
    Profile profile;
    Ledger ledger;
    std::optional<Ledger> first_step;  ///< after the first one; as the books started, if no step was taken
    bool keeps_ledger = false;
    OverlapReport overlaps;
    JointErrors joints;                           ///< at the end
    std::vector<JointBreak> breaks;               ///< in the order in which they happened
    std::vector<ContactCourse::Moment> contacts;  ///< during the run
    std::vector<std::size_t> quarantined;
    std::uint64_t state_hash = 0;

    double stepping_seconds = 0;   ///< in the steps themselves
    double recording_seconds = 0;  ///< the stepping thread spent on frames and books
    double total_seconds = 0;      ///< from the start of the run to the end of the last step

    std::vector<std::string> files;
    std::optional<report::FileChecksum> trajectory;  ///< of trajectory.h5, if there is one
    std::vector<std::string> messages;               ///< what a reader of the numbers should know
};

}  // namespace carom::tool
