#pragma once

#include "report/page/page.hpp"
#include "report/readers/run_files.hpp"

namespace carom::report {

/// Adds the player of a run's trajectory to the page, with words on what it leaves out.
/// @throws ResultError
void add_player(const RunFiles& files, Page& page);

}  // namespace carom::report
