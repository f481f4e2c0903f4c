#include "broadphase/candidates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

// The common margin of a body (MarginRule::common): this many steps of the fastest body, between fractions of
// the largest and smallest radius. docs/decisions/0002 has the measurements.
constexpr double kStepsOfFastest = 2;
constexpr double kSmallestMargin = 0.05;  // least margin, in smallest radii
constexpr double kLargestMargin = 1;      // largest margin, in largest radii
// A body that crosses more than the common margin in one step gets its own path, and this much more for
// deflections.
constexpr double kOwnMargin = 1.25;

// A margin of a body's own (MarginRule::own): in a pile that heaves some bodies are fast and most are slow.
// docs/decisions/0012-threads-of-soft.md has the measurements.
constexpr double kOwnSteps = 5;          // steps at the body's own speed that a margin is to last
constexpr double kLeastOwnMargin = 0.1;  // own radii, or usual ones if these are less, that every margin has
constexpr double kLargestSize = 4;       // own radii that count as a body's size beside much larger ones
constexpr double kFewestSteps = 1.25;    // steps that a margin lasts, even above the largest margin
constexpr double kFarMargin = 1.25;      // the largest margin of two bodies, beyond which they are a far pair
constexpr double kFlowSteps = 0.7;       // steps of the flow around the body, because the flow changes

// Share of their distance by which the places of two bodies, one of them slim, may come nearer by their
// drifts. So much as in so many steps of the flow of now, between limits.
constexpr double kFlowSpreadSteps = 3, kLeastSpread = 0.02, kMostSpread = 0.1;

constexpr double kNanosecondsToChoose = 4;  // ns a body on one thread, for the executor

// Relative error of a drifted place: drifts are sums, rounded to Real a few times.
template <class Real>
constexpr double kRoundingOfPlace = sizeof(Real) == sizeof(float) ? 1e-6 : 4e-15;

// Strays are looked up one by one while they are fewer than one body in this many.
constexpr std::size_t kBodiesPerStray = 64;

// Rows are sorted by place at the start and then this seldom: bodies drift slowly compared to steps. Columns
// of fewer bodies fit into the first caches in any order; those of very many leave all caches, and disorder
// is dearer.
constexpr std::int64_t kRebuildsBetweenSorts = 32;
constexpr std::int64_t kRebuildsBetweenSortsOfMany = 12;
constexpr std::size_t kManyRows = 65536;
constexpr std::size_t kFewestSortedRows = 1024;

}  // namespace

template <class Real>
void Candidates<Real>::prepare(std::size_t count) {
    if (reach_.size() == count) return;
    reach_.resize(count);
    is_valid_ = radii_are_known_ = is_standing_known_ = false;
}

template <class Real>
void Candidates<Real>::choose_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                                      double fastest) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    const double most = fastest * end.s + fall;
    const double common = std::fmax(kSmallestMargin * radii_.smallest,
                                    std::fmin(kStepsOfFastest * most, kLargestMargin * radii_.largest));
    // A body that crosses more than the common margin in one step.
    const double fast = (common / kOwnMargin - fall) / end.s;
    const bool some_are_fast = most * kOwnMargin > common;
    const std::size_t rows = rows_to_find(bodies);
    for (std::size_t row = 0; row < rows; ++row)
        reach_[row] = static_cast<Real>(static_cast<double>(bodies.radius[row]) + common);
    for (std::size_t row = 0; row < rows && some_are_fast; ++row) {
        const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
        if (length_squared(v) <= fast * fast) continue;
        const double travel = std::sqrt(length_squared(v)) * end.s + fall;
        reach_[row] = static_cast<Real>(static_cast<double>(bodies.radius[row]) + kOwnMargin * travel);
    }
}

/// Radius plus margin of a body [m]: the margin is for what the body does beside the flow around it, and for
/// what that flow will change.
template <class Real>
Real Candidates<Real>::own_reach(const Bodies<Real>& bodies, std::size_t row, const FlightClock& end,
                                 double fall) const {
    const Vec2 flow = places_.velocity(row);
    const Vec2 v = Vec2{bodies.velocity_x[row], bodies.velocity_y[row]} - flow;
    const double travel = std::sqrt(length_squared(v)) * end.s + fall;
    // A small body beside a large one has no use for a margin of the large one's size.
    const double size = std::min(radii_.largest, kLargestSize * static_cast<double>(bodies.radius[row]));
    const double most = std::max(kLargestOwnMargin * size, kFewestSteps * travel);
    const double wanted = kOwnSteps * travel + kFlowSteps * end.s * std::sqrt(length_squared(flow));
    const double least = kLeastOwnMargin * std::min(radii_.usual, static_cast<double>(bodies.radius[row]));
    const double margin = std::max(std::min(wanted, most), least);
    return static_cast<Real>(static_cast<double>(bodies.radius[row]) + margin);
}

template <class Real>
void Candidates<Real>::choose_own_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                                          const ShapeStore<Real>* shapes, const Executor& executor) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    const std::size_t rows = rows_to_find(bodies), moving = bodies.moving();
    places_.begin(bodies, rows, {radii_.usual, (1 + kLargestOwnMargin) * radii_.largest}, end, gravity,
                  executor);
    executor.for_each_chunk(rows, kRowsPerChunk, kNanosecondsToChoose,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t row = first; row < last; ++row)
                                    reach_[row] = own_reach(bodies, row, end, fall);
                            });
    for (std::size_t row = 0; row < moving; ++row) places_.note_reach(reach_[row]);
    if (!is_standing_known_) largest_standing_reach_ = 0;
    for (std::size_t row = moving; row < rows; ++row)
        largest_standing_reach_ = std::fmax(largest_standing_reach_, static_cast<double>(reach_[row]));
    places_.note_reach(largest_standing_reach_);
    first_reach_.resize(bodies.count);
    std::copy_n(reach_.data(), rows, first_reach_.data());
    slim_.clear();
    if (shapes && bodies.has_shapes) slim_.read_shapes(*shapes);
    if (!slim_.empty()) {
        const double of_flow = kFlowSpreadSteps * end.s * places_.gradient_of_velocity();
        slim_.begin(bodies.count, places_.kSteepnessThen * std::clamp(of_flow, kLeastSpread, kMostSpread));
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
    const Column<Real>&x = places_.x(), &y = places_.y();
    const Real dx = x[b] - x[a], dy = y[b] - y[a], reach = reach_[a] + reach_[b];
    if (!(dx * dx + dy * dy < reach * reach)) return false;
    if (slim_.empty()) return true;
    const auto drift = [&](std::size_t row) { return places_.place(row) - slim_.place(row); };
    return !slim_.are_parted(a, b, drift(a), drift(b));
}

/// The bodies that leave their margins get new ones, and only the pairs that come with these are looked for.
template <class Real>
void Candidates<Real>::renew_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity) {
    const double fall = std::sqrt(length_squared(gravity)) * end.q;
    for (const std::int32_t stray : strays_) {
        const auto row = static_cast<std::size_t>(stray);
        places_.put(row, {bodies.position_x[row], bodies.position_y[row]}, end.s);
        reach_[row] = own_reach(bodies, row, end, fall);
        if (!slim_.empty()) set_rectangle(bodies, row, end.s);
        places_.note_renewed_reach(reach_[row]);
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
    if (is_loose(row)) return find_margins_near(at, radius + places_.largest_reach(), out);
    const Vec2 way = at - places_.place(row), place = at - places_.drift_of(row);
    // How far apart places can be of what is found, but for its reach: one of a few huge bodies is no reason
    // to look at all small ones.
    const double apart = std::sqrt(length_squared(way)) + radius + farthest_, spread = places_.spread();
    const double rounding = kRoundingOfPlace<Real> * (std::fabs(place.x) + std::fabs(place.y));
    return find_rows_near(place, radius + farthest_ + spread * apart + rounding, out, spread);
}

template <class Real>
void Candidates<Real>::add_pairs_of(const Bodies<Real>& bodies, std::int32_t row) {
    const auto i = static_cast<std::size_t>(row);
    // The grid knows where bodies were; those that are near have drifted nearly as far.
    const double reach = reach_[i];
    const double spread = places_.spread(), difference = spread * (reach + farthest_);
    const Vec2 place = places_.place(i) - places_.drift_of(i);
    const double rounding = kRoundingOfPlace<Real> * (std::fabs(place.x) + std::fabs(place.y));
    const auto compare_with = [&](std::size_t j) {
        const auto other = static_cast<std::int32_t>(j);
        if (other == row || !is_pair(i, j) || was_pair(i, j)) return;
        if (bodies.is_immovable(i) && bodies.is_immovable(j)) return;
        const Pair pair{std::min(row, other), std::max(row, other)};
        if (!std::binary_search(added_pairs_.begin(), added_pairs_.end(), pair)) new_pairs_.push_back(pair);
    };
    if (is_loose(i)) {  // the grid knows nothing of it
        const Column<Real>&x = places_.x(), &y = places_.y();
        for (std::size_t j = 0; j < bodies.count; ++j) {
            const Real dx = x[j] - x[i], dy = y[j] - y[i], sum = reach_[i] + reach_[j];
            if (dx * dx + dy * dy < sum * sum && (bodies.flags_of(j) & kNotInGrid) == 0) compare_with(j);
        }
        return;
    }
    const std::size_t found = find_rows_near(place, reach + farthest_ + difference + rounding, near_, spread);
    for (std::size_t k = 0; k < found; ++k) compare_with(static_cast<std::size_t>(near_[k]));
}

/// Whether places that jump to where bodies are have saved finding the pairs anew.
template <class Real>
bool Candidates<Real>::follow_flow(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                                   const Executor& executor) {
    if (!places_.follow(bodies, end, gravity, most_spread(), reach_, strays_, executor)) return false;
    slim_.add_turned(bodies, end.s, strays_);
    names_.take_fresh(strays_);
    if (!may_renew(strays_.size(), bodies.count)) return false;
    places_.note_success();
    renew_margins(bodies, end, gravity);
    return true;
}

template <class Real>
void Candidates<Real>::move_places(const Bodies<Real>& bodies, double dt, const Executor& executor) {
    if (rule_ == MarginRule::own && is_valid_)
        is_valid_ = places_.move(bodies, dt, most_spread(), reach_, executor);
}

template <class Real>
bool Candidates<Real>::wants_sorted_rows(std::size_t moving) const {
    return is_valid_ && rebuilds_until_sorted_ == 0 && moving >= kFewestSortedRows;
}

template <class Real>
void Candidates<Real>::note_sorted_rows() {
    rebuilds_until_sorted_ = reach_.size() > kManyRows ? kRebuildsBetweenSortsOfMany : kRebuildsBetweenSorts;
    invalidate();
}

template <class Real>
double Candidates<Real>::overshoot_of(std::int32_t row, double radius, Vec2 end) const {
    const auto i = static_cast<std::size_t>(row);
    const Vec2 way = end - Vec2{built_x()[i], built_y()[i]};
    const double margin = static_cast<double>(reach_[i]) - radius;
    const double squared = length_squared(way);
    return squared > margin * margin ? std::sqrt(squared) - margin : 0;
}

template <class Real>
void Candidates<Real>::update(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                              std::span<const std::int32_t> displaced, double fastest,
                              const KernelTable<Real>& kernels, const Executor& executor,
                              const ShapeStore<Real>* shapes) {
    strays_.clear(), overshoot_ = 0;
    new_pairs_.clear();
    if (shapes && !slim_.empty()) slim_.read_shapes(*shapes);  // forgotten where a state was read
    if (rule_ == MarginRule::own && is_valid_) {
        strays_.assign(displaced.begin(), displaced.end());
        slim_.add_turned(bodies, end.s, strays_);
        if (may_renew(strays_.size() + names_.fresh_count(), bodies.moving())) {
            names_.take_fresh(strays_);
            renew_margins(bodies, end, gravity);
            return;
        }
        strays_.clear();
    }
    if (rule_ == MarginRule::own && is_valid_ && follow_flow(bodies, end, gravity, executor)) return;
    if (rule_ == MarginRule::common && is_valid_ && displaced.size() * kBodiesPerStray <= bodies.moving()) {
        strays_.assign(displaced.begin(), displaced.end());
        for (const std::int32_t row : strays_) {
            const auto i = static_cast<std::size_t>(row);
            const Vec2 v{bodies.velocity_x[i], bodies.velocity_y[i]};
            const Vec2 x{bodies.position_x[i], bodies.position_y[i]};
            overshoot_ =
                std::fmax(overshoot_, overshoot_of(row, bodies.radius[i], x + end.s * v + end.q * gravity));
        }
        return;
    }
    if (!radii_are_known_) radii_ = measure_radii(bodies);
    radii_are_known_ = true;
    if (rule_ == MarginRule::own)
        choose_own_margins(bodies, end, gravity, shapes, executor);
    else
        choose_margins(bodies, end, gravity, fastest);
    if (!names_.empty()) names_.forget();
    grid_.build({bodies.count, bodies.position_x.data(), bodies.position_y.data(), reach_.data(),
                 bodies.has_flags ? bodies.flags.data() : nullptr, bodies.standing, is_standing_known_},
                kernels, executor);
    is_standing_known_ = bodies.standing > 0;
    grid_.find_candidates(executor);
    if (!slim_.empty())
        grid_.keep_pairs([&](std::int32_t* a, std::int32_t* b, std::size_t count) {
            return slim_.drop_parted(kernels, a, b, count);
        });
    is_valid_ = true;
    if (rule_ == MarginRule::own) move_places(bodies, end.s, executor);  // to the end of this step
    ++rebuild_count_;
    if (rebuilds_until_sorted_ > 0) --rebuilds_until_sorted_;
}

template <class Real>
void Candidates<Real>::follow_rows(const Bodies<Real>& bodies, std::span<const std::int32_t> now,
                                   std::span<const std::uint8_t> is_elsewhere) {
    is_standing_known_ = false;
    renewed_count_ += names_.follow(bodies.count, now, is_elsewhere);
    places_.follow_rows(names_, bodies);
    slim_.follow_rows(names_);
    names_.move(first_reach_, [](std::size_t) { return Real(0); });
    names_.move(reach_, [&](std::size_t row) { return bodies.radius[row]; });
    std::erase_if(added_pairs_, [&](Pair& pair) {
        const std::int32_t a = now[static_cast<std::size_t>(pair.a)],
                           b = now[static_cast<std::size_t>(pair.b)];
        pair = {std::min(a, b), std::max(a, b)};
        return pair.a < 0 || is_elsewhere[static_cast<std::size_t>(a)] ||
               is_elsewhere[static_cast<std::size_t>(b)];
    });
    std::sort(added_pairs_.begin(), added_pairs_.end());
}

template <class Real>
std::size_t Candidates<Real>::count_far_pairs(const Bodies<Real>& bodies) const {
    if (!is_valid_) return 0;
    const auto far = [&](std::int32_t of) {
        const auto row = static_cast<std::size_t>(of);
        const auto radius = static_cast<double>(bodies.radius[row]);
        const double size = std::min(radii_.largest, kLargestSize * radius);
        return static_cast<double>(reach_[row]) - radius - kFarMargin * kLargestOwnMargin * size;
    };
    const std::int32_t *a = pair_a(), *b = pair_b();
    std::size_t count = 0;
    for (std::size_t i = 0; i < pair_count(); ++i) count += far(a[i]) + far(b[i]) > 0 ? 1 : 0;
    return count;
}

template <class Real>
std::size_t Candidates<Real>::bytes() const {
    return grid_.bytes() + names_.bytes() + places_.bytes() + reach_.bytes() + first_reach_.bytes() +
           slim_.bytes() +
           (new_pairs_.capacity() + added_pairs_.capacity() + spare_pairs_.capacity()) * sizeof(Pair);
}

template class Candidates<float>;
template class Candidates<double>;

}  // namespace carom
