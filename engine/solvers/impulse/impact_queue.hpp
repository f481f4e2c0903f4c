#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solvers/impulse/flights.hpp"

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
class ImpactCalendar {
  public:
    /// Empties it for impacts at clock 0 ... end; `expected` of them.
    void start(double end, std::size_t expected) {
        std::size_t days = kFewestDays;
        while (days < expected) days *= 2;
        first_of_day_.assign(days, kNone);
        waiting_.clear(), today_heap_.clear();
        today_ = 0, count_ = 0;
        days_a_second_ = end > 0 ? static_cast<double>(days) / end : 0;
    }

    void push(const Impact& impact) {
        ++count_;
        const std::size_t day =
            std::min(static_cast<std::size_t>(impact.s * days_a_second_), first_of_day_.size() - 1);
        if (day <= today_) {
            today_heap_.push_back(impact);
            std::push_heap(today_heap_.begin(), today_heap_.end(), Later{});
            return;
        }
        waiting_.push_back({impact, first_of_day_[day]});
        first_of_day_[day] = static_cast<std::uint32_t>(waiting_.size() - 1);
    }

    bool empty() const { return count_ == 0; }

    /// The earliest impact, of at least one.
    const Impact& next() {
        while (today_heap_.empty()) {
            ++today_;  // there is one, as count_ says that impacts wait
            for (std::uint32_t i = first_of_day_[today_]; i != kNone; i = waiting_[i].next)
                today_heap_.push_back(waiting_[i].impact);
            if (today_heap_.size() > 1) std::make_heap(today_heap_.begin(), today_heap_.end(), Later{});
        }
        return today_heap_.front();
    }

    /// Removes what `next` returned.
    void pop() {
        std::pop_heap(today_heap_.begin(), today_heap_.end(), Later{});
        today_heap_.pop_back();
        --count_;
    }

    void reserve(std::size_t impacts) { waiting_.reserve(impacts), today_heap_.reserve(impacts); }
    std::size_t bytes() const {
        return first_of_day_.capacity() * sizeof(std::uint32_t) + waiting_.capacity() * sizeof(Waiting) +
               today_heap_.capacity() * sizeof(Impact);
    }

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX;
    static constexpr std::size_t kFewestDays = 16;

    struct Waiting {
        Impact impact;
        std::uint32_t next;  // of the same day
    };
    struct Later {
        bool operator()(const Impact& p, const Impact& q) const {
            if (p.s != q.s) return p.s > q.s;
            if (p.meeting.a != q.meeting.a) return p.meeting.a > q.meeting.a;
            return p.meeting.b > q.meeting.b;
        }
    };

    std::vector<std::uint32_t> first_of_day_;
    std::vector<Waiting> waiting_;
    std::vector<Impact> today_heap_;
    std::size_t today_ = 0, count_ = 0;
    double days_a_second_ = 0;
};

/// The impacts of a substep. In a small world they come in the order of time. A large world is cut into
/// tiles, and a tile's impacts are all done before the next tile's: the bodies of a tile fit into the cache,
/// while impacts in the order of time alone jump all over memory. Across the border of two tiles an impact
/// can so be carried out after one that it would have changed: for a gas of 1,000,000 twelve in 100,000
/// impacts, each a matter of a part of one body's way in a step. docs/decisions/0002-impulse-solver.md has
/// the measurements.
class ImpactQueue {
  public:
    /// Empties the queue for impacts at clock 0 ... end in so many tiles; `expected` of them.
    void start(double end, std::size_t expected, std::size_t tiles) {
        end_ = end, tiles_ = tiles, count_ = 0;
        foreseen_.clear(), tile_of_foreseen_.clear(), crossing_.clear();
        tiles_begun_ = 0;
        if (tiles > 1) return;
        calendar_.start(end, expected);
        tiles_begun_ = 1;
    }

    std::size_t size() const { return count_; }

    /// @param tile  the one it happens in
    void push(const Impact& impact, std::size_t tile) {
        ++count_;
        if (tile < tiles_begun_) {
            calendar_.push(impact);
        } else if (tiles_begun_ == 0) {
            foreseen_.push_back(impact);
            tile_of_foreseen_.push_back(static_cast<std::uint32_t>(tile));
        } else {
            crossing_.push_back({impact, first_crossing_[tile]});
            first_crossing_[tile] = static_cast<std::uint32_t>(crossing_.size() - 1);
        }
    }

    /// The next impact, or null. Calls on_tile(tile) when it begins with another tile.
    template <class OnTile>
    const Impact* next(const OnTile& on_tile) {
        if (count_ == 0) return nullptr;
        if (tiles_begun_ == 0) sort_by_tile();
        while (calendar_.empty()) begin_tile(on_tile);
        return &calendar_.next();
    }

    /// Removes what `next` returned.
    void pop() {
        calendar_.pop();
        --count_;
    }

    void reserve(std::size_t impacts) { calendar_.reserve(impacts); }
    std::size_t bytes() const {
        const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
        return calendar_.bytes() + of(foreseen_) + of(by_tile_) + of(tile_of_foreseen_) + of(tile_begin_) +
               of(crossing_) + of(first_crossing_);
    }

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX;

    struct Crossing {
        Impact impact;
        std::uint32_t next;  // of the same tile
    };

    /// Counts and places by tile the impacts that were foreseen before the first one, so that a tile reads
    /// its own in one go.
    void sort_by_tile() {
        first_crossing_.assign(tiles_, kNone);
        tile_begin_.assign(tiles_ + 2, 0);
        for (const std::uint32_t tile : tile_of_foreseen_) ++tile_begin_[tile + 2];
        for (std::size_t tile = 0; tile + 1 < tile_begin_.size(); ++tile)
            tile_begin_[tile + 1] += tile_begin_[tile];
        by_tile_.resize(foreseen_.size());
        for (std::size_t i = 0; i < foreseen_.size(); ++i)
            by_tile_[tile_begin_[tile_of_foreseen_[i] + 1]++] = foreseen_[i];
    }

    template <class OnTile>
    void begin_tile(const OnTile& on_tile) {
        const std::size_t tile = tiles_begun_++;
        const std::size_t first = tile_begin_[tile], last = tile_begin_[tile + 1];
        if (first == last && first_crossing_[tile] == kNone) return;
        on_tile(tile);
        calendar_.start(end_, last - first);
        for (std::size_t i = first; i < last; ++i) calendar_.push(by_tile_[i]);
        for (std::uint32_t i = first_crossing_[tile]; i != kNone; i = crossing_[i].next)
            calendar_.push(crossing_[i].impact);
    }

    ImpactCalendar calendar_;                      // of the present tile
    std::vector<Impact> foreseen_, by_tile_;       // before the first tile begins
    std::vector<std::uint32_t> tile_of_foreseen_;  // by impact
    std::vector<std::size_t> tile_begin_;          // in by_tile_
    std::vector<Crossing> crossing_;               // foreseen from another tile since then
    std::vector<std::uint32_t> first_crossing_;    // by tile
    std::size_t tiles_ = 1, tiles_begun_ = 0, count_ = 0;
    double end_ = 0;
};

}  // namespace carom
