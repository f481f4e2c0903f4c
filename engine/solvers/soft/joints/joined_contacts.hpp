#pragma once

#include <cstddef>
#include <vector>

#include "solvers/paths/path_solver.hpp"
#include "solvers/soft/contacts/step_view.hpp"

namespace carom {

/// The contacts of a step that can touch and have a body of a group of joints that is solved exactly, by
/// their numbers in each store, in order. They are asked for several times in a step, and may be few among
/// many.
struct JoinedContacts {
    std::vector<std::size_t> paths, pairs, supports;

    void clear() { paths.clear(), pairs.clear(), supports.clear(); }
    /// Calls fn(contact, number) for each of `paths`.
    template <class Paths, class Fn>
    void for_each_path(Paths& all, const Fn& fn) const {
        for (const std::size_t number : paths)
            all.for_each_of(number, number + 1, [&](const auto& contact) { fn(contact, number); });
    }
    std::size_t bytes() const {
        return (paths.capacity() + pairs.capacity() + supports.capacity()) * sizeof(std::size_t);
    }
};

}  // namespace carom
