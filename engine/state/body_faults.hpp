#pragma once

#include <type_traits>

#include "state/bodies.hpp"

namespace carom {

/// What the kernels take for granted of the columns of bodies, for assertions: all have a row a body, and the
/// rows behind these, which kernels read by whole batches, are zero.
///
/// Cost: O(columns), about 20 ns.
/// @return what is wrong, null if nothing is
template <class Real>
const char* fault_of(const Bodies<Real>& bodies) {
    if (bodies.standing > bodies.count) return "more bodies stand than there are";
    const char* fault = nullptr;
    bodies.for_each_column([&](auto, auto, const auto& column) {
        using Value = std::remove_cvref_t<decltype(*column.data())>;
        if (column.size() != bodies.rows()) fault = "columns of bodies differ in length";
        if (column.capacity() == 0) return;
        for (std::size_t row = column.size(); row < held(column.size()); ++row)
            if (!(column.data()[row] == Value{})) fault = "padding of bodies is not zero";
    });
    return fault;
}

}  // namespace carom
