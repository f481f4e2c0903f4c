#pragma once

#include <vector>

#include "parallel/executor.hpp"
#include "solvers/paths/path_solver.hpp"
#include "state/books.hpp"

namespace carom {

/// Books the work of the impulses that the contacts of convex shapes had in a substep, by mean velocities;
/// the impulses of walls alone if the ledger is closed. Cost: about 20 ns a contact.
/// @param parts  room for the books of some contacts each
template <class Real>
void book_paths(const PathSolver<Real>& paths, const BodyRecords<Real>& records, Books& books,
                std::vector<Books>& parts, const Executor& executor);

}  // namespace carom
