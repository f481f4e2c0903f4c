#include "collecting_reporter.hpp"

#include <string>

namespace carom::bench {

void CollectingReporter::ReportRuns(const std::vector<Run>& runs) {
    for (const Run& run : runs) {
        if (run.error_occurred) continue;  // left out on purpose: the message says what is missing
        const auto iterations = static_cast<double>(run.iterations);
        measure::Json json{{"name", run.benchmark_name()},
                           {"iterations", run.iterations},
                           {"cpu_seconds", run.cpu_accumulated_time / iterations},
                           {"wall_seconds", run.real_accumulated_time / iterations}};
        for (const auto& [name, counter] : run.counters) json[name] = counter.value;
        runs_.push_back(std::move(json));
    }
}

}  // namespace carom::bench
