#pragma once

#include <string>
#include <vector>

namespace carom::torture {

/// What may be asked for of `hard` and `envelopes`: codes and names, each once.
std::vector<std::string> names_of_rows();

}  // namespace carom::torture
