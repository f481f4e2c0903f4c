#include "parallel/executor.hpp"

#if defined(_OPENMP)
#include <omp.h>
#endif

#include <utility>

namespace carom {
namespace {

int usable_threads(int wanted, bool embedding_program_has_threads) {
    if (embedding_program_has_threads) return wanted;
#if defined(_OPENMP)
    return wanted > 0 ? wanted : omp_get_max_threads();
#else
    return 1;
#endif
}

}  // namespace

Executor::Executor(int threads, ParallelFor parallel_for)
    : threads_(usable_threads(threads, static_cast<bool>(parallel_for))),
      parallel_for_(std::move(parallel_for)) {}

void Executor::run(std::size_t chunks, Call call) const {
    if (parallel_for_) {
        parallel_for_(chunks, [call](std::size_t c) { call.invoke(call.function, c); });
        return;
    }
#if defined(_OPENMP)
    const auto count = static_cast<std::ptrdiff_t>(chunks);
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (std::ptrdiff_t c = 0; c < count; ++c) call.invoke(call.function, static_cast<std::size_t>(c));
#else
    for (std::size_t c = 0; c < chunks; ++c) call.invoke(call.function, c);
#endif
}

}  // namespace carom
