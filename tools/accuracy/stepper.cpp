#include "accuracy/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "accuracy/engines.hpp"
#include "simulation/body_mass.hpp"
#include "terminal/format.hpp"

namespace carom::accuracy {
namespace {

double processor_seconds() {
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Scene with_setting(Scene scene, const Setting& setting) {
    scene.accuracy.solver = setting.solver;
    scene.accuracy.precision = setting.precision;
    scene.accuracy.substeps = setting.substeps;
    return scene;
}

}  // namespace

Stepper::Stepper(const Scene& scene, const Setting& setting, double longest, bool counts)
    : scene_(scene),
      setting_(setting),
      longest_(longest),
      simulation_(setting.engine.empty() ? tool::make_simulation(with_setting(scene, setting), {.threads = 1})
                                         : make_engine_simulation(scene, setting, counts)) {}

double Stepper::kinetic_energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
        sum += tool::kinetic_energy_of(scene_.bodies[i], state(i));
    return sum;
}

double Stepper::energy() const {
    double sum = kinetic_energy();
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
        const Vec2 x = state(i).position;
        sum -= tool::mass_of(scene_.bodies[i]) * (scene_.gravity.x * x.x + scene_.gravity.y * x.y);
    }
    return sum;
}

void Stepper::advance_to(double time) {
    // In a few parts, so that the number of candidate pairs is seen now and then.
    constexpr std::int64_t kMostStepsUnseen = 16;
    const std::int64_t until = std::llround(time / setting_.dt);
    while (steps_ < until) {
        const std::int64_t part = std::min(until - steps_, kMostStepsUnseen);
        const double start = processor_seconds();
        for (std::int64_t i = 0; i < part; ++i) simulation_->step(setting_.dt);
        seconds_ += processor_seconds() - start;
        steps_ += part;
        if (seconds_ > longest_)
            throw Failure(tool::format("given up after %.1f s of work, %.3g s into it", seconds_,
                                       static_cast<double>(steps_) * setting_.dt));
        const auto pairs = static_cast<double>(simulation_->profile().candidate_pairs);
        pair_tests_ += pairs * static_cast<double>(part * setting_.substeps);
    }
    check();
}

void Stepper::check() const {
    if (const auto lost = simulation_->quarantined(); !lost.empty())
        throw Failure(tool::format("body %zu was lost after %g s: its state left the limits", lost.front(),
                                   simulation_->time()));
    for (std::size_t body = 0; body < simulation_->body_count(); ++body) {
        const BodyState s = simulation_->state(body);
        if (!std::isfinite(s.position.x + s.position.y + s.velocity.x + s.velocity.y + s.angular_velocity))
            throw Failure(tool::format("body %zu is not a number after %g s", body, simulation_->time()));
    }
}

Work Stepper::work() const {
    Work work;
    if (!setting_.engine.empty()) return work;
    const Profile profile = simulation_->profile();
    work.body_substeps = static_cast<double>(simulation_->body_count()) * static_cast<double>(steps_) *
                         static_cast<double>(setting_.substeps);
    work.impacts = static_cast<double>(profile.impacts);
    work.pair_tests = profile.pair_tests > 0 ? static_cast<double>(profile.pair_tests) : pair_tests_;
    return work;
}

}  // namespace carom::accuracy
