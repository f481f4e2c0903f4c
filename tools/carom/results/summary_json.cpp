#include "results/summary_json.hpp"

#include <carom/version.hpp>

#include <array>
#include <cstdio>

#include "results/plan_json.hpp"
#include "results/text_file.hpp"

namespace carom::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kIndent = 2;  // spaces

Json to_json(Vec2 v) {
    return Json::array({v.x, v.y});
}

Json to_json(const Energy& energy) {
    return {{"kinetic", energy.kinetic},
            {"rotational", energy.rotational},
            {"potential", energy.potential},
            {"total", energy.total()}};
}

Json to_json(const EnergyByCause& work) {
    return {{"gravity", work.gravity},
            {"drag", work.drag},
            {"restitution", work.restitution},
            {"friction", work.friction},
            {"correction", work.correction},
            {"joints", work.joints},
            {"drive", work.drive},
            {"sleep", work.sleep},
            {"outside", work.outside},
            {"unexplained", work.unexplained}};
}

Json to_json(const EnergyExcess& excess) {
    return {
        {"restitution", excess.restitution}, {"correction", excess.correction}, {"passive", excess.passive}};
}

Json to_json(const MomentumByCause& given) {
    return {{"gravity", to_json(given.gravity)},
            {"drag", to_json(given.drag)},
            {"walls", to_json(given.walls)},
            {"immovable", to_json(given.immovable)},
            {"sleep", to_json(given.sleep)},
            {"outside", to_json(given.outside)},
            {"unexplained", to_json(given.unexplained)}};
}

Json effects_of(const Plan& plan) {
    Json names = Json::array();
    for (const EffectReport& effect : plan.effects)
        if (effect.on) names.push_back(effect.name);
    return names;
}

Json stages_of(const Profile& profile) {
    Json stages = Json::array();
    for (const StageTime& stage : profile.stages)
        stages.push_back({{"name", stage.name}, {"calls", stage.calls}, {"seconds", stage.seconds}});
    return stages;
}

Json wall_of(const RunOutcome& run) {
    const auto steps = static_cast<double>(run.steps), bodies = static_cast<double>(run.bodies);
    const double step_seconds = run.steps > 0 ? run.stepping_seconds / steps : 0;
    return {{"total_s", run.total_seconds},
            {"stepping_s", run.stepping_seconds},
            {"recording_s", run.recording_seconds},
            {"ms_per_step", step_seconds * 1e3},
            {"ns_per_body_step", run.bodies > 0 ? step_seconds / bodies * 1e9 : 0}};
}

Json counters_of(const Profile& profile) {
    return {{"rebuilds", profile.rebuilds},
            {"candidate_pairs", profile.candidate_pairs},
            {"impacts", profile.impacts},
            {"wall_impacts", profile.wall_impacts},
            {"simultaneous_impacts", profile.simultaneous_impacts},
            {"resting_contacts", profile.resting_contacts},
            {"contacts", profile.contacts},
            {"touching", profile.touching},
            {"colours", profile.colours},
            {"overflow", profile.overflow},
            {"bounces", profile.bounces},
            {"residual", profile.residual},
            {"residual_max", profile.residual_max},
            {"overlaps_corrected", profile.overlaps_corrected},
            {"unresolved_impacts", profile.unresolved_impacts},
            {"asleep", profile.asleep},
            {"islands_asleep", profile.islands_asleep},
            {"islands_woken", profile.islands_woken},
            {"bytes", profile.bytes}};
}

Json contacts_over_time(const RunOutcome& run) {
    Json course;
    for (const char* key : {"time", "touching", "overlap_mean", "overlap_max"}) course[key] = Json::array();
    for (const ContactCourse::Moment& moment : run.contacts) {
        course["time"].push_back(moment.time);
        course["touching"].push_back(moment.overlaps.touching);
        course["overlap_mean"].push_back(moment.overlaps.mean);
        course["overlap_max"].push_back(moment.overlaps.max);
    }
    return course;
}

/// Initial and final value, and the one after the first step if there was one.
template <class Value>
Json course(const Value& initial, const std::optional<Ledger>& first, const Value& last,
            Value Ledger::*member) {
    const auto json = [](const Value& value) {
        if constexpr (std::is_same_v<Value, double>)
            return Json(value);
        else
            return to_json(value);
    };
    Json values{{"initial", json(initial)}, {"final", json(last)}};
    if (first) values["after_first_step"] = json((*first).*member);
    return values;
}

}  // namespace

std::string hash_text(std::uint64_t hash) {
    std::array<char, 17> text;
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
    return text.data();
}

Json summary_of(const RunOutcome& run) {
    const Ledger& books = run.ledger;
    Json json{{"kind", "run"},
              {"scene", run.scene_name},
              {"version", kVersion},
              {"bodies", run.bodies},
              {"joints", run.joints.joints},
              {"steps", run.steps},
              {"steps_asked", run.steps_asked},
              {"interrupted", run.interrupted},
              {"dt", run.dt},
              {"time", run.time},
              {"solver", run.plan.solver},
              {"substeps", run.plan.substeps},
              {"iterations", run.plan.iterations},
              {"precision", run.plan.precision},
              {"isa", run.plan.isa},
              {"threads", run.plan.threads}};
    json["effects"] = effects_of(run.plan);
    json["stages"] = stages_of(run.profile);
    json["wall"] = wall_of(run);
    json["energy"] = course(books.initial, run.first_step, books.energy, &Ledger::energy);
    json["momentum"] = course(books.initial_momentum, run.first_step, books.momentum, &Ledger::momentum);
    json["angular_momentum"] = course(books.initial_angular_momentum, run.first_step, books.angular_momentum,
                                      &Ledger::angular_momentum);
    if (run.keeps_ledger) {
        json["energy_by_cause"] = to_json(books.energy_by_cause);
        json["momentum_by_cause"] = to_json(books.momentum_by_cause);
        if (run.plan.solver != "pairwise") json["energy_excess"] = to_json(books.energy_excess);
    }
    json["wall_impulse"] = books.wall_impulse;
    json["contacts"] = {{"count", run.overlaps.candidates},
                        {"touching", run.overlaps.touching},
                        {"overlap_mean", run.overlaps.mean},
                        {"overlap_max", run.overlaps.max}};
    json["contacts_over_time"] = contacts_over_time(run);
    json["joints_error"] = {{"mean", run.joints.mean}, {"max", run.joints.max}};
    json["joints_broken"] = Json::array();
    for (const JointBreak& each : run.breaks)
        json["joints_broken"].push_back({{"joint", each.joint.index},
                                         {"time", each.time},
                                         {"force", to_json(each.force)},
                                         {"torque", each.torque}});
    json["counters"] = counters_of(run.profile);
    json["quarantined"] = run.quarantined;
    json["state_hash"] = hash_text(run.state_hash);
    json["plan"] = plan_json(run.plan);
    json["files"] = run.files;
    if (run.trajectory) json["checksums"] = {{"trajectory.h5", report::json_of(*run.trajectory)}};
    json["messages"] = run.messages;
    return json;
}

void write_summary_json(const std::filesystem::path& path, const RunOutcome& outcome) {
    TextFile file(path);
    file.write(summary_of(outcome).dump(kIndent, ' ', false, Json::error_handler_t::replace));
    file.write("\n");
    file.close();
}

}  // namespace carom::tool
