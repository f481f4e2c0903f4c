#include "solvers/manifolds/list/live_contacts.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace carom {

bool LiveContacts::list_all(std::span<const std::uint32_t> found_blocks) {
    const bool was_empty = numbers_.empty();
    const auto changes = std::accumulate(changes_.begin(), changes_.end(), std::size_t{0});
    const bool same_surfaces =
        std::equal(surfaces_.begin(), surfaces_.end(),
                   numbers_.begin() + static_cast<std::ptrdiff_t>(of_bodies_), numbers_.end());
    const bool has_new_rows = std::exchange(has_new_rows_, false);
    const bool lists_bodies = changes > 0 || has_new_rows || first_.size() != masks_.size() + 1;
    if (lists_bodies) list_bodies();
    if (lists_bodies || !same_surfaces) {
        numbers_.resize(of_bodies_);
        numbers_.insert(numbers_.end(), surfaces_.begin(), surfaces_.end());
    }
    changed_share_ = was_empty || numbers_.empty()
                         ? -1
                         : static_cast<double>(changes) / static_cast<double>(numbers_.size());
    found_.clear();
    for (const std::uint32_t block : found_blocks)
        for (std::uint32_t n = first_[block]; n < first_[block + 1]; ++n)
            found_.push_back(static_cast<std::int32_t>(n));
    for (const std::int32_t n : found_surfaces_) found_.push_back(static_cast<std::int32_t>(of_bodies_) + n);
    return changes == 0 && same_surfaces && !has_new_rows;
}

void LiveContacts::list_bodies() {
    of_bodies_ = 0;
    for (const std::uint16_t mask : masks_) of_bodies_ += static_cast<std::size_t>(std::popcount(mask));
    numbers_.resize(of_bodies_);
    first_.resize(masks_.size() + 1);
    std::uint32_t n = 0;
    for (std::size_t block = 0; block < masks_.size(); ++block) {
        first_[block] = n;
        for (std::uint32_t left = masks_[block]; left != 0; left &= left - 1)
            numbers_[n++] = static_cast<std::int32_t>(kContactsOfBlock * block) + std::countr_zero(left);
    }
    first_.back() = n;
}

/// The masks that say what the numbers do.
void LiveContacts::read_masks() {
    masks_.clear(), first_.clear(), found_.clear(), of_bodies_ = 0;
    for (; of_bodies_ < numbers_.size() && numbers_[of_bodies_] >= 0; ++of_bodies_) {
        const auto number = static_cast<std::size_t>(numbers_[of_bodies_]);
        masks_.resize(number / kContactsOfBlock + 1);
        masks_.back() = static_cast<std::uint16_t>(masks_.back() | 1u << number % kContactsOfBlock);
    }
}

std::size_t LiveContacts::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return of(numbers_) + of(found_) + of(masks_) + of(changes_) + of(first_) + of(surfaces_) +
           of(found_surfaces_);
}

}  // namespace carom
