#include "broadphase/candidates.hpp"

#include <algorithm>
#include <cmath>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

// The common margin of a body: this many steps of the fastest body, between fractions of the largest and
// smallest radius. docs/decisions/0002 has the measurements.
constexpr double kStepsOfFastest = 2;
constexpr double kSmallestMargin = 0.05;  // least margin, in smallest radii
constexpr double kLargestMargin = 1;      // largest margin, in largest radii
// A body that crosses more than the common margin in one step gets its own path, and this much more for
// deflections.
constexpr double kOwnMargin = 1.25;

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
    for (Column<Real>* column : {&first_reach_, &drift_x_, &drift_y_, &flow_x_, &flow_y_, &rate_})
        names_.move(*column, [](std::size_t) { return Real(0); });
    names_.move(own_x_, [&](std::size_t row) { return bodies.position_x[row]; });
    names_.move(own_y_, [&](std::size_t row) { return bodies.position_y[row]; });
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
std::size_t Candidates<Real>::bytes() const {
    return grid_.bytes() + stray_rows_.bytes() + names_.bytes() + reach_.bytes() + own_x_.bytes() +
           own_y_.bytes() + first_reach_.bytes() + drift_x_.bytes() + drift_y_.bytes() + flow_x_.bytes() +
           flow_y_.bytes() + rate_.bytes() + flow_.bytes() + slim_.bytes() +
           (new_pairs_.capacity() + added_pairs_.capacity() + spare_pairs_.capacity()) * sizeof(Pair);
}

template class Candidates<float>;
template class Candidates<double>;

}  // namespace carom
