#include "sleeping/islands.hpp"

#include <numeric>

namespace carom {

void Islands::reset(std::size_t rows) {
    parent_.resize(rows);
    std::iota(parent_.begin(), parent_.end(), 0);
}

}  // namespace carom
