#include "run_scene.hpp"

#include <carom/errors.hpp>
#include <carom/version.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "report/kinds/run_page.hpp"
#include "results/events_csv.hpp"
#include "results/final_csv.hpp"
#include "results/ledger_csv.hpp"
#include "results/page_file.hpp"
#include "results/summary_json.hpp"
#include "results/trajectory_h5.hpp"
#include "simulation/outlines.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/progress_bar.hpp"

namespace carom::tool {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestFolderName = 100;  // characters

double seconds_between(Clock::time_point start, Clock::time_point end) {
    return std::chrono::duration<double>(end - start).count();
}

nlohmann::ordered_json walls_json(const std::optional<Walls>& walls) {
    if (!walls) return nullptr;
    nlohmann::ordered_json sides = nlohmann::ordered_json::array();
    for (const auto& [name, closed] : {std::pair{"left", walls->left},
                                       {"right", walls->right},
                                       {"bottom", walls->bottom},
                                       {"top", walls->top}})
        if (closed) sides.push_back(name);
    return {{"min", {walls->min.x, walls->min.y}}, {"max", {walls->max.x, walls->max.y}}, {"sides", sides}};
}

/// The lines by which joints are drawn: [a, x, y, b, x, y], points in the frames of bodies, -1: of the world.
/// Rods go from anchor to anchor, other joints from the centre of one body to that of the other.
nlohmann::ordered_json joints_json(const Scene& scene) {
    nlohmann::ordered_json joints = nlohmann::ordered_json::array();
    for (const Joint& joint : scene.joints) {
        Vec2 from{}, to{};
        if (const auto* rod = std::get_if<DistanceJoint>(&joint.kind))
            from = rod->anchor_a, to = rod->anchor_b;
        if (const auto* target = std::get_if<TargetJoint>(&joint.kind))
            from = target->target, to = target->anchor;
        const auto anchor = std::visit(
            [](const auto& kind) -> std::optional<Vec2> {
                if constexpr (requires { kind.anchor.has_value(); }) return kind.anchor;
                return std::nullopt;
            },
            joint.kind);
        const auto place = [&](const std::optional<BodyId>& other) {
            return anchor ? *anchor : other ? scene.bodies[other->index].position : Vec2{};
        };
        const bool is_between_centres = joint.kind.index() != 0 && joint.kind.index() != 5;
        if (is_between_centres && !joint.a) from = place(joint.b);
        if (is_between_centres && !joint.b) to = place(joint.a);
        const auto number = [](const std::optional<BodyId>& id) {
            return id ? static_cast<std::int64_t>(id->index) : std::int64_t{-1};
        };
        joints.push_back({number(joint.a), from.x, from.y, number(joint.b), to.x, to.y});
    }
    return joints;
}

/// Which joints broke, and when: [joint, s].
nlohmann::ordered_json breaks_json(const std::vector<JointBreak>& breaks) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const JointBreak& each : breaks) list.push_back({each.joint.index, each.time});
    return list;
}

/// The bodies that are lines, which have no radius: their points, in the body's frame [m].
nlohmann::ordered_json edges_json(const std::vector<Body>& bodies) {
    nlohmann::ordered_json edges = nlohmann::ordered_json::array();
    const auto add = [&](std::size_t body, std::span<const Vec2> points, bool loop) {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const Vec2& point : points) list.push_back({point.x, point.y});
        edges.push_back({{"body", body}, {"points", std::move(list)}, {"loop", loop}});
    };
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (const auto* segment = std::get_if<Segment>(&bodies[i].shape))
            add(i, std::array{segment->a, segment->b}, false);
        if (const auto* chain = std::get_if<Chain>(&bodies[i].shape)) add(i, chain->points, chain->loop);
    }
    return edges;
}

nlohmann::ordered_json outline_json(const ShapeOutline& outline) {
    nlohmann::ordered_json vertices = nlohmann::ordered_json::array();
    for (const Vec2 vertex : outline.vertices) vertices.push_back({vertex.x, vertex.y});
    return {{"vertices", std::move(vertices)}, {"radius", outline.radius}};
}

/// The outlines of boxes, capsules and polygons: vertices [m] and rounding radius [m]; of compounds those of
/// their pieces.
nlohmann::ordered_json shapes_json(const std::vector<ShapeOutline>& outlines) {
    nlohmann::ordered_json shapes = nlohmann::ordered_json::array();
    for (const ShapeOutline& outline : outlines) {
        if (outline.pieces.empty()) {
            shapes.push_back(outline_json(outline));
            continue;
        }
        nlohmann::ordered_json pieces = nlohmann::ordered_json::array();
        for (const ShapeOutline& piece : outline.pieces) pieces.push_back(outline_json(piece));
        shapes.push_back({{"pieces", std::move(pieces)}});
    }
    return shapes;
}

/// What the run does with the scene, for readers that open the trajectory alone.
std::string settings_text(const Scene& scene, const Plan& plan, const Outlines& outlines) {
    nlohmann::ordered_json json{{"version", kVersion},
                                {"dt", scene.step.dt},
                                {"steps", scene.step.count},
                                {"record_every", scene.record.every},
                                {"trail", scene.record.trail},
                                {"gravity", {scene.gravity.x, scene.gravity.y}},
                                {"drag", {{"linear", scene.drag.linear}, {"angular", scene.drag.angular}}},
                                {"walls", walls_json(scene.walls)},
                                {"edges", edges_json(scene.bodies)},
                                {"shapes", shapes_json(outlines.shapes)},
                                {"joints", joints_json(scene)},
                                {"solver", plan.solver},
                                {"substeps", plan.substeps},
                                {"iterations", plan.iterations},
                                {"precision", plan.precision},
                                {"isa", plan.isa},
                                {"threads", plan.threads}};
    json["effects"] = nlohmann::ordered_json::array();
    for (const EffectReport& effect : plan.effects)
        if (effect.on) json["effects"].push_back(effect.name);
    return json.dump();
}

/// The files that grow during a run.
class Recorder {
  public:
    Recorder(const Scene& scene, const Simulation& simulation, ResultFolder& folder,
             const RunChoices& choices)
        : every_(scene.record.every) {
        if (simulation.keeps_ledger()) ledger_ = std::make_unique<LedgerCsv>(folder.temporary("ledger.csv"));
        if (choices.events) events_ = std::make_unique<EventsCsv>(folder.temporary("events.csv"));
        if (choices.no_trajectory) return;
        const std::int64_t frames = 1 + scene.step.count / every_ + (scene.step.count % every_ != 0 ? 1 : 0);
        Outlines outlines = outlines_of(scene.bodies);
        trajectory_ = std::make_unique<TrajectoryH5>(
            folder.temporary("trajectory.h5"), scene, simulation,
            TrajectoryNotes{.scene_text = choices.scene_text,
                            .settings = settings_text(scene, simulation.plan(), outlines),
                            .frame_count = frames,
                            .shape = std::move(outlines.of_body)});
        trajectory_->append(simulation);
    }

    void record(const Simulation& simulation, const Events& events, double dt, std::int64_t step) {
        append_row(simulation);
        if (events_) events_->append(events, dt);
        if (trajectory_ && step % every_ == 0) append_frame(simulation, step);
    }

    /// The last state is always the last frame, and the last row, also where a step ended early.
    /// @param breaks  of joints in the whole run
    void close(const Simulation& simulation, const std::vector<JointBreak>& breaks, std::int64_t step) {
        const bool is_between = simulation.time() != last_time_;
        if (is_between) append_row(simulation);
        if (ledger_) ledger_->close();
        if (events_) events_->close();
        if (!trajectory_) return;
        if (last_frame_ != step || is_between) append_frame(simulation, step);
        trajectory_->close(breaks_json(breaks).dump());
    }

  private:
    void append_row(const Simulation& simulation) {
        if (ledger_) ledger_->append(simulation.ledger(), simulation.profile().impacts);
        last_time_ = simulation.time();
    }

    void append_frame(const Simulation& simulation, std::int64_t step) {
        trajectory_->append(simulation);
        last_frame_ = step;
    }

    std::int64_t every_;
    std::int64_t last_frame_ = 0;
    double last_time_ = 0;  // s, of the last row
    std::unique_ptr<LedgerCsv> ledger_;
    std::unique_ptr<EventsCsv> events_;
    std::unique_ptr<TrajectoryH5> trajectory_;
};

/// @return whether the step came to its end
bool take_step(double dt, Simulation& simulation, RunOutcome& run) {
    try {
        simulation.step(dt);
        return true;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::interrupted && error.code() != ErrorCode::given_up) throw;
        run.given_up = error.code() == ErrorCode::given_up;
        if (run.given_up) run.messages.push_back(error.what());
        return false;
    }
}

void take_steps(const Scene& scene, Simulation& simulation, Recorder& recorder, bool quiet, RunOutcome& run) {
    ProgressBar progress(scene.step.count, !quiet);
    ContactCourse contacts(scene.step.count, simulation.body_count());
    const Clock::time_point start = Clock::now();
    Clock::time_point before = start;
    while (run.steps < scene.step.count && !is_interrupted()) {
        if (!take_step(scene.step.dt, simulation, run)) break;
        const Clock::time_point stepped = Clock::now();
        ++run.steps;
        const Events events = simulation.events();
        run.breaks.insert(run.breaks.end(), events.breaks.begin(), events.breaks.end());
        recorder.record(simulation, events, scene.step.dt, run.steps);
        contacts.look(simulation, run.steps);
        if (run.steps == 1) run.first_step = simulation.ledger();
        const Clock::time_point recorded = Clock::now();
        run.stepping_seconds += seconds_between(before, stepped);
        run.recording_seconds += seconds_between(stepped, recorded);
        progress.update(run.steps);
        before = Clock::now();
    }
    run.total_seconds = seconds_between(start, before);
    run.contacts = contacts.moments();
    run.interrupted = run.steps < scene.step.count;
}

void describe_end(const Scene& scene, const Simulation& simulation, RunOutcome& run) {
    run.scene_name = scene.name;
    run.bodies = scene.bodies.size();
    run.steps_asked = scene.step.count;
    run.dt = scene.step.dt;
    run.time = simulation.time();
    run.profile = simulation.profile();
    run.ledger = simulation.ledger();
    run.keeps_ledger = simulation.keeps_ledger();
    run.overlaps = simulation.overlaps();
    run.joints = simulation.joint_errors();
    run.quarantined = simulation.quarantined();
    run.state_hash = simulation.state_hash();
    if (run.interrupted)
        run.messages.push_back(format("%s after %lld of %lld steps; the results are those so far",
                                      run.given_up ? "ended" : "interrupted",
                                      static_cast<long long>(run.steps),
                                      static_cast<long long>(run.steps_asked)));
    if (!run.quarantined.empty())
        run.messages.push_back(
            format("%zu of %zu bodies were disabled because their state left the limits, the first is "
                   "body %zu; see \"quarantined\" in summary.json",
                   run.quarantined.size(), run.bodies, run.quarantined.front()));
    if (run.profile.unresolved_impacts > 0)
        run.messages.push_back(
            format("%lld impacts were left to the next step, beyond the limit of solver \"impulse\": bodies "
                   "may overlap. A shorter step resolves them; for crowds use \"soft\" or \"auto\"",
                   static_cast<long long>(run.profile.unresolved_impacts)));
    const Plan plan = simulation.plan();
    run.messages.insert(run.messages.end(), plan.limits.begin(), plan.limits.end());
}

/// Drawn from the files that were just written.
void write_report(const RunOutcome& run, ResultFolder& folder, const RunChoices& choices) {
    if (choices.no_report) return;
    report::RunFiles files{.summary = summary_of(run),
                           .final_csv = folder.temporary("final.csv"),
                           .ledger_csv = {},
                           .trajectory_h5 = {},
                           .page_bytes = choices.page_bytes};
    if (run.keeps_ledger) files.ledger_csv = folder.temporary("ledger.csv");
    if (!choices.no_trajectory) files.trajectory_h5 = folder.temporary("trajectory.h5");
    report::Page page("");
    report::draw_run(files, page);
    write_page_to(folder.temporary("report.html"), page);
}

}  // namespace

RunOutcome run_scene(const Scene& scene, Simulation& simulation, ResultFolder& folder,
                     const RunChoices& choices) {
    RunOutcome run;
    run.plan = simulation.plan();
    const std::filesystem::path summary = folder.temporary("summary.json"),
                                final = folder.temporary("final.csv");
    Recorder recorder(scene, simulation, folder, choices);
    take_steps(scene, simulation, recorder, choices.quiet, run);
    recorder.close(simulation, run.breaks, run.steps);
    describe_end(scene, simulation, run);
    if (!choices.no_report) folder.temporary("report.html");
    run.files = folder.names();
    if (!choices.no_trajectory) run.trajectory = report::checksum_of(folder.temporary("trajectory.h5"));
    write_final_csv(final, scene, simulation);
    write_summary_json(summary, run);
    write_report(run, folder, choices);
    folder.commit();
    return run;
}

std::string folder_name(const std::string& scene_name) {
    std::string name = scene_name.substr(0, kLongestFolderName);
    const auto is_plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.' ||
               c == ' ';
    };
    for (char& c : name)
        if (!is_plain(c)) c = '_';
    if (name.empty() || name[0] == '.') name.insert(name.begin(), '_');
    return name;
}

std::string text_of_file(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return {};
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace carom::tool
