#pragma once

#include <span>
#include <string>

#include "torture/case.hpp"

namespace carom::torture {

/// The rows of one case as tables; a number beyond its mark has a ! behind it.
std::string table_of(const Case& of, std::span<const Row> rows);

}  // namespace carom::torture
