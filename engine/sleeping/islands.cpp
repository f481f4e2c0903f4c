#include "sleeping/islands.hpp"

#include <numeric>

namespace carom {

void Islands::reset(std::size_t rows) {
    parent_.resize(rows);
    std::iota(parent_.begin(), parent_.end(), 0);
}

std::int32_t Islands::island_of(std::int32_t row) {
    auto i = static_cast<std::size_t>(row);
    while (parent_[i] != static_cast<std::int32_t>(i)) {
        parent_[i] = parent_[static_cast<std::size_t>(parent_[i])];
        i = static_cast<std::size_t>(parent_[i]);
    }
    return static_cast<std::int32_t>(i);
}

void Islands::join(std::int32_t a, std::int32_t b) {
    a = island_of(a), b = island_of(b);
    if (a < b)
        parent_[static_cast<std::size_t>(b)] = a;
    else
        parent_[static_cast<std::size_t>(a)] = b;
}

}  // namespace carom
