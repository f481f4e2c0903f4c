#pragma once

#include <stdexcept>
#include <string>

namespace carom::tool {

/// What the program tells whoever started it; docs/results.md lists the cases.
enum ExitCode : int {
    kDone = 0,           ///< done, also when ended early by Ctrl-C
    kDoubtful = 1,       ///< the run finished, but something is wrong with the result
    kWrongInput = 2,     ///< scene, options or output folder cannot be used: nothing was written
    kInternalError = 3,  ///< not finished, or the answer not printed: disk full, out of memory, a fault
};

/// The command line asks for something that cannot be: ends the program with `kWrongInput`.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A result file could not be written to its end: ends the program with `kInternalError`.
class WriteError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A page, picture or video could not be written; the results it was to be made of are there. Ends the
/// program with `kInternalError`.
class OutputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace carom::tool
