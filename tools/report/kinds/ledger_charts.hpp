#pragma once

#include "report/page/page.hpp"
#include "report/readers/csv_reader.hpp"

namespace carom::report {

/// Energy, momentum, the ledger by cause and its unexplained rest over time, from the columns of ledger.csv.
void add_ledger_charts(const NumberTable& ledger, Page& page);

/// Touching contacts and their overlaps over time, from "contacts_over_time" of summary.json.
void add_contact_charts(const Json& summary, Page& page);

}  // namespace carom::report
