#pragma once

#include <carom/events.hpp>

#include <filesystem>
#include <string>

#include "results/text_file.hpp"

namespace carom::tool {

/// What happened in a run, one row an event, in the order of time.
class EventsCsv {
  public:
    explicit EventsCsv(const std::filesystem::path& path);

    /// The events of a step. @param dt  s, its length  @throws WriteError
    void append(const Events& events, double dt);
    void close() { file_.close(); }

  private:
    TextFile file_;
};

}  // namespace carom::tool
