#pragma once

#include <cstdint>

#include "constraints/contact_rows.hpp"
#include "constraints/task_groups.hpp"
#include "parallel/executor.hpp"

namespace carom {

/// The impulses of all contacts by their rows, while the contacts are put into a new order. What carries no
/// impulse need not be remembered.
template <class Real>
class ImpulseMemory {
  public:
    struct Impulses {
        Real normal = 0, friction = 0;  // N s, of a substep
    };

    /// Files contacts of rows below `rows`.
    /// @param groups  of `pairs`, if the rows are still those that `pairs` was grouped by; else null
    /// Cost: O(rows + contacts), shared among threads if there are groups.
    void file(const ContactRows<Real>& pairs, const ContactRows<Real>& supports, std::size_t rows,
              const TaskGroups* groups, const Executor& executor);

    /// What the pair (a, b) had; nothing if it was none.
    Impulses recall_pair(std::int32_t a, std::int32_t b) const {
        const Impulses* found = grouped_.find(a, b);
        if (!found && others_have_pairs_) found = others_.find(a, b);
        return found ? *found : Impulses{};
    }
    /// What body a had from its support b.
    Impulses recall_support(std::int32_t a, std::int32_t b) const {
        const Impulses* found = others_.find(a, b);
        return found ? *found : Impulses{};
    }

    std::size_t bytes() const { return grouped_.bytes() + others_.bytes(); }

  private:
    struct Filed {
        std::int32_t b;
        Impulses impulses;
    };
    struct Range {
        std::uint32_t begin, end;
    };
    /// Contacts by their row a.
    struct File {
        Column<Range> of_row;
        Column<Filed> filed;
        bool is_empty = true;

        const Impulses* find(std::int32_t a, std::int32_t b) const {
            if (is_empty) return nullptr;
            const Range range = of_row[static_cast<std::size_t>(a)];
            for (std::uint32_t i = range.begin; i < range.end; ++i)
                if (filed[i].b == b) return &filed[i].impulses;
            return nullptr;
        }
        std::size_t bytes() const { return of_row.bytes() + filed.bytes(); }
    };

    /// Calls each(fn) twice; it calls fn(contacts, i) for the contacts of rows [first, last).
    template <class Each>
    static void file_rows(File& file, std::size_t first, std::size_t last, std::uint32_t place,
                          const Each& each);

    File grouped_, others_;  // the others: supports, and pairs that are in no chunk's group
    bool others_have_pairs_ = false;
};

extern template class ImpulseMemory<float>;
extern template class ImpulseMemory<double>;

}  // namespace carom
