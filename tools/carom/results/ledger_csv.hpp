#pragma once

#include <carom/ledger.hpp>

#include <cstdint>
#include <filesystem>
#include <string>

#include "results/text_file.hpp"

namespace carom::tool {

/// The books of a run, one row a step: energies and momentum then, and both by cause since the start.
class LedgerCsv {
  public:
    explicit LedgerCsv(const std::filesystem::path& path);

    /// @throws WriteError
    void append(const Ledger& ledger, std::int64_t impacts);
    void close() { file_.close(); }

  private:
    TextFile file_;
    std::string line_;
};

}  // namespace carom::tool
