#pragma once

#include <cstdint>
#include <vector>

#include "constraints/contact_rows.hpp"

namespace carom {

/// Rolling impulses of all contacts by their rows, while the contacts are put into a new order: beside
/// ImpulseMemory, which scenes without rolling resistance need not carry them through.
template <class Real>
class RollingMemory {
  public:
    /// Files contacts of rows below `rows`. Cost: O(rows + contacts).
    void file(const ContactRows<Real>& contacts, std::size_t rows) {
        first_of_.assign(rows + 2, 0);
        contacts.for_each([&](std::size_t i) {
            if (is_filed(contacts, i)) ++first_of_[static_cast<std::size_t>(contacts.a[i]) + 2];
        });
        for (std::size_t row = 2; row < rows + 2; ++row) first_of_[row] += first_of_[row - 1];
        filed_.resize(first_of_[rows + 1]);
        contacts.for_each([&](std::size_t i) {
            if (is_filed(contacts, i))
                filed_[first_of_[static_cast<std::size_t>(contacts.a[i]) + 1]++] = {
                    contacts.b[i], contacts.rolling_impulse[i]};
        });
    }

    /// Gives the contacts, in their new order, what they had.
    void recall(ContactRows<Real>& contacts) const {
        contacts.rolling_impulse.resize(0), contacts.rolling_impulse.resize(contacts.a.size());
        contacts.for_each([&](std::size_t i) {
            const auto row = static_cast<std::size_t>(contacts.a[i]);
            for (std::uint32_t n = first_of_[row]; n < first_of_[row + 1]; ++n)
                if (filed_[n].b == contacts.b[i]) contacts.rolling_impulse[i] = filed_[n].impulse;
        });
    }

    std::size_t bytes() const {
        return first_of_.capacity() * sizeof(std::uint32_t) + filed_.capacity() * sizeof(Filed);
    }

  private:
    struct Filed {
        std::int32_t b;
        Real impulse;  // N s
    };
    static bool is_filed(const ContactRows<Real>& contacts, std::size_t i) {
        return contacts.normal_impulse[i] > 0 && i < contacts.rolling_impulse.size();
    }

    std::vector<std::uint32_t> first_of_;  // place of a row's contacts
    std::vector<Filed> filed_;
};

}  // namespace carom
