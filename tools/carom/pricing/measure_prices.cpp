#include "pricing/measure_prices.hpp"

#include <carom/errors.hpp>

#include <algorithm>

#include "measure/clocks.hpp"
#include "measure/machine.hpp"
#include "measure/statistics.hpp"
#include "pricing/priced_effects.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/progress_bar.hpp"

namespace carom::tool {
namespace {

using Json = measure::Json;

constexpr double kNano = 1e9;
// A world that was just made finds and sorts its first pairs; contacts have to find the forces they carry.
constexpr int kStepsBefore = 20;
constexpr int kStepsOfATurn = 60;
constexpr double kShortestTurn = 0.02;  // s; the turns of small scenes are started over until they take that

constexpr const char* kMethod =
    "Price: the same scene from the same state with the effect carried and without it, its values zero in "
    "both, so "
    "both take the same steps bit for bit (same_bits); turns in alternation, median of the paired "
    "differences and "
    "ratios with the 95 % interval of the median (bootstrap). In use: the scene as it is against the scene "
    "with what "
    "calls for the effect taken away, from the same state; bodies then move otherwise. Where the solver has "
    "no such "
    "effect and the scene leaves the choice, another one takes its place (solver_with), and the price is "
    "that of the "
    "change.";

/// The scene in the state a simulation has reached.
Scene scene_of_state(Scene scene, const Simulation& simulation) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyState state = simulation.state(i);
        Body& body = scene.bodies[i];
        body.position = state.position, body.velocity = state.velocity;
        body.angle = state.angle, body.angular_velocity = state.angular_velocity;
    }
    return scene;
}

/// One scene that takes turns.
struct Runner {
    Scene scene;
    MachineSettings machine;
    std::vector<double> seconds{};  // a step, by turn
    std::uint64_t hash = 0;         // after a turn; the same after each

    void take_turn() {
        const auto now = machine.threads == 1 ? measure::thread_seconds : measure::wall_seconds;
        double sum = 0;
        std::int64_t steps = 0;
        while (sum < kShortestTurn) {
            const auto simulation = make_simulation(scene, machine);
            for (int i = 0; i < kStepsBefore; ++i) simulation->step(scene.step.dt);
            const double start = now();
            for (int i = 0; i < kStepsOfATurn; ++i) simulation->step(scene.step.dt);
            sum += now() - start, steps += kStepsOfATurn;
            hash = simulation->state_hash();
        }
        seconds.push_back(sum / static_cast<double>(steps));
    }
};

Json spread_json(const std::vector<double>& values) {
    const measure::Spread spread = measure::median_interval(values);
    return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

std::vector<double> scaled(const std::vector<double>& values, double factor) {
    std::vector<double> result;
    for (const double value : values) result.push_back(factor * value);
    return result;
}

/// What `with` takes more than `without`, turn by turn, a body and step [ns] and as a share.
Json difference_json(const Runner& without, const Runner& with) {
    std::vector<double> nano, share;
    const double each = kNano / static_cast<double>(without.scene.bodies.size());
    for (std::size_t i = 0; i < with.seconds.size(); ++i) {
        nano.push_back(each * (with.seconds[i] - without.seconds[i]));
        share.push_back(with.seconds[i] / without.seconds[i] - 1);
    }
    return {{"ns_per_body_step", spread_json(nano)},
            {"share", spread_json(share)},
            {"rounds", {{"without", scaled(without.seconds, each)}, {"with", scaled(with.seconds, each)}}}};
}

/// What the plan of `with` has that the plan of `without` has not.
Json additions_json(const Runner& without, const Runner& with) {
    const auto lean = make_simulation(without.scene, without.machine);
    const auto full = make_simulation(with.scene, with.machine);
    const Plan before = lean->plan(), after = full->plan();
    Json columns = Json::array(), stages = Json::array(), kernels = Json::array();
    for (const ColumnReport& column : after.columns)
        if (std::none_of(before.columns.begin(), before.columns.end(),
                         [&](const ColumnReport& each) { return each.name == column.name; }))
            columns.push_back(column.name);
    for (const StageReport& stage : after.stages) {
        const auto same = std::find_if(before.stages.begin(), before.stages.end(),
                                       [&](const StageReport& each) { return each.name == stage.name; });
        if (same == before.stages.end())
            stages.push_back(stage.name);
        else if (same->kernel != stage.kernel)
            kernels.push_back(joined(stage.name, ": ", stage.kernel));
    }
    for (int i = 0; i < kStepsBefore; ++i) lean->step(with.scene.step.dt), full->step(with.scene.step.dt);
    const double bodies = static_cast<double>(with.scene.bodies.size());
    return {
        {"columns", columns},
        {"column_bytes_per_body",
         static_cast<std::int64_t>(after.bytes_per_body) - static_cast<std::int64_t>(before.bytes_per_body)},
        {"memory_bytes_per_body",
         (static_cast<double>(full->profile().bytes) - static_cast<double>(lean->profile().bytes)) / bodies},
        {"stages", stages},
        {"kernels", kernels}};
}

bool is_of(const PricedEffect& effect, Wish wish) {
    return std::find(effect.wishes.begin(), effect.wishes.end(), wish) != effect.wishes.end();
}

/// Why the effect has no price, or nothing.
std::string reason_for_no_price(const PricedEffect& effect, const Scene& with, const Scene& without,
                                const MachineSettings& machine) {
    const Solver solver = with.accuracy.solver;
    if (is_of(effect, &EffectOverrides::drag) && solver == Solver::event) return "solver event has no drag";
    if (is_of(effect, &EffectOverrides::continuous))
        return "it cannot be left out: every solver looks ahead over the whole step";
    for (const Scene* scene : {&without, &with}) try {
            make_simulation(*scene, machine);
        } catch (const Error& error) {
            return error.what();
        }
    return {};
}

bool is_called(const PricedEffect& effect, const Plan& plan) {
    return std::all_of(effect.wishes.begin(), effect.wishes.end(), [&](Wish wish) {
        return std::any_of(priced_effects().begin(), priced_effects().end(), [&](const PricedEffect& each) {
            if (each.wishes != std::vector{wish}) return false;
            return std::any_of(plan.effects.begin(), plan.effects.end(), [&](const EffectReport& report) {
                return report.name == each.name && report.on;
            });
        });
    });
}

Json head_of(const PricedEffect& effect) {
    return {{"name", effect.name}, {"what", effect.what}, {"called_by", effect.called_by}};
}

/// A price, or the reason why there is none; nothing if it was interrupted.
/// @param chooses_solver  the scene leaves the choice to us: what is forced on may ask for another one
Json price_of(const PricedEffect& effect, const Runner& whole, const Plan& plan, bool chooses_solver,
              int repeats, ProgressBar& bar, std::int64_t& turns) {
    Json json = head_of(effect);
    const bool called = is_called(effect, plan);
    json["called"] = called;
    Runner without = whole, with = whole, in_use = whole;
    if (called && effect.take_away) effect.take_away(without.scene);
    for (const Wish wish : effect.wishes) without.scene.effects.*wish = std::nullopt;
    if (called && !effect.take_away)
        for (const Wish wish : effect.wishes) without.scene.effects.*wish = false;
    for (const Wish wish : effect.alongside) without.scene.effects.*wish = true;
    with.scene = without.scene;
    for (const Wish wish : effect.wishes) with.scene.effects.*wish = true;
    bool needs_other_solver = false;
    if (chooses_solver && is_of(effect, &EffectOverrides::friction) &&
        with.scene.accuracy.solver == Solver::impulse) {  // which has friction in impacts alone
        Scene free = with.scene;
        free.accuracy.solver = Solver::automatic;
        needs_other_solver = make_simulation(free, with.machine)->plan().solver != name_of(Solver::impulse);
        if (needs_other_solver) with.scene = std::move(free);
    }
    if (const std::string reason = reason_for_no_price(effect, with.scene, without.scene, whole.machine);
        !reason.empty()) {
        json["no_price"] = reason;
        bar.update(turns += repeats);
        return json;
    }
    json["compared"] = called && effect.take_away
                           ? joined("the scene with ", effect.instead_of, ", effect forced on against off")
                           : joined("the scene with the effect forced on against off");
    if (needs_other_solver) json["solver_with"] = make_simulation(with.scene, with.machine)->plan().solver;
    const bool measures_use = called && effect.take_away;
    for (int round = 0; round < repeats; ++round) {
        if (is_interrupted()) return nullptr;
        std::vector<Runner*> order{&without, &with};
        if (round % 2 == 1) std::swap(order[0], order[1]);
        if (measures_use) order.insert(round % 2 == 1 ? order.begin() : order.end(), &in_use);
        for (Runner* runner : order) runner->take_turn();
        bar.update(++turns);
    }
    json.update(difference_json(without, with));
    json.update(additions_json(without, with));
    json["same_bits"] = with.hash == without.hash;
    if (measures_use) json["in_use"] = difference_json(without, in_use);
    return json;
}

}  // namespace

Json measure_prices(const Scene& asked, const PriceOptions& options) {
    if (asked.accuracy.solver == Solver::pairwise)
        throw UsageError("prices: the naive engine (solver pairwise) has no effect that can be left out");
    if (asked.bodies.empty()) throw UsageError("prices: the scene has no bodies");
    const auto simulation = make_simulation(asked, options.machine);
    const Plan plan = simulation->plan();
    const std::int64_t turns_in_all =
        options.repeats * static_cast<std::int64_t>(priced_effects().size() + 1);
    Json json = measure::result_header("prices");
    json["scene"] = asked.name;
    json["bodies"] = asked.bodies.size();
    json["dt"] = asked.step.dt;
    json["solver"] = plan.solver;
    json["substeps"] = plan.substeps;
    json["precision"] = plan.precision;
    json["isa"] = plan.isa;
    json["threads"] = plan.threads;
    json["clock"] = options.machine.threads == 1 ? "processor time" : "time on the wall";
    {
        ProgressBar bar(asked.step.count, true);
        std::int64_t done = 0;
        while (done < asked.step.count && !is_interrupted())
            simulation->step(asked.step.dt), bar.update(++done);
        json["steps_before"] = done;
    }
    json["steps_of_a_turn"] = kStepsOfATurn;
    json["repeats"] = options.repeats;
    json["method"] = kMethod;

    Runner whole{scene_of_state(asked, *simulation), options.machine};
    const bool chooses_solver = asked.accuracy.solver == Solver::automatic;
    whole.scene.accuracy.solver = *solver_named(plan.solver);  // the same on both sides where it can be
    ProgressBar bar(turns_in_all, true, "turn");
    std::int64_t turns = 0;
    Runner alone = whole;
    for (int round = 0; round < options.repeats && !is_interrupted(); ++round)
        alone.take_turn(), bar.update(++turns);
    json["effects"] = Json::array();
    if (alone.seconds.empty()) return json;
    json["ns_per_body_step"] =
        spread_json(scaled(alone.seconds, kNano / static_cast<double>(asked.bodies.size())));
    for (const PricedEffect& effect : priced_effects())
        if (Json price = price_of(effect, whole, plan, chooses_solver, options.repeats, bar, turns);
            !price.is_null())
            json["effects"].push_back(std::move(price));
    return json;
}

std::string prices_text(const Json& prices) {
    const auto word = [&](const char* key) { return prices.at(key).get<std::string>(); };
    const auto whole = [&](const char* key) {
        return static_cast<long long>(prices.at(key).get<std::int64_t>());
    };
    std::string text = format(
        "%s: %lld bodies after %lld steps, solver %s, %s precision, %s, %lld thread%s; ",
        word("scene").c_str(), whole("bodies"), whole("steps_before"), word("solver").c_str(),
        word("precision").c_str(), word("isa").c_str(), whole("threads"), whole("threads") == 1 ? "" : "s");
    if (!prices.contains("ns_per_body_step")) return joined(text, "ended before anything was measured\n");
    text += format("%.4g ns a body a step\n\n", prices.at("ns_per_body_step").at("median").get<double>());
    text += format("  %-22s %-6s %9s %8s %-20s %12s %6s  %s\n", "effect", "called", "ns a body", "% step",
                   "(95 %)", "in use, %", "bytes", "adds");
    for (const Json& effect : prices.at("effects")) {
        const std::string name = effect.at("name").get<std::string>();
        const char* called = effect.at("called").get<bool>() ? "yes" : "no";
        if (effect.contains("no_price")) {
            text += format("  %-22s %-6s %s\n", name.c_str(), called,
                           effect.at("no_price").get<std::string>().c_str());
            continue;
        }
        const Json& share = effect.at("share");
        const auto percent = [](const Json& value) { return 100 * value.get<double>(); };
        std::string adds;
        for (const char* key : {"columns", "stages"})
            for (const Json& each : effect.at(key))
                adds += joined(adds.empty() ? "" : ", ", each.get<std::string>());
        for (const Json& each : effect.at("kernels")) {
            const std::string kernel = each.get<std::string>();
            adds += joined(adds.empty() ? "" : ", ", "another ", kernel.substr(0, kernel.find(':')));
        }
        const std::string in_use =
            effect.contains("in_use") ? format("%+.1f", percent(effect.at("in_use").at("share").at("median")))
                                      : "";
        if (effect.contains("solver_with"))
            adds += joined(adds.empty() ? "" : ", ", "solver ", effect.at("solver_with").get<std::string>());
        text +=
            format("  %-22s %-6s %9.3g %+8.1f %-20s %12s %6.0f  %s%s\n", name.c_str(), called,
                   effect.at("ns_per_body_step").at("median").get<double>(), percent(share.at("median")),
                   format("(%+.1f to %+.1f)", percent(share.at("low")), percent(share.at("high"))).c_str(),
                   in_use.c_str(), effect.at("memory_bytes_per_body").get<double>(),
                   adds.empty() ? "nothing" : adds.c_str(),
                   effect.at("same_bits").get<bool>() ? "" : "; the motion differs");
    }
    return joined(text, "\n", word("method"), "\n");
}

}  // namespace carom::tool
