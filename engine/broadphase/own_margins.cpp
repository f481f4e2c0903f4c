// Margins of each body's own (MarginRule::own): in a pile that heaves some bodies are fast and most are slow,
// and in every step some leave their margins. They get new ones, and only the pairs that come with these are
// looked for.
#include <algorithm>
#include <bit>
#include <cmath>

#include "broadphase/candidates.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

// docs/decisions/0012-threads-of-soft.md has the measurements.
constexpr double kOwnSteps = 5;          // steps at the body's own speed that a margin is to last
constexpr double kSmallestMargin = 0.1;  // own radii, or usual ones if these are less, that every margin has
constexpr double kLargestSize = 4;       // own radii that count as a body's size beside much larger ones
constexpr double kFewestSteps = 1.25;    // steps that a margin lasts, even above the largest margin
constexpr double kFlowSteps = 0.7;       // steps of the flow around the body, because the flow changes

// Share of their distance by which the places of two bodies, one of them slim, may come nearer by their
// drifts. So much as in so many steps of the flow of now, between limits.
constexpr double kFlowSpreadSteps = 3, kLeastSpread = 0.02, kMostSpread = 0.1;

constexpr double kNanosecondsToChoose = 4;  // ns a body on one thread, for the executor

// Relative error of a drifted place: drifts are sums, rounded to Real a few times.
template <class Real>
constexpr double kRoundingOfPlace = sizeof(Real) == sizeof(float) ? 1e-6 : 4e-15;

}  // namespace

/// Radius plus margin of a body [m]: the margin is for what the body does beside the flow around it, and for
/// what that flow will change.
template <class Real>
Real Candidates<Real>::own_reach(const Bodies<Real>& bodies, std::size_t row, const FlightClock& end,
                                 double fall) const {
    const Vec2 flow{flow_x_[row], flow_y_[row]};
    const Vec2 v = Vec2{bodies.velocity_x[row], bodies.velocity_y[row]} - flow;
    const double travel = std::sqrt(length_squared(v)) * end.s + fall;
    // A small body beside a large one has no use for a margin of the large one's size.
    const double size = std::min(radii_.largest, kLargestSize * static_cast<double>(bodies.radius[row]));
    const double most = std::max(kLargestOwnMargin * size, kFewestSteps * travel);
    const double wanted = kOwnSteps * travel + kFlowSteps * end.s * std::sqrt(length_squared(flow));
    const double least = kSmallestMargin * std::min(radii_.usual, static_cast<double>(bodies.radius[row]));
    const double margin = std::max(std::min(wanted, most), least);
    return static_cast<Real>(static_cast<double>(bodies.radius[row]) + margin);
}

template <class Real>
void Candidates<Real>::choose_own_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                                          const ShapeStore<Real>* shapes, const Executor& executor) {
    begin_flow(bodies, end, gravity, executor);
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    const std::size_t rows = rows_to_find(bodies), moving = bodies.moving();
    executor.for_each_chunk(rows, kRowsPerChunk, kNanosecondsToChoose,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t row = first; row < last; ++row)
                                    reach_[row] = own_reach(bodies, row, end, fall);
                            });
    for (std::size_t row = 0; row < moving; ++row) note_reach(reach_[row]);
    if (!is_standing_known_) largest_standing_reach_ = 0;
    for (std::size_t row = moving; row < rows; ++row)
        largest_standing_reach_ = std::fmax(largest_standing_reach_, static_cast<double>(reach_[row]));
    largest_reach_ = std::fmax(largest_reach_, largest_standing_reach_);
    const auto take_over = [&](Column<Real>& column, const Column<Real>& from) {
        column.resize(bodies.count);
        std::copy_n(from.data(), rows, column.data());
    };
    take_over(own_x_, bodies.position_x), take_over(own_y_, bodies.position_y);
    take_over(first_reach_, reach_);
    slim_.clear();
    if (shapes && bodies.has_shapes) slim_.read_shapes(*shapes);
    if (!slim_.empty()) {
        const double of_flow = flows_ ? kFlowSpreadSteps * end.s * flow_.most().gradient_of_velocity : 0;
        slim_.begin(bodies.count, kSteepnessThen * std::clamp(of_flow, kLeastSpread, kMostSpread));
        for (std::size_t row = 0; row < bodies.count; ++row) set_rectangle(bodies, row, end.s);
        slim_.note_all_are_first();
    }
    added_pairs_.clear();
    renewed_count_ = 0, farthest_ = 0;
}

/// Whether a and b were a pair when the pairs were found anew, as the grid decided then. (A body's first
/// place is the grid's.)
template <class Real>
bool Candidates<Real>::was_pair(std::size_t a, std::size_t b) const {
    if (is_loose(a) || is_loose(b)) return false;
    const Real dx = first_x(b) - first_x(a), dy = first_y(b) - first_y(a);
    const Real reach = first_reach_[a] + first_reach_[b];
    return dx * dx + dy * dy < reach * reach && (slim_.empty() || !slim_.were_parted(a, b));
}

template <class Real>
bool Candidates<Real>::is_pair(std::size_t a, std::size_t b) const {
    const Real dx = own_x_[b] - own_x_[a], dy = own_y_[b] - own_y_[a], reach = reach_[a] + reach_[b];
    if (!(dx * dx + dy * dy < reach * reach)) return false;
    if (slim_.empty()) return true;
    const auto drift = [&](std::size_t row) { return Vec2{own_x_[row], own_y_[row]} - slim_.place(row); };
    return !slim_.are_parted(a, b, drift(a), drift(b));
}

template <class Real>
void Candidates<Real>::renew_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    for (const std::int32_t stray : strays_) {
        const auto row = static_cast<std::size_t>(stray);
        Vec2 place{bodies.position_x[row], bodies.position_y[row]};
        if (flows_) {
            set_velocity(row, flow_here(row, place + end.s * Vec2{flow_x_[row], flow_y_[row]}));
            place += end.s * Vec2{flow_x_[row], flow_y_[row]};
        }
        own_x_[row] = static_cast<Real>(place.x), own_y_[row] = static_cast<Real>(place.y);
        reach_[row] = own_reach(bodies, row, end, fall);
        if (!slim_.empty()) set_rectangle(bodies, row, end.s);
        largest_reach_ = std::fmax(largest_reach_, static_cast<double>(reach_[row]));
        if (!is_loose(row)) farthest_ = std::fmax(farthest_, farther_than_first(row));
    }
    renewed_count_ += strays_.size();
    for (const std::int32_t row : strays_) add_pairs_of(bodies, row);
    if (new_pairs_.empty()) return;
    std::sort(new_pairs_.begin(), new_pairs_.end());
    new_pairs_.erase(std::unique(new_pairs_.begin(), new_pairs_.end()), new_pairs_.end());
    const std::size_t merged = added_pairs_.size() + new_pairs_.size();
    // Room of both lists, which take turns, and for a pair a body: a size that is reached now and then needs
    // no memory.
    const std::size_t room = std::bit_ceil(std::max(merged, bodies.count));
    spare_pairs_.reserve(room), added_pairs_.reserve(room);
    spare_pairs_.resize(merged);
    std::merge(added_pairs_.begin(), added_pairs_.end(), new_pairs_.begin(), new_pairs_.end(),
               spare_pairs_.begin());
    added_pairs_.swap(spare_pairs_);
}

/// The grid knows where bodies were. One within its margin has gone from there by its drift and by what its
/// place and reach go beyond the first; drifts differ by their distance.
template <class Real>
std::size_t Candidates<Real>::find_around(std::size_t row, double radius, Vec2 at,
                                          Column<std::int32_t>& out) const {
    const Vec2 way = at - Vec2{own_x_[row], own_y_[row]};
    const double apart = std::sqrt(length_squared(way)) + radius + largest_reach_;
    const Vec2 place = at - drift_of(row);
    const double rounding = kRoundingOfPlace<Real> * (std::fabs(place.x) + std::fabs(place.y));
    if (is_loose(row)) return find_margins_near(at, radius + largest_reach_, out);
    return find_rows_near(place, radius + farthest_ + kSteepnessThen * steepness_ * apart + rounding, out);
}

template <class Real>
void Candidates<Real>::add_pairs_of(const Bodies<Real>& bodies, std::int32_t row) {
    const auto i = static_cast<std::size_t>(row);
    // The grid knows where bodies were; those that are near have drifted nearly as far.
    const double reach = reach_[i];
    const double difference = kSteepnessThen * steepness_ * (reach + largest_reach_);
    const Vec2 place = Vec2{own_x_[i], own_y_[i]} - drift_of(i);
    const double rounding = kRoundingOfPlace<Real> * (std::fabs(place.x) + std::fabs(place.y));
    const auto compare_with = [&](std::size_t j) {
        const auto other = static_cast<std::int32_t>(j);
        if (other == row || !is_pair(i, j) || was_pair(i, j)) return;
        if (bodies.is_immovable(i) && bodies.is_immovable(j)) return;
        const Pair pair{std::min(row, other), std::max(row, other)};
        if (!std::binary_search(added_pairs_.begin(), added_pairs_.end(), pair)) new_pairs_.push_back(pair);
    };
    if (is_loose(i)) {  // the grid knows nothing of it
        for (std::size_t j = 0; j < bodies.count; ++j) {
            const Real dx = own_x_[j] - own_x_[i], dy = own_y_[j] - own_y_[i], sum = reach_[i] + reach_[j];
            if (dx * dx + dy * dy < sum * sum && (bodies.flags_of(j) & kNotInGrid) == 0) compare_with(j);
        }
        return;
    }
    const std::size_t found = find_rows_near(place, reach + farthest_ + difference + rounding, near_);
    for (std::size_t k = 0; k < found; ++k) compare_with(static_cast<std::size_t>(near_[k]));
}

template float Candidates<float>::own_reach(const Bodies<float>&, std::size_t, const FlightClock&,
                                            double) const;
template double Candidates<double>::own_reach(const Bodies<double>&, std::size_t, const FlightClock&,
                                              double) const;
template void Candidates<float>::choose_own_margins(const Bodies<float>&, const FlightClock&, Vec2,
                                                    const ShapeStore<float>*, const Executor&);
template void Candidates<double>::choose_own_margins(const Bodies<double>&, const FlightClock&, Vec2,
                                                     const ShapeStore<double>*, const Executor&);
template void Candidates<float>::renew_margins(const Bodies<float>&, const FlightClock&, Vec2);
template void Candidates<double>::renew_margins(const Bodies<double>&, const FlightClock&, Vec2);
template std::size_t Candidates<float>::find_around(std::size_t, double, Vec2, Column<std::int32_t>&) const;
template std::size_t Candidates<double>::find_around(std::size_t, double, Vec2, Column<std::int32_t>&) const;
template void Candidates<float>::add_pairs_of(const Bodies<float>&, std::int32_t);
template void Candidates<double>::add_pairs_of(const Bodies<double>&, std::int32_t);
template bool Candidates<float>::was_pair(std::size_t, std::size_t) const;
template bool Candidates<double>::was_pair(std::size_t, std::size_t) const;
template bool Candidates<float>::is_pair(std::size_t, std::size_t) const;
template bool Candidates<double>::is_pair(std::size_t, std::size_t) const;

}  // namespace carom
