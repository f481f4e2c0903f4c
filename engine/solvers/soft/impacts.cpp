#include "solvers/soft/impacts.hpp"

#include <algorithm>
#include <cmath>

#include "effects/restitution.hpp"
#include "math/vec2_math.hpp"
#include "narrowphase/coincident.hpp"
#include "narrowphase/impact_time.hpp"

namespace carom {
namespace {

/// What comes slower than gravity would make it in this many substeps is at rest and does not bounce.
constexpr double kRestingFalls = 2;
/// Separation that the sweeps see in place of that of an impact [m]: too far for them to do anything.
template <class Real>
constexpr Real kFar = Real(1e20);
/// Overlap beyond which the sweeps part two bodies, in radii of the smaller one.
constexpr double kOverlap = 1e-3;
/// A contact that is pressed is an impact again if its bodies would come so deep into each other until the
/// end of the substep, in radii of the smaller one.
constexpr double kDeepening = 0.01;

// The budget of a body in a step: docs/decisions/0022-impacts-in-soft.md has the measurements.
constexpr float kBudget = 8;
/// Spent beyond the budget, on impacts without restitution; what more there is has to wait for the sweeps.
constexpr float kOverdraft = 8;
/// An impact costs so much for each unit of 1 - e, but at most 1; and so much besides.
constexpr double kCostOfLoss = 10, kCostOfOne = 0.02;
/// Impacts at this share of the fastest of the step are not those of a collapse: they cost a tenth.
constexpr double kFastShare = 0.15, kCostOfFast = 0.1;

/// A velocity that changes in a substep as gravity would change it, to this share of it, squared, falls.
template <class Real>
constexpr Real kOffFall = Real(1e-6);

/// Two surfaces touch if they are as near as this, in their reach.
template <class Real>
constexpr double kTouching = sizeof(Real) == sizeof(float) ? 1e-7 : 1e-14;

}  // namespace

template <class Real>
Partner Impacts<Real>::partner_of(Place place) const {
    return place.is_support
               ? candidates_->partner(static_cast<std::size_t>(supports_->candidate[place.index]))
               : Partner::body(pairs_->b[place.index]);
}

template <class Real>
bool Impacts<Real>::is_impact(Place place) const {
    return store_of(place).separation[place.index] == kFar<Real>;
}

template <class Real>
double Impacts<Real>::restitution_of(Place place) const {
    const Bodies<Real>& bodies = world_->bodies;
    const double of_a = bodies.restitution[static_cast<std::size_t>(store_of(place).a[place.index])];
    const Partner other = partner_of(place);
    if (other.is_wall()) return pair_restitution(of_a, world_->walls->material.restitution);
    const auto row = static_cast<std::size_t>(
        other.is_edge() ? world_->handles.row_of_slot(world_->edges.body_of(other.edge_number()).id.index)
                        : static_cast<std::size_t>(other.row()));
    return pair_restitution(of_a, bodies.restitution[row]);
}

template <class Real>
double Impacts<Real>::smaller_radius(Place place) const {
    const double of_a = world_->bodies.radius[static_cast<std::size_t>(store_of(place).a[place.index])];
    const Partner other = partner_of(place);
    return other.is_body()
               ? std::min(of_a,
                          static_cast<double>(world_->bodies.radius[static_cast<std::size_t>(other.row())]))
               : of_a;
}

template <class Real>
auto Impacts<Real>::tally_of(std::int32_t row) -> Tally& {
    Tally& tally = tallies_[static_cast<std::size_t>(row)];
    if (tally.step != step_) tally = {tally.impacts, step_, 0, 0};
    return tally;
}

/// What comes fast enough, and may come to touch in this step, is an impact.
template <class Real>
void Impacts<Real>::mark_in(ContactRows<Real>& rows, bool are_supports, std::size_t first, std::size_t last,
                            double dt) {
    const double slack = std::sqrt(length_squared(gravity_)) * dt * dt;
    for (std::size_t i = first; i < last; ++i) {
        const double approach = rows.approach[i];
        if (rows.normal_impulse[i] > 0 || !(approach < -rest_speed_) || !(rows.mass[i] > 0)) continue;
        const double separation = rows.separation[i];
        if (separation > slack - dt * approach) continue;
        const Place place{static_cast<std::uint32_t>(i) & 0x7fffffffu, are_supports};
        if (separation < -kOverlap * smaller_radius(place) || !(restitution_of(place) > 0)) continue;
        rows.separation[i] = kFar<Real>;
        impacts_.push_back(place);
    }
}

template <class Real>
void Impacts<Real>::mark(const WorldState<Real>& world, ContactRows<Real>& pairs, std::int64_t version,
                         ContactRows<Real>& supports, const ContactRows<Real>& candidates, double dt,
                         double h, Vec2 gravity_change) {
    world_ = &world, pairs_ = &pairs, supports_ = &supports, candidates_ = &candidates;
    rest_speed_ = kRestingFalls * std::sqrt(length_squared(gravity_change));
    gravity_ = (1 / h) * gravity_change;
    ++step_;
    impacts_.clear();
    are_supports_known_ = false;
    version_ = version;
    for (std::size_t group = 0; group < pairs.groups(); ++group) {
        const typename ContactRows<Real>::Run* run =
            pairs.run.data() + pairs.first_place(group) / kContactBlock;
        for (std::size_t r = 0; r < pairs.run_count[group]; ++r)
            mark_in(pairs, false, kContactBlock * run[r].first, kContactBlock * run[r].last, dt);
    }
    supports.for_each([&](std::size_t i) { mark_in(supports, true, i, i + 1, dt); });
}

/// The path by which kernels/advance_bodies.hpp will move a body.
template <class Real>
auto Impacts<Real>::path_of(std::int32_t number) const -> Path {
    const auto row = static_cast<std::size_t>(number);
    const Bodies<Real>& bodies = world_->bodies;
    if (row >= bodies_->count) return {{bodies.position_x[row], bodies.position_y[row]}, {}, {}};
    const Real* record = bodies_->velocity + 4 * row;
    const Real start_x = bodies_->start.x[row], start_y = bodies_->start.y[row];
    const Vec2 x = Vec2{bodies_->origin[4 * row], bodies_->origin[4 * row + 1]} +
                   Vec2{bodies_->displacement[2 * row], bodies_->displacement[2 * row + 1]};
    if (record[3] == 0) return {x, {record[0], record[1]}, {}};
    const Real change_x = record[0] - start_x, change_y = record[1] - start_y;
    const Real fall_x = bodies_->decay * start_x + bodies_->gain_x - start_x,
               fall_y = bodies_->decay * start_y + bodies_->gain_y - start_y;
    const Real fall = fall_x * fall_x + fall_y * fall_y;
    const bool is_smooth = change_x * change_x + change_y * change_y <= fall * Real(1.0001);
    if (!is_smooth) return {x, {record[0], record[1]}, {}};
    // Bodies that fall alike meet on straight lines: they have the same bits of acceleration.
    const Real off_x = change_x - fall_x, off_y = change_y - fall_y;
    const bool falls = off_x * off_x + off_y * off_y <= fall * kOffFall<Real>;
    if (falls && bodies_->decay == 1) return {x, {start_x, start_y}, gravity_};
    return {x, {start_x, start_y}, (1 / bodies_->h) * Vec2{change_x, change_y}};
}

template <class Real>
DoubleBody Impacts<Real>::body_of(std::int32_t row, const Path& path, double time) const {
    DoubleBody body{{{0, 0, 0, 0}}};
    if (static_cast<std::size_t>(row) < bodies_->count) {
        body = body_at(bodies_->velocity, row);
        const Vec2 v = path.velocity_at(time);
        body.record[0] = v.x, body.record[1] = v.y;
    }
    return body;
}

/// When the surfaces of a contact meet, from a time in the substep on; kNever if not in this substep.
template <class Real>
double Impacts<Real>::time_of(Place place, double from) const {
    const ContactRows<Real>& rows = store_of(place);
    const std::int32_t row = rows.a[place.index];
    const Partner other = partner_of(place);
    const Path a = path_of(row);
    const Window window{from, bodies_->h, 0};
    if (!other.is_body()) {
        const Vec2 n{rows.normal_x[place.index], rows.normal_y[place.index]};
        const Vec2 moved{bodies_->displacement[2 * static_cast<std::size_t>(row)],
                         bodies_->displacement[2 * static_cast<std::size_t>(row) + 1]};
        const double surface = rows.surface_normal[place.index];
        const double clearance =
            static_cast<double>(rows.clearance[place.index]) + surface * bodies_->elapsed - dot(moved, n);
        return wall_impact_time(clearance, surface - dot(a.v, n), -dot(a.acceleration, n), window);
    }
    const Path b = path_of(other.row());
    const Bodies<Real>& all = world_->bodies;
    const double reach = static_cast<double>(all.radius[static_cast<std::size_t>(row)]) +
                         static_cast<double>(all.radius[static_cast<std::size_t>(other.row())]);
    const Flight relative{b.x - a.x, b.v - a.v, b.acceleration - a.acceleration};
    if (relative.acceleration == Vec2{})
        return straight_impact_time(relative.position + from * relative.velocity, relative.velocity, reach,
                                    window);
    return accelerated_impact_time(relative, reach, window, kTouching<Real> * reach);
}

/// Speed below which the approach of two surfaces is round-off [m/s].
template <class Real>
double Impacts<Real>::noise_of(Place place) const {
    constexpr double kUnits = 8;
    const auto speed = [&](std::int32_t row) {
        const Vec2 v = path_of(row).v;
        return std::fabs(v.x) + std::fabs(v.y);
    };
    const Partner other = partner_of(place);
    return kUnits * std::numeric_limits<Real>::epsilon() *
           (speed(store_of(place).a[place.index]) + (other.is_body() ? speed(other.row()) : 0));
}

template <class Real>
void Impacts<Real>::foresee(Place place, double from) {
    const double time = time_of(place, from);
    if (!(time <= bodies_->h)) return;
    const std::int32_t a = store_of(place).a[place.index];
    const Partner b = partner_of(place);
    queue_.push_back({time, place, a, b.stored(), tallies_[static_cast<std::size_t>(a)].impacts,
                      place.is_support ? 0 : tallies_[static_cast<std::size_t>(b.row())].impacts});
    std::push_heap(queue_.begin(), queue_.end(), Later{});
}

/// What a deflected body may hit next. A contact becomes an impact where its surfaces now come fast; one that
/// is pressed stays one, unless the sweeps of the next substep would come too late.
template <class Real>
void Impacts<Real>::foresee_all_of(std::int32_t row, double time) {
    const double left = bodies_->h - time;
    const auto look_at = [&](Place place) {
        ContactRows<Real>& rows = store_of(place);
        if (!is_impact(place)) {
            const std::int32_t number = rows.a[place.index];
            const Partner other = partner_of(place);
            const Path a = path_of(number);
            Vec2 n{rows.normal_x[place.index], rows.normal_y[place.index]};
            double approach;
            if (other.is_body()) {
                const Path b = path_of(other.row());
                const Vec2 d = b.position_at(time) - a.position_at(time);
                const double distance = std::sqrt(length_squared(d));
                if (distance > 0) n = (1 / distance) * d;
                approach = dot(b.velocity_at(time) - a.velocity_at(time), n);
            } else {
                approach =
                    static_cast<double>(rows.surface_normal[place.index]) - dot(a.velocity_at(time), n);
            }
            const bool deepens = -approach * left > kDeepening * smaller_radius(place);
            const bool may_bounce = !(rows.normal_impulse[place.index] > 0) && approach < -rest_speed_ &&
                                    approach < -noise_of(place) && restitution_of(place) > 0;
            if (!deepens && !may_bounce) return;
            if (may_bounce) {
                rows.separation[place.index] = kFar<Real>;
                impacts_.push_back(place);
            }
        }
        foresee(place, time);
    };
    for (const std::uint32_t i : of_pairs_.of(static_cast<std::size_t>(row)))
        look_at({i & 0x7fffffffu, false});
    for (const std::uint32_t i : of_supports_.of(static_cast<std::size_t>(row)))
        look_at({i & 0x7fffffffu, true});
}

/// Takes the cost of an impact from the budgets of its bodies. @return whether both had enough left
template <class Real>
bool Impacts<Real>::spend(Place place, double restitution, double speed) {
    bool has_enough = true;
    const auto pay = [&](std::int32_t row) {
        if (world_->bodies.is_immovable(static_cast<std::size_t>(row))) return;
        Tally& tally = tally_of(row);
        ++tally.impacts;
        has_enough = has_enough && tally.spent < kBudget;
        double cost = std::fmin(1, kCostOfLoss * (1 - restitution)) + kCostOfOne;
        if (speed > kFastShare * static_cast<double>(tally.fastest)) cost *= kCostOfFast;
        tally.spent += static_cast<float>(cost);
        tally.fastest = std::max(tally.fastest, static_cast<float>(speed));
    };
    pay(store_of(place).a[place.index]);
    if (!place.is_support) pay(pairs_->b[place.index]);
    return has_enough;
}

/// Whether a body of the contact has spent all of its budget and more.
template <class Real>
bool Impacts<Real>::is_exhausted(Place place) {
    const auto is_over = [&](std::int32_t row) { return tally_of(row).spent >= kBudget + kOverdraft; };
    return is_over(store_of(place).a[place.index]) || (!place.is_support && is_over(pairs_->b[place.index]));
}

/// The sweeps of the next substeps see it from now on.
template <class Real>
void Impacts<Real>::make_contact(Place place, Vec2 normal, double gap, double time) {
    ContactRows<Real>& rows = store_of(place);
    if (!is_impact(place)) return;
    const auto moved_by = [&](std::int32_t number) {
        const auto row = static_cast<std::size_t>(number);
        if (row >= bodies_->count) return Vec2{};
        return path_of(number).position_at(time) -
               Vec2{bodies_->origin[4 * row], bodies_->origin[4 * row + 1]};
    };
    if (place.is_support && !partner_of(place).is_body()) {
        rows.separation[place.index] = rows.clearance[place.index];
        return;
    }
    Vec2 relative = -1.0 * moved_by(rows.a[place.index]);
    if (!place.is_support) relative += moved_by(rows.b[place.index]);
    double separation = gap - dot(relative, normal);
    if (place.is_support) {
        const Path b = path_of(partner_of(place).row());
        const double surface = dot(b.v, normal);
        rows.surface_normal[place.index] = static_cast<Real>(surface);
        separation -= surface * (bodies_->elapsed + time);
    }
    rows.normal_x[place.index] = static_cast<Real>(normal.x);
    rows.normal_y[place.index] = static_cast<Real>(normal.y);
    rows.separation[place.index] = static_cast<Real>(separation);
}

/// Gives a body its new velocity at a time in the substep: the records are of the substep's end, and the
/// displacement makes up for the time in which the body did not have it yet.
template <class Real>
void Impacts<Real>::change(std::int32_t number, const DoubleBody& before, const DoubleBody& after,
                           double time, double& gravity_work) {
    const auto row = static_cast<std::size_t>(number);
    if (row >= bodies_->count || bodies_->velocity[4 * row + 3] == 0) return;
    const Vec2 acceleration = path_of(number).acceleration;
    const auto add = [](Real& velocity, Real* start, Real& moved, double added, Real decay, double at) {
        const Real old = velocity;
        velocity = static_cast<Real>(static_cast<double>(old) + added);
        const Real really = velocity - old;
        // What contacts did in this substep they will do again in the next one; this not.
        *start = decay == Real(1) ? velocity - (old - *start) : *start + really / decay;
        moved -= static_cast<Real>(at * static_cast<double>(really));
        return static_cast<double>(really);
    };
    Real* record = bodies_->velocity + 4 * row;
    const Vec2 added{add(record[0], bodies_->start.x + row, bodies_->displacement[2 * row],
                         after.record[0] - before.record[0], bodies_->decay, time),
                     add(record[1], bodies_->start.y + row, bodies_->displacement[2 * row + 1],
                         after.record[1] - before.record[1], bodies_->decay, time)};
    if (bodies_->turn && after.record[2] != before.record[2])
        add(record[2], bodies_->start.rim + row, bodies_->turn[row], after.record[2] - before.record[2],
            bodies_->spin_decay, time);
    gravity_work +=
        static_cast<double>(world_->bodies.mass[row]) * dot(acceleration, added) * (bodies_->h - time);
}

template <class Real>
bool Impacts<Real>::carry_out(Place place, double time, Books& books, double& gravity_work) {
    ContactRows<Real>& rows = store_of(place);
    const std::size_t i = place.index;
    const std::int32_t row_a = rows.a[i];
    const Partner other = partner_of(place);
    const Path path_a = path_of(row_a);
    DoubleBody a = body_of(row_a, path_a, time);
    Vec2 n{rows.normal_x[i], rows.normal_y[i]};
    double gap = 0;
    DoubleBody b{{{0, 0, 0, 0}}};
    if (other.is_body()) {
        const Path path_b = path_of(other.row());
        b = body_of(other.row(), path_b, time);
        const Vec2 d = path_b.position_at(time) - path_a.position_at(time);
        const double distance = std::sqrt(length_squared(d));
        n = distance > 0 ? (1 / distance) * d
                         : normal_of_coincident(static_cast<std::uint32_t>(row_a),
                                                static_cast<std::uint32_t>(other.row()));
        gap = distance - static_cast<double>(world_->bodies.radius[static_cast<std::size_t>(row_a)]) -
              static_cast<double>(world_->bodies.radius[static_cast<std::size_t>(other.row())]);
    }
    const double noise = noise_of(place);
    ContactTerms<double> terms{};
    terms.nx = n.x, terms.ny = n.y;
    const auto value = [i](const Column<Real>& column, double uniform) {
        return column.empty() ? uniform : static_cast<double>(column[i]);
    };
    if (bodies_->turn) {
        terms.friction = value(rows.friction, bodies_->uniform_friction);
        terms.rolling = rows.rolling_impulse.empty() ? 0 : value(rows.rolling, bodies_->uniform_rolling);
    }
    terms.of_a = value(rows.rolling_share, 0.5);
    const auto collide = [&](auto& side) {
        const double speed = -normal_velocity(a, side, n.x, n.y);
        if (!(speed > noise)) return false;
        if (is_exhausted(place)) return make_contact(place, n, gap, time), false;
        const double called_for = restitution_of(place);
        const bool has_enough = spend(place, called_for, speed);
        const bool bounces = has_enough && speed > rest_speed_;
        counters.capped += !has_enough;
        ++counters.impacts;
        terms.mass = 1 / inverse_mass(a, side);
        terms.tangent_mass = tangent_mass<kEveryEffect>(a, side, terms.mass);
        terms.floor = bounces ? called_for * speed : 0;
        const DoubleBody before_a = a, before_b = b;
        const double slip = tangent_velocity(a, side, n.x, n.y),
                     rolling = rolling_velocity(a, side, terms.of_a);
        ContactImpulses<double> j{0, 0, 0};
        solve_contact<kEveryEffect>(a, side, terms, j, [](double wanted) { return wanted; });
        change(row_a, before_a, a, time, gravity_work);
        if (other.is_body()) change(other.row(), before_b, b, time, gravity_work);
        if (!bounces) make_contact(place, n, gap, time);

        const auto of_both = [](double before, double after) { return 0.5 * (before + after); };
        if (other.is_wall()) books.wall_impulse += j.normal;
        if (!books.is_open) return true;
        books.restitution += j.normal * of_both(-speed, normal_velocity(a, side, n.x, n.y));
        books.friction += j.tangent * of_both(slip, tangent_velocity(a, side, n.x, n.y)) +
                          j.rolling * of_both(rolling, rolling_velocity(a, side, terms.of_a));
        if (!place.is_support) return true;
        const Vec2 t{-n.y, n.x};
        (other.is_wall() ? books.wall_momentum : books.immovable_momentum) -= j.normal * n + j.tangent * t;
        DoubleBody still{{{0, 0, 0, 0}}};  // seen from it, what the support does is its own motion
        books.drive -= j.normal * normal_velocity(still, side, n.x, n.y) +
                       j.tangent * tangent_velocity(still, side, n.x, n.y) +
                       j.rolling * rolling_velocity(still, side, terms.of_a);
        return true;
    };
    if (other.is_body()) {
        return collide(b);
    } else {
        DoubleSurface surface{static_cast<double>(rows.surface_normal[i]),
                              static_cast<double>(rows.surface_tangent[i]), value(rows.surface_rolling, 0)};
        return collide(surface);
    }
}

template <class Real>
void Impacts<Real>::carry_out_all(const SubstepBodies<Real>& bodies, Books& books, double& gravity_work) {
    bodies_ = &bodies;
    queue_.clear();
    const std::size_t found = impacts_.size();
    if (found == 0) return;
    tallies_.resize(std::max(tallies_.size(), bodies.count));
    for (std::size_t i = 0; i < found; ++i)
        if (is_impact(impacts_[i])) foresee(impacts_[i], 0);
    while (!queue_.empty()) {
        std::pop_heap(queue_.begin(), queue_.end(), Later{});
        const Event event = queue_.back();
        queue_.pop_back();
        const Partner other = partner_of(event.place);
        const auto impacts_of = [&](std::int32_t row) {
            return tallies_[static_cast<std::size_t>(row)].impacts;
        };
        if (impacts_of(event.a) != event.impacts_a ||
            (!event.place.is_support && impacts_of(other.row()) != event.impacts_b))
            continue;
        if (known_version_ != version_) of_pairs_.find(*pairs_, bodies.count, true);
        known_version_ = version_;
        if (!are_supports_known_) of_supports_.find(*supports_, bodies.count, false);
        are_supports_known_ = true;
        if (!carry_out(event.place, event.time, books, gravity_work)) continue;
        foresee_all_of(event.a, event.time);
        if (!event.place.is_support) foresee_all_of(other.row(), event.time);
    }
}

template <class Real>
std::size_t Impacts<Real>::bytes() const {
    return impacts_.capacity() * sizeof(Place) + queue_.capacity() * sizeof(Event) +
           tallies_.capacity() * sizeof(Tally) + of_pairs_.bytes() + of_supports_.bytes();
}

template class Impacts<float>;
template class Impacts<double>;

}  // namespace carom
