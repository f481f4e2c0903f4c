#pragma once

#include <cstring>

#include "state/columns/column.hpp"

namespace carom::test {

template <class T>
bool have_equal_bits(const Column<T>& p, const Column<T>& q) {
    return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof(T)) == 0;
}

}  // namespace carom::test
