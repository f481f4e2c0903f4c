#include "broadphase/moving_places.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// A cell in reaches: two bodies that are nearer to each other than twice the sum of their reaches are in
/// cells that touch.
constexpr double kCellInReaches = 4;
/// A field that takes more of a distance is not followed: bodies farther from each other than those must not
/// meet.
constexpr double kLargestStretch = 0.25;
/// A flow that carries no body farther than this share of the usual radius in a step is not followed.
constexpr double kStillFlow = 0.005;
/// A flow is followed if places may drift with it for at least so many steps: a single body that is faster
/// than that would else have all pairs found anew every other step.
constexpr double kFewestFlowSteps = 4;
/// Places may drift for so many steps with a flow that carries one body in so many as fast as that: discs
/// that fall side by side stay each other's neighbours. What they reach of walls and edges is looked for as
/// far.
constexpr double kStepsOfSwiftFlow = 8;
constexpr std::size_t kBodiesPerSwift = 16;
/// No flow is followed if more than one body in this many is immovable.
constexpr std::size_t kBodiesPerImmovable = 32;
/// Steps of the iteration that finds where a place was before it jumped. Each one's error is the stretch
/// times the last one's: with a stretch of 0.02 the place found is off by 1e-10 of a margin.
constexpr int kGuesses = 5;
/// After n attempts to follow the flow that failed in a row, only one occasion in n is used, and n is at most
/// this.
constexpr int kMostLeftOut = 8;

// Rounding a place and a reach to Real takes at most this share of both from a margin in a step.
template <class Real>
constexpr double kRoundingOfMargin = sizeof(Real) == sizeof(float) ? 2.4e-7 : 5e-16;

// ns a body on one thread, for the executor.
constexpr double kNanosecondsToMove = 1, kNanosecondsToFollow = 15, kNanosecondsToBegin = 10;

bool takes_part(std::uint8_t flags) {
    return (flags & kNotInGrid) == 0;
}

}  // namespace

/// Mean velocities, and the mean of how far bodies will be from their places at the end of the step.
template <class Real>
void MovingPlaces<Real>::measure_flow(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                                      bool is_new) {
    flow_.begin();
    const Vec2 fall = end.q * gravity;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (!takes_part(bodies.flags_of(row))) continue;
        const Vec2 x{bodies.position_x[row], bodies.position_y[row]};
        const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
        if (is_new) {
            flow_.add(x, {}, v);
            continue;
        }
        flow_.add(place(row), x + end.s * v + fall - place(row), v);
    }
    flow_.finish();
}

/// The velocity of a row's place, and what its reach loses by that. Of how far it has drifted the part since
/// the flow was measured is left to drift_of.
template <class Real>
void MovingPlaces<Real>::set_velocity(std::size_t row, const MeanFlow::At& flow) {
    drift_x_[row] += static_cast<Real>(since_flow_) * (flow_x_[row] - static_cast<Real>(flow.velocity.x));
    drift_y_[row] += static_cast<Real>(since_flow_) * (flow_y_[row] - static_cast<Real>(flow.velocity.y));
    flow_x_[row] = static_cast<Real>(flow.velocity.x), flow_y_[row] = static_cast<Real>(flow.velocity.y);
    rate_[row] = static_cast<Real>(flow_is_local_ ? flow.rate : flow_.most().rate);
}

/// The flow around a body says nothing of bodies farther away than a cell. If a reach is as large as that,
/// all reaches shrink at the rate of the place where the flow closes fastest.
template <class Real>
void MovingPlaces<Real>::note_reach(double reach) {
    largest_reach_ = std::max(largest_reach_, reach);
    if (!flows_ || !flow_is_local_ || flow_.side() >= kCellInReaches * reach) return;
    flow_is_local_ = false;
    std::fill(rate_.begin(), rate_.end(), static_cast<Real>(flow_.most().rate));
}

/// The flow at a place that bodies around it have reached by following it.
template <class Real>
MeanFlow::At MovingPlaces<Real>::flow_here(std::size_t row, Vec2 at) const {
    // The fields are over where places were when they were measured: each guess is better than the one before
    // by the stretch.
    Vec2 before = at - since_flow_ * velocity(row);
    for (int guess = 0; guess < kGuesses; ++guess) {
        const MeanFlow::At flow = flow_.at(before);
        before = at - flow.jump - since_flow_ * flow.velocity;
    }
    return flow_.at(before);
}

template <class Real>
bool MovingPlaces<Real>::move(const Bodies<Real>& bodies, double dt, double most_spread,
                              Column<Real>& reach_of_row, const Executor& executor) {
    if (!flows_) return true;
    const MeanFlow::Most& most = flow_.most();
    drift_left_ -= dt * most.speed, steepness_ += dt * most.gradient_of_velocity;
    since_flow_ += dt;
    if (drift_left_ < 0 || since_flow_ * most.rate > kLargestStretch || spread() > most_spread) return false;
    const auto h = static_cast<Real>(dt), rounding = static_cast<Real>(kRoundingOfMargin<Real>);
    Real *const x = x_.data(), *const y = y_.data(), *const reach = reach_of_row.data();
    const Real *const flow_x = flow_x_.data(), *const flow_y = flow_y_.data(), *const rate = rate_.data();
    const Real *const radius = bodies.radius.data(), uniform_radius = bodies.radius.uniform_value();
    executor.for_each_chunk(reach_of_row.size(), kRowsPerChunk, kNanosecondsToMove,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                // One column at a time: compilers then use their widest registers.
                                for (std::size_t row = first; row < last; ++row) x[row] += h * flow_x[row];
                                for (std::size_t row = first; row < last; ++row) y[row] += h * flow_y[row];
                                for (std::size_t row = first; row < last; ++row) {
                                    const Real left = reach[row] - (h * rate[row] + rounding) * reach[row] -
                                                      rounding * (std::fabs(x[row]) + std::fabs(y[row]));
                                    reach[row] = std::max(left, radius ? radius[row] : uniform_radius);
                                }
                            });
    return true;
}

template <class Real>
bool MovingPlaces<Real>::follow(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                                double most_spread, Column<Real>& reach_of_row,
                                std::vector<std::int32_t>& strays, const Executor& executor) {
    // Bodies that whirl, each on its own, have no flow.
    if (!may_flow_ || ++follows_left_out_ < std::min(failed_follows_, kMostLeftOut)) return false;
    follows_left_out_ = 0, ++failed_follows_;
    measure_flow(bodies, end, gravity, false);
    const MeanFlow::Most& most = flow_.most();
    drift_left_ -= most.jump, steepness_ += most.gradient;
    if (drift_left_ < 0 || most.stretch > kLargestStretch || spread() > most_spread) return false;
    flows_ = true;
    const double since_flow = std::exchange(since_flow_, 0);
    flow_is_local_ = flow_.side() >= kCellInReaches * largest_reach_;
    const Vec2 fall = end.q * gravity;
    // Whether the body is left outside of its margin.
    const auto jump = [&](std::size_t row) {
        if (!takes_part(bodies.flags_of(row))) return false;
        const MeanFlow::At flow = flow_.at(place(row));
        const auto since = static_cast<Real>(since_flow);
        drift_x_[row] += since * flow_x_[row] + static_cast<Real>(flow.jump.x);
        drift_y_[row] += since * flow_y_[row] + static_cast<Real>(flow.jump.y);
        set_velocity(row, flow);
        const double x = x_[row] + flow.jump.x, y = y_[row] + flow.jump.y;
        const double stretch = flow_is_local_ ? flow.stretch : most.stretch;
        const double reach = (1 - stretch - kRoundingOfMargin<Real>)*static_cast<double>(reach_of_row[row]) -
                             kRoundingOfMargin<Real> * (std::fabs(x) + std::fabs(y));
        const double off_x = bodies.position_x[row] + end.s * bodies.velocity_x[row] + fall.x - x,
                     off_y = bodies.position_y[row] + end.s * bodies.velocity_y[row] + fall.y - y;
        x_[row] = static_cast<Real>(x), y_[row] = static_cast<Real>(y);
        reach_of_row[row] = static_cast<Real>(reach);
        const double margin = reach - static_cast<double>(bodies.radius[row]);
        return !(margin > 0) || off_x * off_x + off_y * off_y > margin * margin;
    };
    stray_rows_.prepare(bodies.count, kRowsPerChunk);
    executor.for_each_chunk(bodies.count, kRowsPerChunk, kNanosecondsToFollow,
                            [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                std::int32_t* part = stray_rows_.part(chunk);
                                std::size_t count = 0;
                                for (std::size_t row = first; row < last; ++row)
                                    if (jump(row)) part[count++] = static_cast<std::int32_t>(row);
                                stray_rows_.set_count(chunk, count);
                            });
    strays.clear();
    stray_rows_.for_each_below(bodies.count, [&](std::int32_t row) { strays.push_back(row); });
    return true;
}

template <class Real>
void MovingPlaces<Real>::put(std::size_t row, Vec2 at, double dt) {
    if (flows_) {
        set_velocity(row, flow_here(row, at + dt * velocity(row)));
        at += dt * velocity(row);
    }
    x_[row] = static_cast<Real>(at.x), y_[row] = static_cast<Real>(at.y);
}

template <class Real>
void MovingPlaces<Real>::follow_rows(const RowNames& names, const Bodies<Real>& bodies) {
    for (Column<Real>* column : {&drift_x_, &drift_y_, &flow_x_, &flow_y_, &rate_})
        names.move(*column, [](std::size_t) { return Real(0); });
    names.move(x_, [&](std::size_t row) { return bodies.position_x[row]; });
    names.move(y_, [&](std::size_t row) { return bodies.position_y[row]; });
}

/// How far places may go with the flow that was measured [m].
template <class Real>
double MovingPlaces<Real>::drift_with_flow(const Bodies<Real>& bodies, double usual_radius, double dt) const {
    const double usual = kLargestDrift * usual_radius;
    const double way = dt * flow_.most().speed, swift = usual / (kFewestFlowSteps * dt);  // m, m/s
    if (kFewestFlowSteps * way < usual || dt * flow_.most().rate >= kLargestStretch) return usual;
    std::size_t count = 0;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (!takes_part(bodies.flags_of(row))) continue;
        const Vec2 v = flow_.at({bodies.position_x[row], bodies.position_y[row]}).velocity;
        count += length_squared(v) >= swift * swift;
    }
    return count * kBodiesPerSwift >= bodies.count ? kStepsOfSwiftFlow * way : usual;
}

template <class Real>
void MovingPlaces<Real>::begin(const Bodies<Real>& bodies, std::size_t rows, Lengths usual,
                               const FlightClock& end, Vec2 gravity, const Executor& executor) {
    for (Column<Real>* column : {&x_, &y_, &drift_x_, &drift_y_, &flow_x_, &flow_y_, &rate_})
        column->resize(bodies.count);
    std::copy_n(bodies.position_x.data(), rows, x_.data());
    std::copy_n(bodies.position_y.data(), rows, y_.data());
    for (Column<Real>* column : {&drift_x_, &drift_y_, &flow_x_, &flow_y_, &rate_})
        std::fill_n(column->begin(), rows, Real(0));
    steepness_ = since_flow_ = 0, drift_left_ = largest_drift_ = kLargestDrift * usual.radius;
    may_flow_ = flows_ = false, flow_is_local_ = true, largest_reach_ = 0;
    if (!(usual.reach > 0)) return;   // no discs
    if (bodies.standing > 0) return;  // they are strays in any flow, as below
    flow_.lay_out(bodies.count, bodies.position_x.data(), bodies.position_y.data(),
                  kCellInReaches * usual.reach);
    measure_flow(bodies, end, gravity, true);
    const MeanFlow::Most& most = flow_.most();
    // An immovable body is a stray in any flow.
    std::size_t immovable = 0;
    for (std::size_t row = 0; row < bodies.count && bodies.has_flags; ++row)
        immovable += takes_part(bodies.flags_of(row)) && bodies.is_immovable(row);
    may_flow_ = immovable * kBodiesPerImmovable <= bodies.count;
    if (may_flow_) drift_left_ = largest_drift_ = drift_with_flow(bodies, usual.radius, end.s);
    flows_ = may_flow_ && end.s * most.speed > kStillFlow * usual.radius &&
             end.s * most.rate < kLargestStretch && kFewestFlowSteps * end.s * most.speed < drift_left_;
    if (!flows_) return;
    executor.for_each_chunk(
        bodies.count, kRowsPerChunk, kNanosecondsToBegin,
        [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t row = first; row < last; ++row)
                set_velocity(row, flow_.at({bodies.position_x[row], bodies.position_y[row]}));
        });
}

template <class Real>
std::size_t MovingPlaces<Real>::bytes() const {
    return x_.bytes() + y_.bytes() + drift_x_.bytes() + drift_y_.bytes() + flow_x_.bytes() + flow_y_.bytes() +
           rate_.bytes() + flow_.bytes() + stray_rows_.bytes();
}

template class MovingPlaces<float>;
template class MovingPlaces<double>;

}  // namespace carom
