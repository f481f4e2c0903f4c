#pragma once

#include "report/kinds/run_page.hpp"

namespace carom::report {

/// What the scene called for and why, settings, energies, contacts.
void add_summary_tables(const Json& summary, Page& page);

/// The state of the first bodies at the end.
void add_body_table(const RunFiles& files, Page& page);

}  // namespace carom::report
