#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "constraints/contact_rows.hpp"

namespace carom {

/// Which contacts of a store each body is in. Cost: O(bodies + contacts) to find them.
template <class Real>
class ContactsOfBodies {
  public:
    struct Entry {
        std::uint32_t contact;  // place in the store
        std::int32_t other;     // row of the other body; of a support's contact no meaning
    };

    /// @param bodies  rows below this number are looked at. @param are_pairs  both sides of a contact are
    /// rows
    void find(const ContactRows<Real>& contacts, std::size_t bodies, bool are_pairs) {
        begin_.assign(bodies + 2, 0);
        const auto for_each_side = [&](std::size_t i, const auto& fn) {
            const std::int32_t b = are_pairs ? contacts.b[i] : 0;
            fn(static_cast<std::size_t>(contacts.a[i]), b);
            if (are_pairs) fn(static_cast<std::size_t>(b), contacts.a[i]);
        };
        contacts.for_each([&](std::size_t i) {
            for_each_side(i, [&](std::size_t row, std::int32_t) { ++begin_[row + 2]; });
        });
        for (std::size_t row = 2; row < begin_.size(); ++row) begin_[row] += begin_[row - 1];
        entries_.resize(begin_.back());
        contacts.for_each([&](std::size_t i) {
            for_each_side(i, [&](std::size_t row, std::int32_t other) {
                entries_[begin_[row + 1]++] = {static_cast<std::uint32_t>(i), other};
            });
        });
    }

    /// Makes room for that many contacts of supports, or half as many pairs, so that later calls need none.
    void reserve(std::size_t contacts) { entries_.reserve(std::bit_ceil(contacts)); }

    /// In the order of the store.
    std::span<const Entry> of(std::size_t row) const {
        if (row + 2 >= begin_.size()) return {};
        return std::span(entries_).subspan(begin_[row], begin_[row + 1] - begin_[row]);
    }

    std::size_t bytes() const {
        return begin_.capacity() * sizeof(std::uint32_t) + entries_.capacity() * sizeof(Entry);
    }

  private:
    std::vector<std::uint32_t> begin_;  // of each row, one place on
    std::vector<Entry> entries_;
};

}  // namespace carom
