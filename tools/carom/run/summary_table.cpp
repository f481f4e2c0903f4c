#include "summary_table.hpp"

#include <cmath>

#include "scene_file/printable.hpp"
#include "simulation/body_mass.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

constexpr std::size_t kBodiesShown = 10;

std::string heading(const RunOutcome& run) {
    std::string text =
        format("%s: %zu bodies, %lld steps of %g s, %g s simulated", printable(run.scene_name).c_str(),
               run.bodies, static_cast<long long>(run.steps), run.dt, run.time);
    if (run.interrupted)
        text += format(" (interrupted; %lld steps asked)", static_cast<long long>(run.steps_asked));
    text += format("\n  solver %s (%s)\n", run.plan.solver.c_str(), run.plan.solver_reason.c_str());
    text += format("  %d substep%s", run.plan.substeps, run.plan.substeps == 1 ? "" : "s");
    if (run.plan.solver == "soft")
        text += format(" of %d iteration%s", run.plan.iterations, run.plan.iterations == 1 ? "" : "s");
    text += format(", %s precision, %s, %d thread%s\n", run.plan.precision.c_str(), run.plan.isa.c_str(),
                   run.plan.threads, run.plan.threads == 1 ? "" : "s");
    return text;
}

std::string course_line(const char* label, double first, const double* second, double last,
                        const char* unit) {
    std::string text = format("  %-18s %14.4f", label, without_minus_zero(first, 4));
    text += second != nullptr ? format(" %14.4f", without_minus_zero(*second, 4)) : format(" %14s", "");
    return text + format(" %14.4f  %s\n", without_minus_zero(last, 4), unit);
}

std::string course_table(const RunOutcome& run) {
    const Ledger& books = run.ledger;
    const Ledger* const first = run.first_step ? &*run.first_step : nullptr;
    std::string text = format("\n  %-18s %14s %14s %14s\n", "", "start", first ? "first step" : "", "last");
    const auto energy = [&](const char* label, auto&& part) {
        const double second = first ? part(first->energy) : 0;
        text += course_line(label, part(books.initial), first ? &second : nullptr, part(books.energy), "J");
    };
    energy("kinetic energy", [](const Energy& e) { return e.kinetic; });
    energy("rotational energy", [](const Energy& e) { return e.rotational; });
    energy("potential energy", [](const Energy& e) { return e.potential; });
    energy("total energy", [](const Energy& e) { return e.total(); });
    text += course_line("momentum x", books.initial_momentum.x, first ? &first->momentum.x : nullptr,
                        books.momentum.x, "kg m/s");
    text += course_line("momentum y", books.initial_momentum.y, first ? &first->momentum.y : nullptr,
                        books.momentum.y, "kg m/s");
    text += course_line("angular momentum", books.initial_angular_momentum,
                        first ? &first->angular_momentum : nullptr, books.angular_momentum, "kg m2/s");
    if (!first) return text;
    const double before = first->energy.kinetic + first->energy.rotational;
    const double after = books.energy.kinetic + books.energy.rotational;
    text += format(
        "  from the first step to the last: kinetic and rotational energy x %.4f, momentum changed by %.4f\n",
        before > 0 ? after / before : 0.0,
        std::hypot(books.momentum.x - first->momentum.x, books.momentum.y - first->momentum.y));
    return text;
}

std::string ledger_line(const EnergyByCause& work) {
    std::string text = "\n  energy by cause (J):";
    const auto add = [&text](const char* cause, double value, bool always) {
        if (value != 0 || always) text += format(" %s %.4g,", cause, value);
    };
    add("gravity", work.gravity, false);
    add("drag", work.drag, false);
    add("restitution", work.restitution, false);
    add("friction", work.friction, false);
    add("correction", work.correction, false);
    add("joints", work.joints, false);
    add("drive", work.drive, false);
    add("sleep", work.sleep, false);
    add("outside", work.outside, false);
    add("unexplained", work.unexplained, true);
    text.back() = '\n';
    return text;
}

/// What a run had of energy that neither a law nor rounding explains; nothing where it had none.
std::string excess_line(const EnergyExcess& excess) {
    std::string text;
    const auto add = [&text](double value, const char* of) {
        if (value > 0) text += format("%s %.2g J %s", text.empty() ? "" : ",", value, of);
    };
    add(excess.restitution, "by restitution in a step");
    add(excess.correction, "by correction in a step");
    add(excess.passive, "above what nothing drives began with");
    return text.empty() ? text : "  energy beyond its laws and rounding, at most:" + text + "\n";
}

std::string contact_line(const RunOutcome& run) {
    return format(
        "  contacts: %lld touching of %lld candidates; overlap %.3g %% mean, %.3g %% max of the smaller "
        "radius\n",
        static_cast<long long>(run.overlaps.touching), static_cast<long long>(run.overlaps.candidates),
        100 * run.overlaps.mean, 100 * run.overlaps.max);
}

std::string sleep_line(const Profile& profile) {
    if (profile.asleep == 0 && profile.islands_woken == 0) return "";
    return format("  asleep: %lld bodies in %lld islands; %lld islands were woken\n",
                  static_cast<long long>(profile.asleep), static_cast<long long>(profile.islands_asleep),
                  static_cast<long long>(profile.islands_woken));
}

std::string time_line(const RunOutcome& run) {
    if (run.steps == 0) return "  time: no step taken\n";
    const double step = run.stepping_seconds / static_cast<double>(run.steps);
    std::string text = format("  time: %s in all, %s a step", seconds_text(run.total_seconds).c_str(),
                              seconds_text(step).c_str());
    if (run.bodies > 0)
        text += format(", %s a body a step", seconds_text(step / static_cast<double>(run.bodies)).c_str());
    return text + format("; recording %s\n", seconds_text(run.recording_seconds).c_str());
}

}  // namespace

std::string summary_table(const RunOutcome& run) {
    std::string text = heading(run) + course_table(run);
    text += run.keeps_ledger ? ledger_line(run.ledger.energy_by_cause) + excess_line(run.ledger.energy_excess)
                             : "\n";
    text += contact_line(run) + sleep_line(run.profile) + time_line(run);
    return text;
}

std::string body_table(const Scene& scene, const Simulation& simulation) {
    std::string text = format("\n  %6s  %19s  %19s  %10s  %8s\n", "body", "position (m)", "velocity (m/s)",
                              "energy (J)", "spin");
    const std::size_t shown = std::min(kBodiesShown, scene.bodies.size());
    for (std::size_t body = 0; body < shown; ++body) {
        const BodyState state = simulation.state(body);
        text += format("  %6zu  (%8.2f,%8.2f)  (%8.2f,%8.2f)  %10.3f  %8.3f\n", body,
                       without_minus_zero(state.position.x, 2), without_minus_zero(state.position.y, 2),
                       without_minus_zero(state.velocity.x, 2), without_minus_zero(state.velocity.y, 2),
                       kinetic_energy_of(scene.bodies[body], state),
                       without_minus_zero(state.angular_velocity, 3));
    }
    if (shown < scene.bodies.size()) text += format("  ... and %zu more\n", scene.bodies.size() - shown);
    return text;
}

}  // namespace carom::tool
