#pragma once

#include <cstddef>
#include <string>

#include "measure/json.hpp"

namespace carom::measure {

/// Size of the first core's data cache of that level, 1 to 3 [bytes]; 0 if the system does not say.
std::size_t cache_bytes(int level);

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
