#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "constraints/contact_rows.hpp"

namespace carom {

/// Which contacts of a store each body is in. Cost: O(bodies + contacts) to find them, twelve bytes a pair.
template <class Real>
class ContactsOfBodies {
  public:
    /// @param bodies  rows below this number are looked at. @param has_pairs  both sides of a contact are
    /// rows
    void find(const ContactRows<Real>& contacts, std::size_t bodies, bool has_pairs) {
        begin_.assign(bodies + 2, 0);
        const auto for_each_row = [&](std::size_t i, const auto& fn) {
            fn(static_cast<std::size_t>(contacts.a[i]));
            if (has_pairs) fn(static_cast<std::size_t>(contacts.b[i]));
        };
        contacts.for_each(
            [&](std::size_t i) { for_each_row(i, [&](std::size_t row) { ++begin_[row + 2]; }); });
        for (std::size_t row = 2; row < begin_.size(); ++row) begin_[row] += begin_[row - 1];
        contacts_.resize(begin_.back());
        contacts.for_each([&](std::size_t i) {
            for_each_row(
                i, [&](std::size_t row) { contacts_[begin_[row + 1]++] = static_cast<std::uint32_t>(i); });
        });
    }

    /// Places in the store, in its order.
    std::span<const std::uint32_t> of(std::size_t row) const {
        return std::span(contacts_).subspan(begin_[row], begin_[row + 1] - begin_[row]);
    }

    std::size_t bytes() const { return (begin_.capacity() + contacts_.capacity()) * sizeof(std::uint32_t); }

  private:
    std::vector<std::uint32_t> begin_, contacts_;
};

}  // namespace carom
