#pragma once

#include "isa/kernel_table.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace carom {

/// Compiled in, whether this machine can run them or not, slowest first.
std::vector<std::string> built_instruction_sets();

/// Compiled in and runnable on this machine, slowest first.
std::vector<const KernelTables*> runnable_kernel_tables();

/// @param isa  "auto": what CAROM_ISA in the environment says, else the best; or a name.
/// @throws Error (unsupported_isa) listing what there is.
const KernelTables& select_kernels(std::string_view isa);

}  // namespace carom
