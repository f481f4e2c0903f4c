#include "profiling/shared_loops.hpp"

#include <algorithm>

#include "measure/clocks.hpp"

namespace carom::tool {

SharedLoops::Seconds SharedLoops::Seconds::operator-(const Seconds& other) const {
    Seconds difference{.inside = inside - other.inside, .tasks = tasks - other.tasks};
    for (std::size_t k = 0; k < kCores.size(); ++k) difference.on_cores[k] = on_cores[k] - other.on_cores[k];
    return difference;
}

ParallelFor SharedLoops::parallel_for() {
    return [this](std::size_t count, const std::function<void(std::size_t)>& task) { run(count, task); };
}

void SharedLoops::run(std::size_t count, const std::function<void(std::size_t)>& task) {
    const double start = measure::wall_seconds();
    ends_.assign(1, start);
    for (std::size_t i = 0; i < count; ++i) {
        task(i);
        ends_.push_back(measure::wall_seconds());
    }
    seconds_.tasks += ends_.back() - start;
    for (std::size_t k = 0; k < kCores.size(); ++k) {
        double longest = 0;
        for (std::size_t thread = 0; thread < kCores[k]; ++thread)
            longest = std::max(longest,
                               ends_[(thread + 1) * count / kCores[k]] - ends_[thread * count / kCores[k]]);
        seconds_.on_cores[k] += longest;
    }
    seconds_.inside += measure::wall_seconds() - start;
}

}  // namespace carom::tool
