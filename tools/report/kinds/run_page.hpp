#pragma once

#include "report/page/page.hpp"
#include "report/readers/run_files.hpp"

namespace carom::report {

/// Draws a run: warnings, the player, charts, tables. Frames are read while the page is written, one at a
/// time, so the files have to stay until then.
/// @throws ResultError, also while the page is written
void draw_run(const RunFiles& files, Page& page);

}  // namespace carom::report
