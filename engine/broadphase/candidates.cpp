#include "broadphase/candidates.hpp"

#include <cmath>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

// The common margin of a body: this many steps of the fastest body, between fractions of the largest and
// smallest radius. docs/decisions/0002 has the measurements.
constexpr double kStepsOfFastest = 1.25;
constexpr double kSmallestMargin = 0.05;  // of the smallest radius
constexpr double kLargestMargin = 0.5;    // of the largest radius
// A body that crosses more than the common margin in one step gets its own path, and this much more for
// deflections.
constexpr double kOwnMargin = 1.25;

// Bodies drift slowly compared to steps; sorting rows more often than this gains nothing that was measured.
constexpr std::int64_t kRebuildsBetweenSorts = 32;

}  // namespace

template <class Real>
void Candidates<Real>::prepare(std::size_t count) {
    if (reach_.size() == count) return;
    reach_.resize(count);
    is_valid_ = false;
}

template <class Real>
void Candidates<Real>::choose_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    const auto travel_of = [&](std::size_t row) {
        const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
        return std::sqrt(length_squared(v)) * end.s + fall;
    };
    double fastest = 0;
    smallest_radius_ = bodies.count > 0 ? bodies.radius[0] : 0, largest_radius_ = smallest_radius_;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        fastest = std::fmax(fastest, travel_of(row));
        smallest_radius_ = std::fmin(smallest_radius_, bodies.radius[row]);
        largest_radius_ = std::fmax(largest_radius_, bodies.radius[row]);
    }
    const double common = std::fmax(kSmallestMargin * smallest_radius_,
                                    std::fmin(kStepsOfFastest * fastest, kLargestMargin * largest_radius_));
    for (std::size_t row = 0; row < bodies.count; ++row)
        reach_[row] = static_cast<Real>(bodies.radius[row] + std::fmax(common, kOwnMargin * travel_of(row)));
}

template <class Real>
void Candidates<Real>::update(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                              bool is_displaced, const KernelTable<Real>& kernels, const Executor& executor) {
    if (is_valid_ && !is_displaced) return;
    choose_margins(bodies, end, gravity);
    grid_.build({bodies.count, bodies.position_x.data(), bodies.position_y.data(), reach_.data(),
                 bodies.has_flags ? bodies.flags.data() : nullptr},
                kernels, executor);
    grid_.find_candidates(executor);
    is_valid_ = true;
    ++rebuild_count_;
}

template <class Real>
std::size_t Candidates<Real>::find_near(std::int32_t row, Vec2 end, double radius,
                                        Column<std::int32_t>& out) const {
    const auto i = static_cast<std::size_t>(row);
    const Real x = built_x()[i], y = built_y()[i];
    const Vec2 way = end - Vec2{x, y};
    const double needed = radius + std::sqrt(length_squared(way));
    const Real reach = needed > reach_[i] ? static_cast<Real>(needed) : reach_[i];
    return grid_.find_near(x, y, reach, out);
}

template <class Real>
std::size_t Candidates<Real>::bytes() const {
    return grid_.bytes() + reach_.bytes();
}

template class Candidates<float>;
template class Candidates<double>;

}  // namespace carom
