#pragma once

#include <cstdint>
#include <vector>

#include "state/column.hpp"

namespace carom {

/// Possible contacts of one kind, by group (task_groups.hpp) and in each group by colour: no body that
/// moves is in two contacts of a colour, so all of a colour can be solved at once, by lanes, with the same
/// bits. Each keeps its impulses from step to step while its pair lives.
template <class Real>
struct ContactCandidates {
    /// Rows; b < 0 is a wall (WallSide) or an edge (state/edges.hpp). Padding: a row beyond the bodies.
    Column<std::int32_t> a, b;
    Column<Real> normal_impulse;    // N s, of a substep
    Column<Real> friction_impulse;  // N s
    Column<Real> rolling_impulse;   // N s; empty without rolling resistance
    /// Colour c is [begin[c], begin[c] + count[c]); begin[c] is a multiple of kRowPadding.
    std::vector<std::size_t> begin, count;
    /// Group g has the colours [first_colour[g], first_colour[g + 1]).
    std::vector<std::size_t> first_colour;
    /// The last colour of the last group takes what found no other: its contacts may share bodies and are
    /// solved one by one. They stand `overflow_stride` apart, with padding between.
    bool has_overflow = false;
    std::size_t overflow_stride = 1;

    std::size_t colours() const { return begin.size(); }
    std::size_t groups() const { return first_colour.empty() ? 0 : first_colour.size() - 1; }
    std::size_t overflow() const { return has_overflow ? count.back() : 0; }
    std::size_t stride(std::size_t colour) const {
        return has_overflow && colour + 1 == colours() ? overflow_stride : 1;
    }
    /// Where the contacts of a group begin.
    std::size_t first_place(std::size_t group) const {
        return first_colour[group] < colours() ? begin[first_colour[group]] : a.size();
    }

    /// Calls fn(i) for every contact of the groups [first, last) that is no padding.
    template <class Fn>
    void for_each(std::size_t first, std::size_t last, const Fn& fn) const {
        for (std::size_t c = first_colour[first]; c < first_colour[last]; ++c)
            for (std::size_t n = 0, i = begin[c]; n < count[c]; ++n, i += stride(c)) fn(i);
    }
    template <class Fn>
    void for_each(const Fn& fn) const {
        if (groups() > 0) for_each(0, groups(), fn);
    }

    std::size_t bytes() const {
        return a.bytes() + b.bytes() + normal_impulse.bytes() + friction_impulse.bytes() +
               rolling_impulse.bytes() +
               (begin.capacity() + count.capacity() + first_colour.capacity()) * sizeof(std::size_t);
    }
};

}  // namespace carom
