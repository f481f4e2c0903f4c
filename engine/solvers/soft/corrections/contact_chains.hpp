#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solvers/contact_sets/tridiagonal_contacts.hpp"
#include "solvers/soft/contacts/step_view.hpp"

namespace carom {

/// Solves columns of discs exactly, along the chain of their contacts.
///
/// A sweep carries a load one body farther, so a column of n discs takes n² sweeps, and swings for as long as
/// that takes. Here contacts of discs that touch two others each, straight opposite each other, and nothing
/// else, are a chain, whose normal impulses are found at once
/// (solvers/contact_sets/tridiagonal_contacts.hpp). Friction and what is beside the chain are left to the
/// sweeps.
///
/// Chains are listed anew every few steps, and with the pairs where there were some.
/// Numbers: docs/decisions/0047-columns-of-discs.md.
template <class Real>
class ContactChains {
  public:
    /// To be called when the contacts of a step are found. Cost: O(contacts) when chains are listed, else
    /// O(supports) if there are any.
    void begin_step(const StepView<Real>& step);
    bool empty() const { return chains_.empty(); }
    /// Solves what the sweeps of a substep leave in the chains.
    /// Cost: O(contacts of chains), 10 ns each where they keep their laws, else about 50 ns.
    void solve(const StepView<Real>& step);

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.chains_, self.contacts_, self.version_, self.age_);
    }

  private:
    /// Contacts [first, last) of contacts_, one behind the other.
    struct Chain {
        std::uint32_t first, last;
    };
    struct ChainContact {
        std::uint32_t pair;
        std::uint32_t is_reversed;  // 1: the chain goes from b to a
    };
    /// A contact while its chain is solved.
    struct Link {
        std::int32_t before, behind;  // rows; -1: what nothing moves
        double nx, ny;                // along the chain
        double impulse;               // N s, before
    };
    using Rows = ContactRows<Real>;

    void list(const StepView<Real>& step);
    bool leads_on(const Rows& pairs, std::int32_t row, std::uint32_t pair) const;
    void walk(const Rows& pairs, std::uint32_t pair, bool is_reversed);
    void find_feet(const StepView<Real>& step);
    template <class Fn>
    void for_each_contact(const StepView<Real>& step, std::size_t chain, const Fn& fn) const;
    bool keeps_laws(const StepView<Real>& step, std::size_t chain, double tolerance) const;
    void read(const StepView<Real>& step, std::size_t chain);
    void store(const StepView<Real>& step, std::size_t chain) const;

    std::vector<Chain> chains_;
    std::vector<ChainContact> contacts_;
    std::int64_t version_ = -1;  // of the graph when chains were listed
    std::int32_t age_ = 0;       // steps since then

    std::vector<std::uint8_t> touches_;  // by row: discs that it touches, 3 = more, or a wall besides two
    std::vector<std::array<std::uint32_t, 2>> pairs_of_;  // by row: the first two of these pairs
    std::vector<std::uint8_t> is_seen_;                   // by pair
    std::vector<std::int32_t> chain_of_end_;  // by row: 2 chain, + 1 where it ends there; -1: none
    std::vector<std::int32_t> foot_;          // by chain: its support in this step; -1: none
    std::vector<Link> links_;                 // of one chain
    TridiagonalContacts line_;                // likewise
};

extern template class ContactChains<float>;
extern template class ContactChains<double>;

}  // namespace carom
