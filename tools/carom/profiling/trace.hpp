#pragma once

#include <carom/profile.hpp>

#include <cstdint>
#include <string>

#include "measure/json.hpp"

namespace carom::tool {

/// Times of steps and their stages in the trace event format, which Perfetto and Chrome's about:tracing read.
/// A stage that runs in each of several substeps is one event with the sum of its times.
class Trace {
  public:
    /// Steps that are kept; a file of more would take long to open.
    static constexpr std::int64_t kMostSteps = 5000;

    /// Adds one step from the profiles before and after it.
    void add_step(const Profile& before, const Profile& after);

    std::int64_t steps() const { return steps_; }
    /// The file's text. @param scene  named as the process
    std::string text(const std::string& scene) const;

  private:
    void add_event(std::string_view name, double start, double seconds, measure::Json arguments);

    measure::Json events_ = measure::Json::array();
    double time_ = 0;  // s, end of the last step
    std::int64_t steps_ = 0;
};

}  // namespace carom::tool
