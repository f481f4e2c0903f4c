#include "solvers/soft/impacts.hpp"

#include <algorithm>
#include <bit>
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
constexpr float kBudget = 2;
/// Spent beyond the budget, on impacts without restitution; what more there is has to wait for the sweeps.
constexpr float kOverdraft = 8;
/// An impact costs so much for each unit of 1 - e, but at most 1; and so much besides.
constexpr double kCostOfLoss = 10, kCostOfOne = 0.02;
/// Impacts at this share of the fastest of the step are not those of a collapse: they cost a tenth.
constexpr double kFastShare = 0.15, kCostOfFast = 0.1;

/// Two surfaces touch if they are as near as this, in their reach.
template <class Real>
constexpr double kTouching = sizeof(Real) == sizeof(float) ? 1e-7 : 1e-14;

constexpr std::uint32_t kIndexBits = 0x7fffffffu;  // of a Place

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
    if (tally.step != step_) tally = {step_, 0, 0};
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
        const Place place{static_cast<std::uint32_t>(i) & kIndexBits, are_supports};
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
    // Room that no later step of the same world outgrows, unless it gets more pairs than ever.
    impacts_.reserve(std::bit_ceil(pairs.a.size() + supports.a.size()));
    queue_.reserve(std::bit_ceil(pairs.a.size() + supports.a.size()));
    of_pairs_.reserve(2 * pairs.a.size()), of_supports_.reserve(candidates.a.size());
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

/// Of a body that is awake.
template <class Real>
auto Impacts<Real>::path_of(std::size_t row) const -> Mover {
    const Real* record = bodies_->velocity + 4 * row;
    const Real start_x = bodies_->start.x[row], start_y = bodies_->start.y[row];
    const Vec2 x = Vec2{bodies_->origin[4 * row], bodies_->origin[4 * row + 1]} +
                   Vec2{bodies_->displacement[2 * row], bodies_->displacement[2 * row + 1]};
    const Mover straight{x, {record[0], record[1]}, {}, world_->bodies.radius[row], 0, substep_};
    if (record[3] == 0) return straight;
    const Real change_x = record[0] - start_x, change_y = record[1] - start_y;
    const Real fall_x = bodies_->decay * start_x + bodies_->gain_x - start_x,
               fall_y = bodies_->decay * start_y + bodies_->gain_y - start_y;
    const Real fall = fall_x * fall_x + fall_y * fall_y;
    const bool is_smooth = change_x * change_x + change_y * change_y <= fall * Real(1.0001);
    if (!is_smooth) return straight;
    Mover curved = straight;
    curved.v = {start_x, start_y};
    // Bodies that fall alike meet on straight lines: they have the same bits of acceleration.
    const Real off = std::fabs(change_x - fall_x) + std::fabs(change_y - fall_y),
               speed = std::fabs(start_x) + std::fabs(start_y);
    const bool falls = bodies_->decay == 1 && off <= Real(8) * std::numeric_limits<Real>::epsilon() * speed;
    curved.acceleration = falls ? gravity_ : (1 / bodies_->h) * Vec2{change_x, change_y};
    return curved;
}

template <class Real>
auto Impacts<Real>::mover_of(std::int32_t number) -> const Mover& {
    const auto row = static_cast<std::size_t>(number);
    Mover& mover = movers_[row];
    if (mover.substep != substep_) {
        const std::uint32_t impacts = mover.impacts;
        mover = path_of(row), mover.impacts = impacts;
    }
    return mover;
}

/// The other body of a contact: a support may sleep, and then has no record.
template <class Real>
auto Impacts<Real>::other_of(Place place, Partner other) -> Mover {
    const auto row = static_cast<std::size_t>(other.row());
    if (!place.is_support || row < bodies_->count) return mover_of(other.row());
    const Bodies<Real>& bodies = world_->bodies;
    return {{bodies.position_x[row], bodies.position_y[row]}, {}, {}, bodies.radius[row], 0, substep_};
}

template <class Real>
DoubleBody Impacts<Real>::body_of(std::int32_t row, const Mover& mover, double time) const {
    DoubleBody body{{{0, 0, 0, 0}}};
    if (static_cast<std::size_t>(row) < bodies_->count) {
        body = body_at(bodies_->velocity, row);
        const Vec2 v = mover.velocity_at(time);
        body.record[0] = v.x, body.record[1] = v.y;
    }
    return body;
}

template <class Real>
auto Impacts<Real>::clearance_of(Place place, const Mover& a) const -> Clearance {
    const ContactRows<Real>& rows = *supports_;
    const std::size_t i = place.index, row = static_cast<std::size_t>(rows.a[i]);
    const Vec2 n{rows.normal_x[i], rows.normal_y[i]},
        moved{bodies_->displacement[2 * row], bodies_->displacement[2 * row + 1]};
    const double surface = rows.surface_normal[i];
    return {static_cast<double>(rows.clearance[i]) + surface * bodies_->elapsed - dot(moved, n),
            surface - dot(a.v, n), -dot(a.acceleration, n)};
}

/// Speed below which the approach of two surfaces is round-off [m/s].
template <class Real>
double noise_of(Vec2 a, Vec2 b) {
    constexpr double kUnits = 8;
    return kUnits * std::numeric_limits<Real>::epsilon() *
           (std::fabs(a.x) + std::fabs(a.y) + std::fabs(b.x) + std::fabs(b.y));
}

/// @param time  when the surfaces meet
template <class Real>
void Impacts<Real>::foresee(Place place, double time) {
    if (!(time <= bodies_->h)) return;
    const auto impacts_of = [&](std::int32_t row) { return movers_[static_cast<std::size_t>(row)].impacts; };
    const std::int32_t a = store_of(place).a[place.index];
    const Partner b = partner_of(place);
    queue_.push_back({time, place, a, b.stored(), impacts_of(a), place.is_support ? 0 : impacts_of(b.row())});
    std::push_heap(queue_.begin(), queue_.end(), Later{});
}

/// Whether a contact whose surfaces approach at a speed may have an impact. One becomes an impact where they
/// come fast, however far apart they still are: the normal that the sweeps know is of another path. One that
/// is pressed stays a contact, but takes part if the sweeps of the next substep would come too late.
/// @param left  s, of the substep
template <class Real>
bool Impacts<Real>::takes_part(Place place, double speed, double left, double noise) {
    if (is_impact(place)) return true;
    if (!is_pressed(place) && speed > rest_speed_ && speed > noise && restitution_of(place) > 0) {
        store_of(place).separation[place.index] = kFar<Real>;
        impacts_.push_back(place);
        return true;
    }
    return speed * left > kDeepening * smaller_radius(place);
}

/// Foresees the impact of two discs from a time in the substep on.
template <class Real>
void Impacts<Real>::look_at_pair(Place place, const Mover& a, const Mover& b, double from) {
    const Vec2 d = b.position_at(from) - a.position_at(from), v = b.velocity_at(from) - a.velocity_at(from);
    const double closing = dot(d, v);
    if (!(closing < 0)) return;
    const Vec2 acceleration = b.acceleration - a.acceleration;
    const double left = bodies_->h - from, reach = a.radius + b.radius, squared = length_squared(d);
    // The distance of points on straight lines shrinks ever more slowly: they meet in time only if
    // distance + left closing / distance <= reach, here times the distance.
    const double bend = 0.5 * left * left * (std::fabs(acceleration.x) + std::fabs(acceleration.y)) + reach;
    const double nearest = squared + left * closing;
    const bool may_meet = nearest <= 0 || nearest * nearest <= bend * bend * squared;
    const bool is_slow = closing * closing <= rest_speed_ * rest_speed_ * squared;
    if (!may_meet && is_slow) return;
    const double speed = squared > 0 ? -closing / std::sqrt(squared) : 0;
    if (!takes_part(place, speed, left, noise_of<Real>(a.velocity_at(from), b.velocity_at(from))) ||
        !may_meet)
        return;
    const Window window{from, bodies_->h, 0};
    if (acceleration == Vec2{})
        foresee(place, straight_impact_time(d, v, reach, window));
    else
        foresee(place, accelerated_impact_time({b.x - a.x, b.v - a.v, acceleration}, reach, window,
                                               kTouching<Real> * reach));
}

/// Likewise of a disc and what supports it.
template <class Real>
void Impacts<Real>::look_at_support(Place place, double from) {
    const Mover& a = mover_of(supports_->a[place.index]);
    const Partner other = partner_of(place);
    if (other.is_body()) return look_at_pair(place, a, other_of(place, other), from);
    const Clearance c = clearance_of(place, a);
    const double speed = -(c.rate + from * c.acceleration), left = bodies_->h - from;
    if (!(speed > 0) && !(is_impact(place) && c.acceleration < 0)) return;
    if (takes_part(place, speed, left, noise_of<Real>(a.velocity_at(from), {})))
        foresee(place, wall_impact_time(c.width, c.rate, c.acceleration, {from, bodies_->h, 0}));
}

/// What a deflected body may hit next.
template <class Real>
void Impacts<Real>::look_at_all_of(std::int32_t row, double from) {
    const Mover& self = mover_of(row);
    for (const auto& entry : of_pairs_.of(static_cast<std::size_t>(row))) {
        const Mover& other = mover_of(entry.other);
        look_at_pair({entry.contact & kIndexBits, false}, self, other, from);
    }
    for (const auto& entry : of_supports_.of(static_cast<std::size_t>(row)))
        look_at_support({entry.contact & kIndexBits, true}, from);
}

/// Takes the cost of an impact from the budgets of its bodies. @return whether both had enough left
template <class Real>
bool Impacts<Real>::spend(Place place, double restitution, double speed) {
    bool has_enough = true;
    const auto pay = [&](std::int32_t row) {
        if (world_->bodies.is_immovable(static_cast<std::size_t>(row))) return;
        Tally& tally = tally_of(row);
        ++movers_[static_cast<std::size_t>(row)].impacts;
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
        return mover_of(number).position_at(time) -
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
        const double surface = dot(other_of(place, partner_of(place)).v, normal);
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
    const Vec2 acceleration = mover_of(number).acceleration;
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
    movers_[row].substep = 0;  // it moves otherwise from now on
}

template <class Real>
bool Impacts<Real>::carry_out(Place place, double time, Books& books, double& gravity_work) {
    ContactRows<Real>& rows = store_of(place);
    const std::size_t i = place.index;
    const std::int32_t row_a = rows.a[i];
    const Partner other = partner_of(place);
    const Mover mover_a = mover_of(row_a);
    DoubleBody a = body_of(row_a, mover_a, time);
    Vec2 n{rows.normal_x[i], rows.normal_y[i]};
    double gap = 0;
    DoubleBody b{{{0, 0, 0, 0}}};
    if (other.is_body()) {
        const Mover mover_b = other_of(place, other);
        b = body_of(other.row(), mover_b, time);
        const Vec2 d = mover_b.position_at(time) - mover_a.position_at(time);
        const double distance = std::sqrt(length_squared(d));
        n = distance > 0 ? (1 / distance) * d
                         : normal_of_coincident(static_cast<std::uint32_t>(row_a),
                                                static_cast<std::uint32_t>(other.row()));
        gap = distance - mover_a.radius - mover_b.radius;
    }
    const double noise =
        noise_of<Real>({a.record[0], a.record[1]}, other.is_body() ? Vec2{b.record[0], b.record[1]} : Vec2{});
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
        ++counters.impacts;
        counters.of_walls += other.is_wall(), counters.inelastic += !bounces;
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
    ++substep_;
    tallies_.resize(std::max(tallies_.size(), bodies.count));
    movers_.resize(std::max(movers_.size(), bodies.count));
    for (std::size_t i = 0; i < found; ++i) {
        const Place place = impacts_[i];
        if (!is_impact(place)) continue;
        if (place.is_support)
            look_at_support(place, 0);
        else
            look_at_pair(place, mover_of(pairs_->a[place.index]), mover_of(pairs_->b[place.index]), 0);
    }
    while (!queue_.empty()) {
        std::pop_heap(queue_.begin(), queue_.end(), Later{});
        const Event event = queue_.back();
        queue_.pop_back();
        const Partner other(event.b);
        const auto is_void = [&](std::int32_t row, std::uint32_t impacts) {
            return movers_[static_cast<std::size_t>(row)].impacts != impacts;
        };
        if (is_void(event.a, event.impacts_a) ||
            (!event.place.is_support && is_void(other.row(), event.impacts_b)))
            continue;
        if (known_version_ != version_) of_pairs_.find(*pairs_, bodies.count, true);
        known_version_ = version_;
        if (!are_supports_known_) of_supports_.find(*supports_, bodies.count, false);
        are_supports_known_ = true;
        if (!carry_out(event.place, event.time, books, gravity_work)) continue;
        look_at_all_of(event.a, event.time);
        if (!event.place.is_support) look_at_all_of(other.row(), event.time);
    }
}

template <class Real>
std::size_t Impacts<Real>::bytes() const {
    return impacts_.capacity() * sizeof(Place) + queue_.capacity() * sizeof(Event) +
           tallies_.capacity() * sizeof(Tally) + movers_.capacity() * sizeof(Mover) + of_pairs_.bytes() +
           of_supports_.bytes();
}

template class Impacts<float>;
template class Impacts<double>;

}  // namespace carom
