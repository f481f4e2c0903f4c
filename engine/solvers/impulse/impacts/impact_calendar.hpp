#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "solvers/impulse/impacts/flights.hpp"

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
    std::size_t size() const { return count_; }

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

}  // namespace carom
