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

/// Impacts in the order of time, ties by row: a binary heap in one growable array.
class ImpactQueue {
  public:
    bool is_empty() const { return heap_.empty(); }
    std::size_t size() const { return heap_.size(); }
    const Impact& next() const { return heap_.front(); }
    void clear() { heap_.clear(); }

    void push(const Impact& impact) {
        heap_.push_back(impact);
        std::push_heap(heap_.begin(), heap_.end(), later);
    }

    Impact pop() {
        std::pop_heap(heap_.begin(), heap_.end(), later);
        const Impact impact = heap_.back();
        heap_.pop_back();
        return impact;
    }

    std::size_t bytes() const { return heap_.capacity() * sizeof(Impact); }
    void reserve(std::size_t impacts) { heap_.reserve(impacts); }

  private:
    static bool later(const Impact& p, const Impact& q) {
        if (p.s != q.s) return p.s > q.s;
        if (p.meeting.a != q.meeting.a) return p.meeting.a > q.meeting.a;
        return p.meeting.b > q.meeting.b;
    }

    std::vector<Impact> heap_;
};

}  // namespace carom
