// Margins of each body's own (MarginRule::own): in a pile that heaves some bodies are fast and most are slow,
// and in every step some leave their margins. They get new ones, and only the pairs that come with these are
// looked for.
#include <algorithm>
#include <cmath>

#include "broadphase/candidates.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

// docs/decisions/0012-threads-of-soft.md has the measurements.
constexpr double kOwnSteps = 3;           // of a body, at its speed
constexpr double kSmallestMargin = 0.05;  // of the smallest radius
constexpr double kLargestMargin = 1;      // of the largest radius
constexpr double kFewestSteps = 1.25;     // whatever the largest margin is

}  // namespace

template <class Real>
Real Candidates<Real>::own_reach(const Bodies<Real>& bodies, std::size_t row, const FlightClock& end,
                                 double fall) const {
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
    const double travel = std::sqrt(length_squared(v)) * end.s + fall;
    const double margin = std::fmin(kOwnSteps * travel, kLargestMargin * largest_radius_);
    return static_cast<Real>(
        static_cast<double>(bodies.radius[row]) +
        std::fmax(std::fmax(margin, kFewestSteps * travel), kSmallestMargin * smallest_radius_));
}

template <class Real>
void Candidates<Real>::choose_own_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    for (std::size_t row = 0; row < bodies.count; ++row) reach_[row] = own_reach(bodies, row, end, fall);
    own_x_ = bodies.position_x, own_y_ = bodies.position_y, first_reach_ = reach_;
    added_pairs_.clear();
    renewed_count_ = 0, farthest_ = 0;
}

/// As the grid decides, when the pairs were found anew. (A body's first place is the grid's.)
template <class Real>
bool Candidates<Real>::was_pair(std::size_t a, std::size_t b) const {
    const Real dx = grid_.built_x()[b] - grid_.built_x()[a], dy = grid_.built_y()[b] - grid_.built_y()[a];
    const Real reach = first_reach_[a] + first_reach_[b];
    return dx * dx + dy * dy < reach * reach;
}

template <class Real>
bool Candidates<Real>::is_pair(std::size_t a, std::size_t b) const {
    const Real dx = own_x_[b] - own_x_[a], dy = own_y_[b] - own_y_[a], reach = reach_[a] + reach_[b];
    return dx * dx + dy * dy < reach * reach;
}

template <class Real>
void Candidates<Real>::renew_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    for (const std::int32_t stray : strays_) {
        const auto row = static_cast<std::size_t>(stray);
        own_x_[row] = bodies.position_x[row], own_y_[row] = bodies.position_y[row];
        reach_[row] = own_reach(bodies, row, end, fall);
        const Vec2 way{own_x_[row] - grid_.built_x()[row], own_y_[row] - grid_.built_y()[row]};
        farthest_ = std::fmax(farthest_, std::sqrt(length_squared(way)) + static_cast<double>(reach_[row]) -
                                             static_cast<double>(first_reach_[row]));
    }
    renewed_count_ += strays_.size();
    for (const std::int32_t row : strays_) add_pairs_of(bodies, row);
    if (new_pairs_.empty()) return;
    std::sort(new_pairs_.begin(), new_pairs_.end());
    new_pairs_.erase(std::unique(new_pairs_.begin(), new_pairs_.end()), new_pairs_.end());
    spare_pairs_.resize(added_pairs_.size() + new_pairs_.size());
    std::merge(added_pairs_.begin(), added_pairs_.end(), new_pairs_.begin(), new_pairs_.end(),
               spare_pairs_.begin());
    added_pairs_.swap(spare_pairs_);
}

template <class Real>
void Candidates<Real>::add_pairs_of(const Bodies<Real>& bodies, std::int32_t row) {
    const auto i = static_cast<std::size_t>(row);
    const std::size_t found =
        find_near({own_x_[i], own_y_[i]}, static_cast<double>(reach_[i]) + farthest_, near_);
    for (std::size_t k = 0; k < found; ++k) {
        const std::int32_t other = near_[k];
        const auto j = static_cast<std::size_t>(other);
        if (other == row || !is_pair(i, j) || was_pair(i, j)) continue;
        if (bodies.is_immovable(i) && bodies.is_immovable(j)) continue;
        const Pair pair{std::min(row, other), std::max(row, other)};
        if (!std::binary_search(added_pairs_.begin(), added_pairs_.end(), pair)) new_pairs_.push_back(pair);
    }
}

template float Candidates<float>::own_reach(const Bodies<float>&, std::size_t, const FlightClock&,
                                            double) const;
template double Candidates<double>::own_reach(const Bodies<double>&, std::size_t, const FlightClock&,
                                              double) const;
template void Candidates<float>::choose_own_margins(const Bodies<float>&, const FlightClock&, Vec2);
template void Candidates<double>::choose_own_margins(const Bodies<double>&, const FlightClock&, Vec2);
template void Candidates<float>::renew_margins(const Bodies<float>&, const FlightClock&, Vec2);
template void Candidates<double>::renew_margins(const Bodies<double>&, const FlightClock&, Vec2);
template void Candidates<float>::add_pairs_of(const Bodies<float>&, std::int32_t);
template void Candidates<double>::add_pairs_of(const Bodies<double>&, std::int32_t);
template bool Candidates<float>::was_pair(std::size_t, std::size_t) const;
template bool Candidates<double>::was_pair(std::size_t, std::size_t) const;
template bool Candidates<float>::is_pair(std::size_t, std::size_t) const;
template bool Candidates<double>::is_pair(std::size_t, std::size_t) const;

}  // namespace carom
