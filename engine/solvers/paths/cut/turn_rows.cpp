#include "solvers/paths/cut/turn_rows.hpp"

#include <algorithm>
#include <utility>

namespace carom {
namespace {

/// Contacts of bodies from which no more than so many contacts lead to one in turns are near it.
/// docs/decisions/0081-turns-and-segments.md has what fewer leave.
constexpr int kLinks = 4;

}  // namespace

void TurnRows::mark(std::span<ContactLink> contacts) {
    std::swap(asked_, of_cut_);
    asked_.clear(), near_.clear();
    if (of_cut_.empty()) return;
    std::int32_t last = static_cast<std::int32_t>(of_cut_.size()) - 1;
    for (const ContactLink& contact : contacts) last = std::max({last, contact.a, contact.b});
    near_ = of_cut_;
    near_.resize(index(last) + 1);
    for (int link = 0; link < kLinks; ++link) {
        nearer_ = near_;
        for (const ContactLink& contact : contacts) {
            if (contact.a < 0 || contact.b < 0) continue;
            if ((nearer_[index(contact.a)] | nearer_[index(contact.b)]) != 0)
                near_[index(contact.a)] = near_[index(contact.b)] = 1;
        }
    }
    for (ContactLink& contact : contacts) contact.is_in_turns = is_near(contact.a) || is_near(contact.b);
}

}  // namespace carom
