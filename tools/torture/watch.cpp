#include "torture/watch.hpp"

#include <sys/time.h>

#include <algorithm>
#include <cmath>

#include "measure/clocks.hpp"
#include "measure/statistics.hpp"
#include "measure/text.hpp"
#include "simulation/body_mass.hpp"

namespace carom::torture {
namespace {

Scene with(Scene scene, Solver solver, Precision precision) {
    scene.accuracy.solver = solver, scene.accuracy.precision = precision;
    return scene;
}

bool is_dynamic(const Body& body) {
    return body.type == BodyType::dynamic_body;
}

std::int64_t* step_in_progress = nullptr;

/// The system ends this process after so much more processor time [s].
void allow(double seconds) {
    const auto whole = static_cast<time_t>(seconds) + 1;
    const itimerval timer{{0, 0}, {whole, 0}};
    setitimer(ITIMER_PROF, &timer, nullptr);
}

}  // namespace

void watch_over_steps(std::int64_t* step) {
    step_in_progress = step;
}

Watch::Watch(const Scene& scene, Solver solver, Precision precision, double limit)
    : scene_(with(scene, solver, precision)),
      limit_(limit),
      simulation_(tool::make_simulation(scene_, {.threads = 1})) {
    for (const Body& body : scene_.bodies) masses_.push_back(body_mass_of(body));
}

bool Watch::step(double dt) {
    if (gave_up()) return false;
    if (step_in_progress) {
        *step_in_progress = steps();
        allow(limit_);
    }
    const double start = measure::thread_seconds();
    simulation_->step(dt);
    seconds_.push_back(measure::thread_seconds() - start);
    spent_ += seconds_.back();
    const bool sleeps = scene_.effects.sleep.value_or(false) && simulation_->profile().asleep > 0;
    is_awake_.push_back(!sleeps);
    return true;
}

bool Watch::advance_to(double time) {
    while (simulation_->time() < time - 0.5 * scene_.step.dt)
        if (!step()) return false;
    return true;
}

double Watch::median_step() const {
    return seconds_.empty() ? 0 : measure::quantile(seconds_, 0.5);
}

double Watch::longest_step() const {
    return seconds_.empty() ? 0 : *std::max_element(seconds_.begin(), seconds_.end());
}

double Watch::stall() const {
    constexpr double kLeastMedian = 2e-4;  // s
    std::vector<double> awake;             // s
    for (std::size_t i = 0; i < seconds_.size(); ++i)
        if (is_awake_[i]) awake.push_back(seconds_[i]);
    const double median = awake.empty() ? median_step() : measure::quantile(awake, 0.5);
    return longest_step() / std::fmax(median, kLeastMedian);
}

void Watch::take_shorter_times(const Watch& again) {
    for (std::size_t i = 0; i < std::min(seconds_.size(), again.seconds_.size()); ++i)
        seconds_[i] = std::fmin(seconds_[i], again.seconds_[i]);
}

std::string Watch::failure() const {
    if (!gave_up()) return {};
    return measure::format("given up after %lld steps, which took %.0f s", static_cast<long long>(steps()),
                           spent_);
}

double Watch::kinetic_energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
        if (is_dynamic(scene_.bodies[i])) sum += tool::kinetic_energy_of(masses_[i], state(i));
    return sum;
}

double Watch::rms_speed() const {
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
        if (!is_dynamic(scene_.bodies[i])) continue;
        const Vec2 v = state(i).velocity;
        squares += v.x * v.x + v.y * v.y, count += 1;
    }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

double Watch::mean_height() const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
        if (is_dynamic(scene_.bodies[i])) sum += state(i).position.y, count += 1;
    return count > 0 ? sum / count : 0;
}

std::size_t Watch::not_finite() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
        const BodyState s = state(i);
        count += !std::isfinite(s.position.x + s.position.y + s.angle + s.velocity.x + s.velocity.y +
                                s.angular_velocity);
    }
    return count;
}

std::size_t Watch::outside(const Enclosure& enclosure, const BodyState& pose) const {
    const double cos = std::cos(pose.angle), sin = std::sin(pose.angle);
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
        if (!is_dynamic(scene_.bodies[i]) || scene_.bodies[i].sensor) continue;
        const Vec2 at = state(i).position, from{at.x - pose.position.x, at.y - pose.position.y};
        count += !(enclosure.clearance({cos * from.x + sin * from.y, cos * from.y - sin * from.x}) > 0);
    }
    return count;
}

EnergyBooks::EnergyBooks(const Watch& watch, const Scene& scene, std::vector<double> lowest,
                         const EnergySources& sources, double least)
    : lowest_(std::move(lowest)), sources_(sources), least_(least) {
    for (const Body& body : scene.bodies)
        weight_.push_back(is_dynamic(body) ? -scene.gravity.y * tool::mass_of(body) : 0);
    start_ = energy(watch);
}

double EnergyBooks::energy(const Watch& watch) const {
    double potential = 0;
    for (std::size_t i = 0; i < weight_.size(); ++i)
        if (weight_[i] != 0) potential += weight_[i] * (watch.state(i).position.y - lowest_[i]);
    return watch.kinetic_energy() + potential;
}

double EnergyBooks::given(const EnergyByCause& cause) {
    double given = 0, turnover = sources_.falls ? std::fabs(cause.gravity) : 0;
    const auto add = [&](bool is_source, double energy) {
        if (is_source) given += energy, turnover += std::fabs(energy);
    };
    add(sources_.drives, cause.drive), add(sources_.joints, cause.joints);
    add(sources_.overlaps, cause.correction);
    turnover_ = std::fmax(turnover_, turnover);
    return given;
}

void EnergyBooks::look(const Watch& watch) {
    const bool has_causes = watch.simulation().keeps_ledger();
    const Ledger ledger = has_causes ? watch.simulation().ledger() : Ledger{};
    const EnergyByCause& cause = ledger.energy_by_cause;
    const double more = energy(watch) - start_ - given(cause);
    const double rise = more == 0 ? 0 : more / std::fmax(least_, start_ + turnover_);
    if (!(rise <= rise_)) rise_ = rise;  // not a number stays
    if (!has_causes) return;
    restitution_gain_ += std::fmax(0, cause.restitution - last_restitution_) / start_;
    last_restitution_ = cause.restitution, excess_ = ledger.energy_excess;
    correction_gain_ = std::fmax(correction_gain_, cause.correction / start_);
}

void tell_times(Outcome& outcome, const Watch& watch) {
    constexpr double kMilliseconds = 1e3;
    const double median = watch.median_step(), longest = watch.longest_step();
    outcome.measures.push_back({"median ms", kMilliseconds * median});
    outcome.measures.push_back({"worst ms", kMilliseconds * longest});
    outcome.measures.push_back({"worst/median", median > 0 ? longest / median : 0});
}

}  // namespace carom::torture
