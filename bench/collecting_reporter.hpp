#pragma once

#include <benchmark/benchmark.h>
#include <iosfwd>
#include <vector>

#include "measure/json.hpp"

namespace carom::bench {

/// Prints nothing and keeps every run as JSON.
class CollectingReporter : public benchmark::BenchmarkReporter {
  public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override;
    const measure::Json& runs() const { return runs_; }

  private:
    measure::Json runs_ = measure::Json::array();
};

}  // namespace carom::bench
