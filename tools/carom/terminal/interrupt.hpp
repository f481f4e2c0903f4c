#pragma once

namespace carom::tool {

/// From here on the first Ctrl-C (or SIGTERM; or SIGHUP, unless it is ignored as under nohup) only sets a
/// flag, which the run looks at between steps; a second one ends the program at once. A file size limit
/// (SIGXFSZ) becomes an error of the write itself.
void catch_interrupts();

/// Whether the run was asked to end.
bool is_interrupted() noexcept;

}  // namespace carom::tool
