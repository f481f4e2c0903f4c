#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solver/flights.hpp"

namespace carom {

/// An impact that will happen at clock s unless one of its bodies is deflected before.
struct Impact {
    double s;
    Meeting meeting;
    std::uint32_t deflections_a, deflections_b;  // of the two bodies, when this was foreseen
};

/// Impacts in the order of time, ties by row: a calendar queue (Brown 1988). The substep is cut into days; an
/// impact waits unsorted in its day, and when a day comes its impacts go into a small heap. Constant time an
/// impact while they are spread over the days; if all fall into one it is a heap.
///
/// A large world is also cut into tiles, and each tile then has one day of its own: the bodies of a tile fit
/// into the cache, while impacts in the order of time alone jump all over memory (1,400 instead of 600 ns
/// each for 1,000,000 bodies). Across the border of two tiles an impact can so be carried out after one that
/// it would have changed: for a gas of 1,000,000 eight in 100,000 impacts, each a matter of a part of one
/// body's way in a step. Up to one tile of bodies the order is that of time.
/// docs/decisions/0002-impulse-solver.md has the measurements.
class ImpactQueue {
  public:
    /// Empties the queue for impacts at clock 0 ... end in so many tiles; `expected` of them.
    void start(double end, std::size_t expected, std::size_t tiles) {
        std::size_t stretches = tiles > 1 ? kStretchesOfTiles : kFewestDays;
        while (tiles == 1 && stretches < expected) stretches *= 2;
        tiles_ = tiles, last_stretch_ = stretches - 1;
        first_of_day_.assign(stretches * tiles, kNone);
        waiting_.clear(), today_heap_.clear();
        today_ = 0, count_ = 0;
        stretches_a_second_ = end > 0 ? static_cast<double>(stretches) / end : 0;
    }

    void reserve(std::size_t impacts) { waiting_.reserve(impacts), today_heap_.reserve(impacts); }

    std::size_t size() const { return count_; }

    /// @param tile  the one it happens in
    void push(const Impact& impact, std::size_t tile) {
        ++count_;
        const auto stretch = static_cast<std::size_t>(impact.s * stretches_a_second_);
        const std::size_t day = std::min(stretch, last_stretch_) * tiles_ + tile;
        if (day <= today_) {
            today_heap_.push_back(impact);
            std::push_heap(today_heap_.begin(), today_heap_.end(), later);
            return;
        }
        waiting_.push_back({impact, first_of_day_[day]});
        first_of_day_[day] = static_cast<std::uint32_t>(waiting_.size() - 1);
    }

    /// The earliest impact, or null. Calls on_tile(tile) when it begins with another tile.
    template <class OnTile>
    const Impact* next(const OnTile& on_tile) {
        if (count_ == 0) return nullptr;
        while (today_heap_.empty()) {
            ++today_;  // there is one, as count_ says that impacts wait
            if (first_of_day_[today_] == kNone) continue;
            if (tiles_ > 1) on_tile(today_ % tiles_);
            start_day();
        }
        return &today_heap_.front();
    }

    /// Removes what `next` returned.
    void pop() {
        std::pop_heap(today_heap_.begin(), today_heap_.end(), later);
        today_heap_.pop_back();
        --count_;
    }

    std::size_t bytes() const {
        return first_of_day_.capacity() * sizeof(std::uint32_t) + waiting_.capacity() * sizeof(Waiting) +
               today_heap_.capacity() * sizeof(Impact);
    }

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX;
    static constexpr std::size_t kFewestDays = 16;
    static constexpr std::size_t kStretchesOfTiles = 1;  // 2: a fifth slower, a quarter of the late impacts

    struct Waiting {
        Impact impact;
        std::uint32_t next;  // of the same day
    };

    static bool later(const Impact& p, const Impact& q) {
        if (p.s != q.s) return p.s > q.s;
        if (p.meeting.a != q.meeting.a) return p.meeting.a > q.meeting.a;
        return p.meeting.b > q.meeting.b;
    }

    void start_day() {
        for (std::uint32_t i = first_of_day_[today_]; i != kNone; i = waiting_[i].next)
            today_heap_.push_back(waiting_[i].impact);
        if (today_heap_.size() > 1) std::make_heap(today_heap_.begin(), today_heap_.end(), later);
    }

    std::vector<std::uint32_t> first_of_day_;
    std::vector<Waiting> waiting_;
    std::vector<Impact> today_heap_;
    std::size_t today_ = 0, count_ = 0, tiles_ = 1, last_stretch_ = 0;
    double stretches_a_second_ = 0;
};

}  // namespace carom
