#pragma once

#include <string>

#include "measure/json.hpp"

namespace carom::measure {

/// What figures depend on: processor, cores, caches, memory, operating system, compiler, version of the
/// library. Properties of a machine, no names of machines.
Json machine_properties();

/// The same short enough for the name of a folder: "amd-epyc-2-cores-avx512-32-mib-l3".
std::string machine_label(const Json& properties);

/// Today, "2026-11-21" (UTC).
std::string today();

/// What every result file of this folder starts with.
Json result_header(const std::string& kind);

}  // namespace carom::measure
