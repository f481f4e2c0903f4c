#pragma once

#include <carom/world.hpp>

#include <cstddef>
#include <functional>

namespace carom::test {

/// Tasks of two threads one by one, the last first: what depends on an order or on threads shows, and a busy
/// machine does not make the test slow.
inline WorldOptions in_other_order(WorldOptions options) {
    options.threads = 2;
    options.parallel_for = [](std::size_t count, const std::function<void(std::size_t)>& task) {
        while (count-- > 0) task(count);
    };
    return options;
}

}  // namespace carom::test
