#pragma once

#include <functional>
#include <span>
#include <vector>

#include "torture/case.hpp"

namespace carom::torture {

/// Runs every task in a process of its own, so that one that crashes, or stays in a step for ever, is a row
/// with a failure. Worlds run on one thread each.
/// @param processes  at a time
/// @param report  called whenever a task has ended, with the number of those that have
/// @param stop    asked now and then; then those that run are ended, and the rows so far are returned
/// @return in the order of the tasks
/// @throws std::runtime_error if the system gives no process or pipe
std::vector<Row> run_tasks(std::span<const Task> tasks, int processes,
                           const std::function<void(std::size_t)>& report, const std::function<bool()>& stop);

/// What a task knows so far: its row, should it be ended before it returns. Nothing happens outside of tasks.
void keep_so_far(const Outcome& outcome);

}  // namespace carom::torture
