#include "measure/stage_times.hpp"

#include <algorithm>

namespace carom::measure {

std::vector<StageTime> stage_times_between(const Profile& before, const Profile& after) {
    std::vector<StageTime> between;
    for (const StageTime& stage : after.stages) {
        const StageTime first = time_of_stage(before.stages, stage.name);
        if (stage.calls > first.calls)
            between.push_back({stage.name, stage.calls - first.calls, stage.seconds - first.seconds});
    }
    return between;
}

StageTime time_of_stage(const std::vector<StageTime>& times, std::string_view name) {
    const auto found = std::find_if(times.begin(), times.end(),
                                    [name](const StageTime& stage) { return stage.name == name; });
    return found == times.end() ? StageTime{name, 0, 0} : *found;
}

}  // namespace carom::measure
