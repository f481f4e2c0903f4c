#include "torture/envelopes/envelope.hpp"

#include <carom/errors.hpp>

#include "measure/clocks.hpp"
#include "measure/text.hpp"
#include "torture/add_runs.hpp"
#include "torture/run_tasks.hpp"
#include "torture/runs.hpp"
#include "torture/verdicts.hpp"
#include "torture/watched_run.hpp"

namespace carom::torture {
namespace {

/// Tries values of an envelope under one solver, for every seed, as long as the budget lasts.
class Prober {
  public:
    /// @param budget  s of processor time
    Prober(const Envelope& envelope, Solver solver, Precision precision, double budget)
        : envelope_(envelope),
          solver_(solver),
          precision_(precision),
          end_(measure::thread_seconds() + budget) {}

    Verdict operator()(double value, std::string& why) const {
        for (const std::uint64_t seed : envelope_.seeds) {
            const double left = end_ - measure::thread_seconds();
            if (!(left > 0)) return Verdict::out_of_time;
            Outcome outcome;
            try {
                WatchedRun run(envelope_.make(value, seed), solver_, precision_, left);
                outcome.measures = envelope_.run(run, value);
                if (run.watch().gave_up()) return Verdict::out_of_time;
            } catch (const Error& error) {
                outcome.failure = error.what();
            }
            if (outcome.passes()) continue;
            why = measure::joined(reason_of(outcome), measure::format(", seed %d", static_cast<int>(seed)));
            return Verdict::fails;
        }
        return Verdict::holds;
    }

  private:
    const Envelope& envelope_;
    Solver solver_;
    Precision precision_;
    double end_;  // s, of this process's time
};

Outcome run(const Envelope& envelope, Solver solver, Precision precision, const Options& asked) {
    Range range = envelope.range;
    if (asked.is_quick) range.last = range.first;  // whether anything holds at all
    const auto outcome_of = [](const Bracket& bracket) { return Outcome{.bracket = bracket}; };
    return outcome_of(bracket_of(range, Prober(envelope, solver, precision, asked.limit),
                                 [&](const Bracket& bracket) { keep_so_far(outcome_of(bracket)); }));
}

std::vector<Task> tasks(const Options& asked) {
    std::vector<Task> all;
    for (const Envelope& each : all_envelopes())
        if (is_named(asked, each.name)) {
            const Scene first = each.make(each.range.first, each.seeds.front());
            add_runs(all, {.case_id = "envelopes",
                           .scene = each.title,
                           .solvers = solvers_of(asked, every_solver_for(first)),
                           .precisions = precisions_of(asked),
                           .make = [first] { return first; },
                           .run = [each, asked](
                                      const Scene&, Solver solver,
                                      Precision precision) { return run(each, solver, precision, asked); }});
        }
    return all;
}

}  // namespace

Case envelopes() {
    return {.id = "envelopes",
            .title = "where each solver stops holding as one thing gets harder and harder",
            .is_matrix = true,
            .tasks = tasks};
}

}  // namespace carom::torture
