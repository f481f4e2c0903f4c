#pragma once

#include <carom/profile.hpp>

#include <string_view>
#include <vector>

namespace carom::measure {

/// What the stages of a world took between two of its profiles: those that ran, in the order of the later
/// one. A profile lists the stages that have run so far, so one stage may have other places in both.
std::vector<StageTime> stage_times_between(const Profile& before, const Profile& after);

/// The time of one stage [s] and its calls; zero if it is not among them.
StageTime time_of_stage(const std::vector<StageTime>& times, std::string_view name);

}  // namespace carom::measure
