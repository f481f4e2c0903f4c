#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/paths/cut/path_cut.hpp"
#include "state/columns/index.hpp"

namespace carom {

/// Bodies whose contacts are solved in turns, more often than others: what a motor presses, a heavy body on
/// light ones. Paths are cut so that contacts near such bodies can be solved alone, for some steps at a
/// time; until then a body that is new among them has all contacts solved.
class TurnRows {
  public:
    /// To be called before a turn: no body has asked for it yet.
    void begin() { has_asked_ = false, are_known_ = true; }
    /// Contacts near a body are to be solved in this turn.
    void ask(std::int32_t row) {
        const std::size_t at = index(row);
        if (at >= asked_.size()) asked_.resize(at + 1);
        asked_[at] = 1, has_asked_ = true;
        are_known_ = are_known_ && at < of_cut_.size() && of_cut_[at] != 0;
    }
    /// Whether some have asked since `begin`, and the present paths are cut for all of them.
    bool are_known() const { return has_asked_ && are_known_; }

    /// Before paths are cut: marks contacts near bodies that have asked since they were cut last.
    /// Cost: nothing where none has, else O(contacts).
    void mark(std::span<ContactLink> contacts);
    /// Whether a body was near those when paths were cut.
    bool is_near(std::int32_t row) const {
        return row >= 0 && index(row) < near_.size() && near_[index(row)] != 0;
    }
    /// Rows have become others.
    void forget() { asked_.clear(), of_cut_.clear(), near_.clear(); }

    std::size_t bytes() const {
        return asked_.capacity() + of_cut_.capacity() + near_.capacity() + nearer_.capacity();
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.asked_, self.of_cut_, self.near_);
    }

  private:
    std::vector<std::uint8_t> asked_, of_cut_, near_;  // by row; those beyond are none
    std::vector<std::uint8_t> nearer_;                 // scratch of `mark`
    bool has_asked_ = false, are_known_ = false;
};

}  // namespace carom
