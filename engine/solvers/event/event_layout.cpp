#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/event/event_dynamics.hpp"

// How solver `event` lays out its discs: order, cells, scales of time.

namespace carom {
namespace {

// The typical time is that in which the smallest disc flies its radius at a typical speed.
constexpr double kCollapseFraction = 1e-4;  // typical times: contact time of the rule against collapse
constexpr double kSameInstant = 1e-11;      // typical times: impacts this near are at one instant
constexpr double kSlowest = 1e-14;          // typical speeds: discs leave an impact no slower; round-off
constexpr double kLongestClock = 1024;      // typical times: the clock begins anew then, for its resolution
constexpr double kDiscsACell = 1;           // discs a cell on average, unless their size makes cells larger
constexpr std::size_t kFewDiscs = 16;       // up to this number all discs are neighbours
constexpr double kBoundless = 1e12;         // m, size of a cell for so few: one holds all
constexpr std::size_t kMostLarge = 32;      // discs that are kept out of the cells
/// Discs are sorted anew after this many impacts a disc on average: it has moved by some cells by then.
constexpr std::int64_t kImpactsBetweenSorts = 40;

struct Bounds {
    Vec2 min{kNever, kNever}, max{-kNever, -kNever};

    void include(Vec2 x) {
        min = {std::min(min.x, x.x), std::min(min.y, x.y)};
        max = {std::max(max.x, x.x), std::max(max.y, x.y)};
    }
    Vec2 size() const { return max - min; }
};

/// Reorders a column: new row i is the old row order[i].
template <class T>
void permute(Column<T>& column, const std::vector<std::int32_t>& order) {
    const Column<T> old = column;
    for (std::size_t i = 0; i < order.size(); ++i) column[i] = old[static_cast<std::size_t>(order[i])];
}

}  // namespace

void EventDynamics::load(std::span<const EventBody> bodies, const EventLaws& laws) {
    store_.laws = laws;
    time_ = 0;
    const std::size_t count = bodies.size();
    store_.movers.resize(count), store_.surfaces.resize(count), store_.forecasts.resize(count);
    store_.row_of.resize(count), store_.disc_of.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const EventBody& body = bodies[i];
        EventMover& mover = store_.movers[i] = {};
        mover.position = body.position, mover.velocity = body.velocity, mover.radius = body.radius;
        EventSurface& surface = store_.surfaces[i] = {};
        surface.inverse_mass = body.inverse_mass, surface.inverse_inertia = body.inverse_inertia;
        surface.restitution = body.restitution, surface.friction = body.friction;
        surface.spin = body.spin, surface.angle = body.angle;
    }
    std::iota(store_.row_of.begin(), store_.row_of.end(), 0);
    set_scales();
    arrange();
}

void EventDynamics::set_scales() {
    double squares = 0, moving = 0, smallest = kNever;
    for (std::size_t i = 0; i < store_.count(); ++i) {
        const EventMover& mover = store_.movers[i];
        smallest = std::min(smallest, mover.radius);
        if (store_.surfaces[i].inverse_mass == 0 && mover.velocity == Vec2{}) continue;
        squares += length_squared(mover.velocity);
        ++moving;
    }
    const double thermal = moving > 0 ? std::sqrt(squares / moving) : 0;
    const double falling = std::sqrt(std::sqrt(length_squared(store_.laws.gravity)) * smallest);
    const double speed = store_.count() > 0 ? std::max(thermal, falling) : 0;
    const double typical_time = speed > 0 ? smallest / speed : 0;
    impacts_.rule = {kCollapseFraction * typical_time, kSlowest * speed};
    same_instant_ = kSameInstant * typical_time;
    longest_clock_ = typical_time > 0 ? kLongestClock * typical_time : kNever;
    impacts_.counters = &counters_;
}

/// The radius up to which discs go into cells. Each disc left out is looked at by all others, each time; left
/// in, it would make the cells larger for all.
double EventDynamics::find_cell_radius(Vec2 box) const {
    std::vector<double> radii;
    for (const EventMover& mover : store_.movers) radii.push_back(mover.radius);
    const std::size_t most = std::min(kMostLarge + 1, radii.size());
    if (most == 0) return 0;
    std::partial_sort(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(most), radii.end(),
                      std::greater<>());
    const double count = static_cast<double>(radii.size());
    const double density = count / ((box.x + 2 * radii.back()) * (box.y + 2 * radii.back()));
    double best = kNever, chosen = radii.front();
    for (std::size_t large = 0; large < most; ++large) {
        const double nine_cells = std::min(count, 36 * density * radii[large] * radii[large]);
        const double looks = std::max(nine_cells, 9 * kDiscsACell) + static_cast<double>(large);
        if (looks < best) best = looks, chosen = radii[large];
    }
    return chosen;
}

/// Sorts the discs, registers them in their cells, and foresees each one's next event.
void EventDynamics::arrange() {
    const std::size_t count = store_.count();
    Bounds box;
    std::vector<Vec2> positions(count);
    for (std::size_t i = 0; i < count; ++i) {
        positions[i] = store_.position_at(i, time_);
        box.include(positions[i]);
    }
    const Vec2 size = count > 0 ? box.size() : Vec2{};
    cell_radius_ = find_cell_radius(size);
    const double share =
        (size.x + 2 * cell_radius_) * (size.y + 2 * cell_radius_) / std::max(1.0, static_cast<double>(count));
    cells_.reset(cell_radius_, count <= kFewDiscs ? kBoundless : std::sqrt(kDiscsACell * share), size, count);
    sort_discs(positions);
    std::span<EventMover> movers{store_.movers.data(), count};
    for (std::size_t disc = 0; disc < count; ++disc)
        if (!store_.is_large(disc))
            cells_.insert(movers, static_cast<std::int32_t>(disc), store_.position_at(disc, time_));
    queue_.reset(count);
    for (std::size_t disc = 0; disc < count; ++disc) forecast(disc, time_);
    sorted_at_ = counters_.impacts;
}

/// Movable discs by cell, movable large ones, immovable large ones, the other immovable ones.
void EventDynamics::sort_discs(std::span<const Vec2> positions) {
    const std::size_t count = store_.count();
    struct Place {
        int kind;
        std::size_t list;
        std::int32_t disc;
        bool operator<(const Place& o) const {
            return kind != o.kind ? kind < o.kind : list != o.list ? list < o.list : disc < o.disc;
        }
    };
    std::vector<Place> places(count);
    for (std::size_t i = 0; i < count; ++i) {
        const bool is_movable = store_.surfaces[i].inverse_mass > 0;
        const bool is_large = store_.movers[i].radius > cell_radius_;
        places[i] = {is_movable ? int{is_large} : 3 - int{is_large}, cells_.list_at(positions[i]),
                     static_cast<std::int32_t>(i)};
    }
    std::sort(places.begin(), places.end());
    const auto begin_of = [&](int kind) {
        return static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), Place{kind, 0, -1}) -
                                        places.begin());
    };
    store_.large_begin = begin_of(1), store_.first_immovable = begin_of(2), store_.large_end = begin_of(3);

    std::vector<std::int32_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = places[i].disc;
    permute(store_.movers, order), permute(store_.surfaces, order);
    const std::vector<std::int32_t> rows = store_.row_of;
    for (std::size_t i = 0; i < count; ++i) {
        store_.row_of[i] = rows[static_cast<std::size_t>(order[i])];
        store_.disc_of[static_cast<std::size_t>(store_.row_of[i])] = static_cast<std::int32_t>(i);
        store_.forecasts[i] = {};
    }
}

/// Makes the present moment the zero of the clock, and sorts the discs if they have moved far since.
void EventDynamics::restart_clock() {
    for (std::size_t i = 0; i < store_.count(); ++i) {
        store_.movers[i].time -= time_;
        store_.surfaces[i].angle_time -= time_, store_.surfaces[i].last_impact -= time_;
        EventForecast& f = store_.forecasts[i];
        f.impact_time -= time_, f.exit_time -= time_;
    }
    time_ = 0;
    const auto count = static_cast<std::int64_t>(store_.count());
    if (counters_.impacts - sorted_at_ > kImpactsBetweenSorts * count) return arrange();
    for (std::size_t i = 0; i < store_.count(); ++i) queue_.set(i, store_.forecasts[i].time());
}

std::optional<EventDynamics::Overlap> EventDynamics::find_overlap(double fraction) const {
    std::optional<Overlap> found;
    const auto compare = [&](std::size_t a, std::size_t b) {
        if (a == b || (store_.is_immovable(a) && store_.is_immovable(b))) return;
        const double ra = store_.movers[a].radius, rb = store_.movers[b].radius;
        const Vec2 d = store_.position_at(b, time_) - store_.position_at(a, time_);
        const double separation = std::sqrt(length_squared(d)) - (ra + rb);
        const auto first = std::min(store_.row_of[a], store_.row_of[b]);
        const auto second = std::max(store_.row_of[a], store_.row_of[b]);
        if (separation >= -fraction * std::min(ra, rb)) return;
        if (!found || first < found->a || (first == found->a && second < found->b))
            found = Overlap{first, second, separation};
    };
    for (std::size_t disc = 0; disc < store_.first_immovable; ++disc) {
        for_each_neighbour(disc, [&](std::size_t other) { compare(disc, other); });
        const Vec2 x = store_.position_at(disc, time_);
        const double radius = store_.movers[disc].radius;
        for (std::int32_t side = 0; side < 4; ++side) {
            const EventWall& wall = store_.laws.walls[static_cast<std::size_t>(side)];
            const double clearance = dot(wall.normal, x) - wall.offset - radius;
            if (wall.is_closed && clearance < -fraction * radius &&
                (!found || store_.row_of[disc] < found->a))
                found = Overlap{store_.row_of[disc], -1 - side, clearance};
        }
    }
    return found;
}

}  // namespace carom
