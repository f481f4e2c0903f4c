#pragma once

#include <stdexcept>

namespace carom::report {

/// A result file that cannot be read or drawn; the message names it and what was expected.
class ResultError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace carom::report
