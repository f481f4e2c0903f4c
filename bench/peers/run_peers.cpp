#include "peers/run_peers.hpp"

#include <carom/errors.hpp>

#include <algorithm>
#include <cmath>
#include <thread>

#include "measure/clocks.hpp"
#include "measure/gas.hpp"
#include "measure/machine.hpp"
#include "measure/statistics.hpp"
#include "measure/text.hpp"
#include "peers/body_measures.hpp"
#include "peers/peer.hpp"
#include "scenes/scenes.hpp"

namespace carom::bench {
namespace {

using measure::format;
using measure::joined;
using measure::Json;
using measure::kStep;

constexpr double kNano = 1e9;
constexpr int kFewestStepsOfATurn = 6, kMostStepsOfATurn = 300;

/// An engine with a scene made in it, or the reason why it has none.
struct Entrant {
    PeerEngine engine;
    std::unique_ptr<Peer> peer;
    std::string reason;
    std::int64_t steps = 0;
    double settle_seconds = 0;    // a step, while it settled
    std::vector<double> seconds;  // a step, by round

    void step() { peer->step(kStep), ++steps; }
};

void settle(Entrant& entrant, const BenchScene& scene) {
    const double start = measure::thread_seconds();
    for (int i = 0; i < scene.settle_steps; ++i) entrant.step();
    if (scene.settle_steps > 0)
        entrant.settle_seconds = (measure::thread_seconds() - start) / scene.settle_steps;
}

std::vector<Entrant> enter(const BenchScene& scene, const std::function<void(const std::string&)>& progress) {
    std::vector<Entrant> entrants;
    std::vector<PeerEngine> engines{carom_engine()};  // ours first
    if (std::thread::hardware_concurrency() > 1) engines.push_back(carom_engine(true));
    for (PeerEngine& engine : other_engines()) engines.push_back(std::move(engine));
    for (PeerEngine& engine : engines) {
        Entrant entrant{.engine = std::move(engine),
                        .peer = nullptr,
                        .reason = {},
                        .steps = 0,
                        .settle_seconds = 0,
                        .seconds = {}};
        const auto bodies = static_cast<std::int64_t>(scene.scene.bodies.size());
        if (bodies > entrant.engine.most_bodies) {
            entrant.reason = format("is not run with more than %s bodies",
                                    measure::grouped(entrant.engine.most_bodies).c_str());
        } else {
            try {
                entrant.peer = entrant.engine.make(scene, {});
            } catch (const Error& error) {
                entrant.reason = error.what();
            }
        }
        if (entrant.peer) {
            progress(joined(scene.name, ", ", measure::grouped(bodies), " bodies: ", entrant.engine.name,
                            " settles"));
            settle(entrant, scene);
        }
        entrants.push_back(std::move(entrant));
    }
    return entrants;
}

/// All take the same number of steps, so that energy and overlap are those of one moment: as many as make the
/// first one's turn, which is ours, long enough. Of a scene that starts over a turn is a whole run.
void take_turns(std::vector<Entrant>& entrants, const BenchScene& scene, measure::ContestOptions options) {
    std::vector<measure::Contestant> contestants;
    std::vector<Entrant*> running;
    for (Entrant& entrant : entrants)
        if (entrant.peer) {
            contestants.push_back(
                {entrant.engine.name, [&entrant] { entrant.step(); }, entrant.engine.threads > 1});
            if (scene.restart_steps > 0)
                contestants.back().before_turn = [&entrant, &scene] {
                    entrant.peer = entrant.engine.make(scene, {});
                    entrant.steps = 0;
                    settle(entrant, scene);
                };
            running.push_back(&entrant);
        }
    if (running.empty()) return;
    options.fewest_steps = scene.restart_steps;
    if (scene.restart_steps == 0) {
        const double wanted = options.seconds_of_a_turn / running.front()->settle_seconds;
        options.fewest_steps = static_cast<int>(
            std::clamp(std::ceil(wanted), double{kFewestStepsOfATurn}, double{kMostStepsOfATurn}));
    }
    options.seconds_of_a_turn = 0;
    auto seconds = measure::run_contest(contestants, options);
    for (std::size_t i = 0; i < running.size(); ++i) running[i]->seconds = std::move(seconds[i]);
}

Json spread_json(const measure::Spread& spread) {
    return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

Json measures_json(const BodyMeasures& now, const BodyMeasures& start) {
    Json json{{"kinetic", now.kinetic},
              {"energy", now.kinetic + now.potential},
              {"energy_at_start", start.kinetic + start.potential},
              {"speed_rms", now.speed_rms},
              {"speed_max", now.speed_max},
              {"touching", now.touching},
              {"overlap_mean", now.overlap_mean},
              {"overlap_max", now.overlap_max},
              {"outside", now.outside}};
    if (start.kinetic > 0) json["kinetic_ratio"] = now.kinetic / start.kinetic;
    return json;
}

BodyMeasures measures_at_start(const Scene& scene) {
    std::vector<BodyState> bodies;
    for (const Body& body : scene.bodies)
        bodies.push_back({body.position, body.angle, body.velocity, body.angular_velocity});
    return measure_bodies(scene, bodies);
}

Json run_task(const PeerTask& task, const measure::ContestOptions& options,
              const std::function<void(const std::string&)>& progress) {
    const BenchScene scene = make_scene(task.scene, task.bodies);
    const BodyMeasures start = measures_at_start(scene.scene);
    std::vector<Entrant> entrants = enter(scene, progress);
    progress(joined(task.scene, ", ", measure::grouped(task.bodies), " bodies: all take turns"));
    take_turns(entrants, scene, options);

    Json json{{"scene", task.scene},
              {"bodies", task.bodies},
              {"settle_steps", scene.settle_steps},
              {"engines", Json::array()}};
    for (Entrant& entrant : entrants) {
        Json row{{"engine", entrant.engine.name}, {"settings", entrant.engine.settings}};
        if (entrant.peer) {
            std::vector<double> each;
            for (const double seconds : entrant.seconds)
                each.push_back(kNano * seconds / static_cast<double>(task.bodies));
            row["ns_per_body"] = spread_json(measure::quartiles(each));
            row["rounds"] = each;
            if (!entrants.front().seconds.empty())
                row["ratio_to_ours"] = spread_json(
                    measure::median_interval(measure::ratios(entrant.seconds, entrants.front().seconds)));
            row["steps"] = entrant.steps;
            std::vector<BodyState> bodies;
            entrant.peer->read(bodies);
            row["measures"] = measures_json(measure_bodies(scene.scene, bodies), start);
        } else {
            row["missing"] = entrant.reason;
        }
        json["engines"].push_back(std::move(row));
        entrant.peer.reset();
    }
    return json;
}

}  // namespace

Json run_peers(const std::vector<PeerTask>& tasks, const measure::ContestOptions& options,
               const std::function<void(const std::string&)>& progress) {
    Json json = measure::result_header("peers");
    json["dt"] = kStep;
    json["scenes"] = Json::array();
    for (const PeerTask& task : tasks) json["scenes"].push_back(run_task(task, options, progress));
    return json;
}

std::string peers_text(const Json& peers) {
    std::string text;
    for (const Json& scene : peers.at("scenes")) {
        text += format("\n%s, %s bodies\n", scene.at("scene").get<std::string>().c_str(),
                       measure::grouped(scene.at("bodies").get<std::int64_t>()).c_str());
        text += format("  %-16s %12s %26s %12s %12s %12s %11s\n", "engine", "ns a body", "times ours (95 %)",
                       "kinetic x", "overlap mean", "overlap max", "speed rms");
        for (const Json& row : scene.at("engines")) {
            const std::string name = row.at("engine").get<std::string>();
            if (row.contains("missing")) {
                text += format("  %-16s %s\n", name.c_str(), row.at("missing").get<std::string>().c_str());
                continue;
            }
            const auto number = [&](const char* group, const char* key) {
                return row.at(group).value(key, 0.0);
            };
            std::string ratio = "-";
            if (row.contains("ratio_to_ours"))
                ratio = format("%.3g (%.3g - %.3g)", number("ratio_to_ours", "median"),
                               number("ratio_to_ours", "low"), number("ratio_to_ours", "high"));
            const Json& measures = row.at("measures");
            const std::string kinetic = measures.contains("kinetic_ratio")
                                            ? format("%.4f", number("measures", "kinetic_ratio"))
                                            : "-";
            text += format("  %-16s %12.4g %26s %12s %10.3g %% %10.3g %% %11.3g\n", name.c_str(),
                           number("ns_per_body", "median"), ratio.c_str(), kinetic.c_str(),
                           100 * number("measures", "overlap_mean"), 100 * number("measures", "overlap_max"),
                           number("measures", "speed_rms"));
        }
    }
    return text;
}

}  // namespace carom::bench
