#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "state/columns/column.hpp"

namespace carom {

/// Which contacts can touch in a step. From 0 on they are of two bodies, by their number, and behind these,
/// below 0, of a body and a wall or an edge: ~number.
///
/// A mask for each block of kRowPadding contacts of two bodies tells which of them can. It is set where the
/// block is found; the others keep theirs, and while no mask changes the list is that of the step before.
///
/// Cost: about 1 ns a block that is found, and 1 ns a contact where one has come or gone.
class LiveContacts {
  public:
    /// Forgets the step before: contacts get other numbers.
    void clear() { numbers_.clear(), masks_.clear(), first_.clear(), found_.clear(), of_bodies_ = 0; }
    /// Contacts have the rows of other bodies, or other numbers: the next list is not that of the step
    /// before.
    void note_new_rows() { has_new_rows_ = true; }
    /// Contact `from` of two bodies takes the number `to`, of one that is gone; they may be the same.
    void move(std::size_t from, std::size_t to) {
        const bool is_live = (mask(from / kContactsOfBlock) >> from % kContactsOfBlock & 1) != 0;
        put(from, false);
        if (from != to) put(to, is_live);
    }
    bool empty() const { return numbers_.empty(); }
    std::span<const std::int32_t> numbers() const { return numbers_; }
    /// Places in `numbers` of those that were found in this step, in order.
    std::span<const std::int32_t> found() const { return found_; }
    /// Contacts of two bodies that have come or gone since the step before, as a share of all live ones;
    /// negative where that is not known.
    double changed_share() const { return changed_share_; }

    /// @param blocks  of contacts of two bodies in this step; new ones come behind the others
    void begin(std::size_t blocks) { masks_.resize(blocks), changes_.assign(blocks, 0); }
    /// Which contacts of a block could touch when it was found last, a bit each.
    std::uint16_t mask(std::size_t block) const { return block < masks_.size() ? masks_[block] : 0; }
    /// Tells of a block that was found which of its contacts can touch. Threads may tell of several at once.
    void set(std::size_t block, std::uint16_t mask) {
        changes_[block] =
            static_cast<std::uint8_t>(std::popcount(static_cast<std::uint16_t>(masks_[block] ^ mask)));
        masks_[block] = mask;
    }
    /// Lists them.
    /// @param found_blocks  those of `set`, in order
    /// @param surfaces  how many there are
    /// @param is_live  is_live(number) of a surface
    /// @param is_found  is_found(number): whether it was found in this step
    /// @return whether they are those of the step before
    template <class IsLive, class IsFound>
    bool list(std::span<const std::uint32_t> found_blocks, std::size_t surfaces, const IsLive& is_live,
              const IsFound& is_found) {
        surfaces_.clear(), found_surfaces_.clear();
        for (std::size_t i = 0; i < surfaces; ++i) {
            if (!is_live(i)) continue;
            if (is_found(i)) found_surfaces_.push_back(static_cast<std::int32_t>(surfaces_.size()));
            surfaces_.push_back(~static_cast<std::int32_t>(i));
        }
        return list_all(found_blocks);
    }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.numbers_);
        if constexpr (!std::is_const_v<Self>) self.read_masks();
    }

  private:
    static constexpr std::size_t kContactsOfBlock = kRowPadding;
    static_assert(kContactsOfBlock == 16, "a mask has a bit for each contact of a block");

    void put(std::size_t number, bool is_live) {
        if (number / kContactsOfBlock >= masks_.size()) return;
        std::uint16_t& mask = masks_[number / kContactsOfBlock];
        const auto bit = static_cast<std::uint16_t>(1u << number % kContactsOfBlock);
        mask = static_cast<std::uint16_t>(is_live ? mask | bit : mask & ~bit);
    }
    bool list_all(std::span<const std::uint32_t> found_blocks);
    void list_bodies();
    void read_masks();

    std::vector<std::int32_t> numbers_;
    std::size_t of_bodies_ = 0;                 // of them, those of two bodies: they come first
    std::vector<std::int32_t> found_;           // places in numbers_
    std::vector<std::uint16_t> masks_;          // by block
    std::vector<std::uint8_t> changes_;         // by block, of this step
    std::vector<std::uint32_t> first_;          // by block, and the end: places in numbers_
    std::vector<std::int32_t> surfaces_;        // of this step
    std::vector<std::int32_t> found_surfaces_;  // places in surfaces_ of those that were found in this step
    double changed_share_ = -1;
    bool has_new_rows_ = false;  // since the last list
};

}  // namespace carom
