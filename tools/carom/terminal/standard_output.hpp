#pragma once

#include <string>

namespace carom::tool {

/// To be called first. A standard stream that was closed gets a place holder, which cannot be read or written
/// but for standard error, which then goes nowhere: else a result file would get its number, and the
/// program's text.
void hold_standard_streams();

/// From here on all results are in files under their final names; what is printed only repeats them. That
/// the reader of standard output has gone is no reason to end, let alone to fail. @param where  "out/seed"
void note_results_in(std::string where);

/// The exit code of a program that is through with `code`: if what it printed was lost, and stands nowhere
/// else, kInternalError. Says on standard error what was lost.
int checked_output(int code);

}  // namespace carom::tool
