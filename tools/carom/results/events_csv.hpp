#pragma once

#include <carom/events.hpp>

#include <filesystem>
#include <string>

#include "results/text_file.hpp"

namespace carom::tool {

/// What happened in a run, one row an event.
class EventsCsv {
  public:
    explicit EventsCsv(const std::filesystem::path& path);

    /// @throws WriteError
    void append(const Events& events);
    void close() { file_.close(); }

  private:
    TextFile file_;
    std::string line_;
};

}  // namespace carom::tool
