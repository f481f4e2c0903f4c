#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/manifolds/list/manifold_list.hpp"

namespace carom {

/// Finds contacts by their names, whichever of the two bodies a name begins with.
///
/// Contacts are filed by both bodies: a drum or a bin that moves has contacts with thousands of others, which
/// would all be gone through for each of them were they filed by one.
///
/// Cost: O(1) a contact that is filed or found, in the mean.
class ManifoldIndex {
  public:
    /// Files the contacts of a list that carry something, or have a place along a path.
    template <class Real>
    void file(const ManifoldList<Real>& list) {
        first_.assign(std::bit_ceil(list.count() + 1), -1);
        next_.resize(list.count());
        for (std::size_t i = 0; i < list.count(); ++i) {
            if (!list.memory[i].is_loaded() && list.memory[i].slot < 0) continue;
            std::int32_t& first = first_[file_of(list.names[i])];
            next_[i] = first, first = static_cast<std::int32_t>(i);
        }
    }
    /// Calls fn(number) for contacts, the last one first, among which are all of a name and of its reverse.
    template <class Fn>
    void for_each_like(const ManifoldName& name, const Fn& fn) const {
        if (first_.empty()) return;
        for (std::int32_t n = first_[file_of(name)]; n >= 0; n = next_[static_cast<std::size_t>(n)])
            fn(static_cast<std::size_t>(n));
    }
    std::size_t bytes() const { return (first_.capacity() + next_.capacity()) * sizeof(std::int32_t); }

  private:
    /// The same for a name and its reverse.
    std::size_t file_of(const ManifoldName& name) const {
        const std::uint32_t sum = name.a.index + name.b.index, difference = name.a.index ^ name.b.index;
        const std::uint32_t mixed = sum * 0x9E3779B1U ^ difference * 0x85EBCA6BU;
        return (mixed ^ mixed >> 15) & (first_.size() - 1);
    }

    std::vector<std::int32_t> first_, next_;  // by file, by contact; -1: none
};

}  // namespace carom
