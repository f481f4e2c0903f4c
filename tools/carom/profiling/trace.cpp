#include "profiling/trace.hpp"

#include "measure/stage_times.hpp"

namespace carom::tool {
namespace {

constexpr double kMicro = 1e6;

}  // namespace

void Trace::add_event(std::string_view name, double start, double seconds, measure::Json arguments) {
    events_.push_back({{"name", name},
                       {"ph", "X"},
                       {"pid", 1},
                       {"tid", 1},
                       {"ts", kMicro * start},
                       {"dur", kMicro * seconds},
                       {"args", std::move(arguments)}});
}

void Trace::add_step(const Profile& before, const Profile& after) {
    if (steps_ == kMostSteps) return;
    ++steps_;
    const double start = time_;
    const std::size_t step_event = events_.size();
    add_event("step", start, 0,
              {{"step", after.steps},
               {"impacts", after.impacts - before.impacts},
               {"candidate_pairs", after.candidate_pairs},
               {"rebuilt", after.rebuilds > before.rebuilds}});
    for (const StageTime& stage : measure::stage_times_between(before, after)) {
        add_event(stage.name, time_, stage.seconds, {{"calls", stage.calls}});
        time_ += stage.seconds;
    }
    events_[step_event]["dur"] = kMicro * (time_ - start);
}

std::string Trace::text(const std::string& scene) const {
    measure::Json json{{"displayTimeUnit", "ns"}, {"traceEvents", events_}};
    json["traceEvents"].push_back(
        {{"name", "process_name"}, {"ph", "M"}, {"pid", 1}, {"args", {{"name", scene}}}});
    return json.dump(-1, ' ', false, measure::Json::error_handler_t::replace) + "\n";
}

}  // namespace carom::tool
