#include "parallel/executor.hpp"

#include <atomic>
#include <memory>
#include <stdexcept>
#include <vector>

#include <doctest/doctest.h>

namespace test_phases {

using namespace carom;

namespace {

constexpr double kLong = 1e6;  // ns: no loop is too short for threads

/// Runs phases, and each task looks whether those that it depends on have run, and once.
class Watch {
  public:
    Watch(std::vector<PhaseKind> phases, std::size_t tasks)
        : phases_(std::move(phases)), tasks_(tasks), runs_(new std::atomic<int>[phases_.size() * tasks]) {}

    void run(const Executor& executor) {
        for (std::size_t i = 0; i < phases_.size() * tasks_; ++i) runs_[i] = 0;
        executor.for_each_phase(phases_, tasks_, kLong,
                                [&](std::size_t phase, std::size_t task) { look(phase, task); });
        for (std::size_t phase = 0; phase < phases_.size(); ++phase)
            for (std::size_t task = 0; task < tasks_in(phase); ++task)
                once_ = once_ && runs_[phase * tasks_ + task] == 1;
    }
    bool all_ran_once() const { return once_; }
    bool all_in_order() const { return in_order_; }

  private:
    std::size_t tasks_in(std::size_t phase) const { return phases_[phase] == PhaseKind::alone ? 1 : tasks_; }
    bool has_run(std::size_t phase, std::size_t task) const { return runs_[phase * tasks_ + task] > 0; }

    void look(std::size_t phase, std::size_t task) {
        bool in_order = true;
        if (phase > 0) {
            const bool all = phases_[phase] == PhaseKind::alone || phases_[phase - 1] == PhaseKind::alone;
            for (std::size_t other = 0; other < tasks_in(phase - 1); ++other)
                if (all || (other + 1 >= task && other <= task + 1))
                    in_order = in_order && has_run(phase - 1, other);
        }
        for (int i = 0; i < (task % 3 == 0 ? 300 : 10); ++i) work_ = work_ + 1;  // some take longer
        if (!in_order) in_order_ = false;
        ++runs_[phase * tasks_ + task];
    }

    std::vector<PhaseKind> phases_;
    std::size_t tasks_;
    std::unique_ptr<std::atomic<int>[]> runs_;
    std::atomic<bool> in_order_{true};
    std::atomic<int> work_{0};
    bool once_ = true;
};

constexpr PhaseKind kSide = PhaseKind::side_by_side, kAlone = PhaseKind::alone;

}  // namespace

TEST_SUITE("parallel/phases") {
    TEST_CASE("a task runs once, after those of the phase before that are beside it") {
        const std::vector<std::vector<PhaseKind>> rows{{kSide},
                                                       {kAlone},
                                                       {kSide, kSide},
                                                       {kAlone, kSide},
                                                       {kSide, kSide, kSide, kSide, kSide, kSide, kSide},
                                                       {kSide, kAlone, kSide, kAlone, kAlone, kSide, kSide}};
        for (const int threads : {1, 2, 3, 5}) {
            const Executor executor(threads);
            for (const std::vector<PhaseKind>& phases : rows)
                for (const std::size_t tasks : {1ul, 2ul, 3ul, 5ul, 16ul, 65ul}) {
                    CAPTURE(threads);
                    CAPTURE(phases.size());
                    CAPTURE(tasks);
                    Watch watch(phases, tasks);
                    for (int i = 0; i < 10; ++i) watch.run(executor);
                    executor.with_team([&] {
                        for (int i = 0; i < 10; ++i) watch.run(executor);
                    });
                    CHECK(watch.all_ran_once());
                    CHECK(watch.all_in_order());
                }
        }
    }

    TEST_CASE("an embedding program's threads take one phase after the other") {
        const ParallelFor backwards = [](std::size_t count, const std::function<void(std::size_t)>& task) {
            for (std::size_t i = count; i-- > 0;) task(i);
        };
        Watch watch({kSide, kSide, kAlone, kSide}, 7);
        watch.run(Executor(0, backwards));
        CHECK(watch.all_ran_once());
        CHECK(watch.all_in_order());
    }
}

TEST_SUITE("parallel/team") {
    TEST_CASE("loops of a team do all their tasks, in teams of any size one after the other") {
        const Executor executor(4);
        std::vector<int> runs(1000, 0);
        for (int i = 0; i < 20; ++i) {
            executor.with_team([&] {
                executor.with_team([&] {  // they are there already
                    for (int k = 0; k < 5; ++k)
                        executor.for_each_task(1000, kLong, [&](std::size_t task) { ++runs[task]; });
                });
                executor.for_each_task(2, kLong, [&](std::size_t task) { ++runs[task]; });
            });
            executor.for_each_task(1000, kLong, [&](std::size_t task) { ++runs[task]; });
        }
        CHECK(runs == [] {
            std::vector<int> expected(1000, 120);
            expected[0] = expected[1] = 140;
            return expected;
        }());
    }

    TEST_CASE("what goes wrong while a team stands by reaches the caller, and the team goes home") {
        const Executor executor(3);
        CHECK_THROWS_AS(executor.with_team([] { throw std::runtime_error("no"); }), std::runtime_error);
        std::atomic<int> count = 0;
        executor.for_each_task(100, kLong, [&](std::size_t) { ++count; });
        CHECK(count == 100);
    }
}

}  // namespace test_phases
