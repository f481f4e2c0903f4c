#include "profiling/profile_run.hpp"

#include <algorithm>

#include "measure/ceilings.hpp"
#include "measure/clocks.hpp"
#include "measure/limits.hpp"
#include "measure/machine.hpp"
#include "measure/stage_times.hpp"
#include "measure/stage_work.hpp"
#include "profiling/shared_loops.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/progress_bar.hpp"

namespace carom::tool {
namespace {

using Json = measure::Json;

// The first steps find the first pairs, sort and allocate: they are not those of a run in its stride.
constexpr std::int64_t kStepsBefore = 5;
constexpr std::int64_t kStepsOfATurn = 10;
constexpr double kSecondsOfACeiling = 0.02;

/// The simulations after the same steps, and their profiles before and after.
struct Turns {
    Profile before, after;                // as asked
    Profile scalar_before, scalar_after;  // with scalar kernels; empty if that is what was asked for
    Plan plan;
    double seconds = 0;           // of the steps, by the clock on the wall
    SharedLoops::Seconds shared;  // of the loops of the simulation on one thread
    double alone_seconds = 0;     // of its steps
};

/// @return seconds of the steps alone
double take_steps(Simulation& simulation, double dt, std::int64_t count, Trace* trace) {
    if (!trace) {
        const double start = measure::wall_seconds();
        for (std::int64_t i = 0; i < count; ++i) simulation.step(dt);
        return measure::wall_seconds() - start;
    }
    double seconds = 0;
    for (std::int64_t i = 0; i < count; ++i) {
        const Profile before = simulation.profile();
        seconds += take_steps(simulation, dt, 1, nullptr);
        trace->add_step(before, simulation.profile());
    }
    return seconds;
}

Turns take_turns(const Scene& scene, const MachineSettings& machine, Trace* trace) {
    const auto simulation = make_simulation(scene, machine);
    Turns turns;
    turns.plan = simulation->plan();
    MachineSettings plain = machine;
    plain.isa = "scalar";
    const auto scalar = turns.plan.isa == "scalar" ? nullptr : make_simulation(scene, plain);
    SharedLoops loops;
    MachineSettings watched = machine;
    watched.threads = 0;  // one would be told to share nothing
    watched.parallel_for = loops.parallel_for();
    const auto alone = make_simulation(scene, watched);

    const std::int64_t steps = scene.step.count, before = std::min(kStepsBefore, steps - 1);
    take_steps(*simulation, scene.step.dt, before, nullptr);
    if (scalar) take_steps(*scalar, scene.step.dt, before, nullptr);
    take_steps(*alone, scene.step.dt, before, nullptr);
    const SharedLoops::Seconds first = loops.seconds();
    turns.before = simulation->profile();
    if (scalar) turns.scalar_before = scalar->profile();
    ProgressBar bar(steps, true);
    for (std::int64_t done = before; done < steps && !is_interrupted();) {
        const std::int64_t count = std::min(kStepsOfATurn, steps - done);
        turns.seconds += take_steps(*simulation, scene.step.dt, count, trace);
        if (scalar) take_steps(*scalar, scene.step.dt, count, nullptr);
        turns.alone_seconds += take_steps(*alone, scene.step.dt, count, nullptr);
        bar.update(done += count);
    }
    turns.after = simulation->profile();
    if (scalar) turns.scalar_after = scalar->profile();
    turns.shared = loops.seconds() - first;
    return turns;
}

std::string kernel_of(const Plan& plan, std::string_view stage) {
    for (const StageReport& report : plan.stages)
        if (report.name == stage) return report.kernel;
    return {};
}

/// One stage: its time, its work, and what limits it.
/// @param stage, scalar  what it took in all steps, as asked and with scalar kernels, if it did
Json stage_json(const StageTime& stage, const StageTime& scalar, const Plan& plan,
                const measure::ProfiledSteps& steps, double all_seconds, const measure::Ceilings& ceilings,
                double clock_reading) {
    const double seconds = stage.seconds / steps.steps();
    const double calls = static_cast<double>(stage.calls) / steps.steps();
    Json json{{"name", stage.name},
              {"kernel", kernel_of(plan, stage.name)},
              {"calls_per_step", calls},
              {"seconds_per_step", seconds},
              {"share", seconds / all_seconds}};
    measure::StageFacts facts{
        .bodies = steps.bodies, .seconds_per_call = seconds / calls, .seconds_of_a_reading = clock_reading};
    if (const auto work = measure::work_of_stage(stage.name, steps, calls); work && work->items > 0) {
        const measure::CopyBandwidth& level =
            ceilings.copy_of(static_cast<std::size_t>(work->items * work->work.bytes));
        const measure::ArithmeticPeak& peak = ceilings.peak_of(plan.isa);
        const double rate = work->items / seconds;
        const measure::RoofShare share =
            measure::roof_share(work->work, rate, level.bytes_per_second,
                                steps.real_bytes > 4 ? peak.double_per_second : peak.single_per_second);
        facts.roof_share = share.share;
        facts.roof_is_memory = share.is_memory;
        facts.level = level.level;
        json["item"] = work->item;
        json["items"] = work->items;
        json["ns_per_item"] = 1e9 / rate;
        json["bytes"] = work->items * work->work.bytes;
        json["bytes_per_second"] = rate * work->work.bytes;
        json["roof_share"] = share.share;
        json["roof"] = share.is_memory ? level.level : "arithmetic";
    }
    if (scalar.calls > 0 && seconds > 0) {
        facts.times_scalar = scalar.seconds / stage.seconds;
        json["times_scalar"] = *facts.times_scalar;
    }
    json["limit"] = measure::limit_of(facts);
    return json;
}

/// The share of a step that is in no loop that threads share, and how many times as fast as on one thread a
/// step can be at most.
Json shared_loops_json(const Turns& turns) {
    const double serial = std::max(0.0, turns.alone_seconds - turns.shared.inside);
    const double all = serial + turns.shared.tasks;
    Json json{{"share_on_one_thread", serial / all}, {"cores", Json::array()}};
    for (std::size_t i = 0; i < SharedLoops::kCores.size(); ++i)
        json["cores"].push_back({{"cores", SharedLoops::kCores[i]},
                                 {"times_at_most", all / (serial + turns.shared.on_cores[i])}});
    return json;
}

std::string shared_loops_text(const Json& loops) {
    std::string cores, times;
    for (const Json& row : loops.at("cores")) {
        const char* const comma = cores.empty() ? "" : ", ";
        cores += format("%s%d", comma, row.at("cores").get<int>());
        times += format("%s%.3g", comma, row.at("times_at_most").get<double>());
    }
    return format(
        "\n  threads: %.3g %% of a step is in no loop that an embedding program's threads share; "
        "%s cores take it at most %s times as fast\n",
        100 * loops.at("share_on_one_thread").get<double>(), cores.c_str(), times.c_str());
}

}  // namespace

Json profile_scene(const Scene& scene, const MachineSettings& machine, Trace* trace) {
    if (scene.step.count < 1)
        throw UsageError("profile: the scene takes no steps; ask for some with --steps");
    const Turns turns = take_turns(scene, machine, trace);
    const measure::Ceilings ceilings = measure::measure_ceilings(kSecondsOfACeiling);
    const double clock_reading = measure::seconds_of_a_clock_reading();
    const measure::ProfiledSteps steps{.before = turns.before,
                                       .after = turns.after,
                                       .bodies = static_cast<double>(scene.bodies.size()),
                                       .real_bytes = turns.plan.precision == "double" ? 8.0 : 4.0};
    Json json = measure::result_header("profile");
    json["scene"] = scene.name;
    json["bodies"] = scene.bodies.size();
    json["steps"] = turns.after.steps - turns.before.steps;
    json["solver"] = turns.plan.solver;
    json["substeps"] = turns.plan.substeps;
    json["precision"] = turns.plan.precision;
    json["isa"] = turns.plan.isa;
    json["threads"] = turns.plan.threads;
    json["ceilings"] = measure::ceilings_json(ceilings);
    const std::vector<StageTime> stages = measure::stage_times_between(turns.before, turns.after),
                                 scalar =
                                     measure::stage_times_between(turns.scalar_before, turns.scalar_after);
    double all = 0, readings = 0;
    for (const StageTime& stage : stages) {
        all += stage.seconds / steps.steps();
        readings += static_cast<double>(stage.calls) / steps.steps();
    }
    json["seconds_per_step"] = turns.seconds / steps.steps();
    json["measuring_share"] = (readings + 1) * clock_reading / all;
    const Profile& last = turns.after;
    json["counters"] = {{"candidate_pairs", last.candidate_pairs},
                        {"rebuilds", last.rebuilds - turns.before.rebuilds},
                        {"contacts", last.contacts},
                        {"touching", last.touching},
                        {"colours", last.colours},
                        {"overflow", last.overflow},
                        {"impacts", last.impacts - turns.before.impacts},
                        {"bounces", last.bounces - turns.before.bounces},
                        {"residual", last.residual},
                        {"residual_max", last.residual_max},
                        {"bytes", last.bytes}};
    json["shared_loops"] = shared_loops_json(turns);
    json["stages"] = Json::array();
    for (const StageTime& stage : stages)
        json["stages"].push_back(stage_json(stage, measure::time_of_stage(scalar, stage.name), turns.plan,
                                            steps, all, ceilings, clock_reading));
    return json;
}

std::string profile_text(const Json& profile) {
    const auto whole = [&](const char* key) {
        return static_cast<long long>(profile.at(key).get<std::int64_t>());
    };
    const auto word = [&](const char* key) { return profile.at(key).get<std::string>(); };
    std::string text = format(
        "%s: %lld bodies, %lld steps, %.4g us a step\n  solver %s, %lld substep%s, %s precision, "
        "%s, %lld thread%s; timing the stages takes %.2f %% of a step\n\n",
        word("scene").c_str(), whole("bodies"), whole("steps"),
        1e6 * profile.at("seconds_per_step").get<double>(), word("solver").c_str(), whole("substeps"),
        whole("substeps") == 1 ? "" : "s", word("precision").c_str(), word("isa").c_str(), whole("threads"),
        whole("threads") == 1 ? "" : "s", 100 * profile.at("measuring_share").get<double>());
    std::size_t longest = 0;
    for (const Json& stage : profile.at("stages"))
        longest = std::max(longest, stage.at("name").get_ref<const std::string&>().size());
    const auto width = static_cast<int>(longest);
    text += format("  %-*s %10s %6s %10s %9s %8s %8s %9s  %s\n", width, "stage", "us a step", "share",
                   "items", "ns/item", "KB", "roof", "x scalar", "limited by");
    for (const Json& stage : profile.at("stages")) {
        const auto number = [&](const char* pattern_free_key, double scale, int significant) {
            return stage.contains(pattern_free_key)
                       ? format("%.*g", significant, scale * stage.at(pattern_free_key).get<double>())
                       : std::string("-");
        };
        const std::string roof =
            stage.contains("roof_share") ? joined(number("roof_share", 100, 2), " %") : "-";
        text +=
            format("  %-*s %10s %4.0f %% %10s %9s %8s %8s %9s  %s\n", width,
                   stage.at("name").get<std::string>().c_str(), number("seconds_per_step", 1e6, 4).c_str(),
                   100 * stage.at("share").get<double>(), number("items", 1, 6).c_str(),
                   number("ns_per_item", 1, 3).c_str(), number("bytes", 1e-3, 4).c_str(), roof.c_str(),
                   number("times_scalar", 1, 3).c_str(), stage.at("limit").get<std::string>().c_str());
    }
    text += shared_loops_text(profile.at("shared_loops"));
    std::string items;
    for (const Json& stage : profile.at("stages"))
        if (stage.contains("item"))
            items += joined(items.empty() ? "\n  items: " : ", ", stage.at("name").get<std::string>(), ": ",
                            stage.at("item").get<std::string>());
    std::string counters;
    for (const auto& [name, value] : profile.at("counters").items())
        counters += joined(counters.empty() ? "\n  counters: " : ", ", name, " ",
                           value.is_number_float() ? format("%.3g", value.get<double>()) : value.dump());
    return joined(
        text, counters, items,
        "\n  roof: share of this core's bandwidth or arithmetic, whichever is nearer; x scalar: faster "
        "than with scalar kernels\n");
}

}  // namespace carom::tool
