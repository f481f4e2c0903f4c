#include "solvers/soft/impacts/impacts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "effects/restitution.hpp"
#include "math/vec2_math.hpp"
#include "narrowphase/coincident.hpp"
#include "narrowphase/impact_time.hpp"
#include "solvers/soft/impacts/blow.hpp"
#include "solvers/soft/impacts/hidden_contacts.hpp"
#include "solvers/soft/impacts/impact_materials.hpp"

namespace carom {
namespace {

/// What comes slower than gravity would make it in this many substeps is at rest and does not bounce.
constexpr double kRestingFalls = 2;
/// Overlap beyond which the sweeps part two bodies, in radii of the smaller one.
constexpr double kOverlap = 1e-3;
/// A contact that is pressed is an impact again if its bodies would come so deep into each other until the
/// end of the substep, in radii of the smaller one.
constexpr double kDeepening = 0.01;
/// What it may come deeper without being noted as left closing, in the same, where it is elastic. Without
/// restitution it is kDeepening, and between them it falls evenly: what bounces less strikes a crowd less
/// often.
constexpr double kLeftClosing = 0.002;

/// Two surfaces touch if they are as near as this, in their reach.
template <class Real>
constexpr double kTouching = sizeof(Real) == sizeof(float) ? 1e-7 : 1e-14;

/// Share of an energy that is round-off: the normals of edges have the length 1 in the world's precision
/// only.
[[maybe_unused]] constexpr double kRoundOff = 1e-6;

constexpr std::uint32_t kIndexBits = 0x3fffffffu;  // of a Place

}  // namespace

template <class Real>
std::int32_t Impacts<Real>::row_of(Place place) const {
    return place.has_row() ? store_of(place).a[place.index] : strangers_[place.index].a;
}

template <class Real>
Partner Impacts<Real>::partner_of(Place place) const {
    if (place.kind == kStrangers) return Partner::body(strangers_[place.index].b);
    return place.is_support()
               ? candidates_->partner(static_cast<std::size_t>(supports_->candidate[place.index]))
               : Partner::body(pairs_->b[place.index]);
}

template <class Real>
bool Impacts<Real>::is_impact(Place place) const {
    return !place.has_row() || is_hidden(store_of(place).separation[place.index]);
}

/// Whether a force holds a contact that its bodies come to with a speed [m/s].
template <class Real>
bool Impacts<Real>::is_pressed(Place place, double speed) const {
    if (!place.has_row()) return false;
    const ContactRows<Real>& rows = store_of(place);
    return rows.normal_impulse[place.index] > kLightPress * rows.mass[place.index] * speed;
}

template <class Real>
double Impacts<Real>::restitution_of(Place place) const {
    const Bodies<Real>& bodies = world_->bodies;
    const double of_a = bodies.restitution[static_cast<std::size_t>(row_of(place))];
    const Partner other = partner_of(place);
    if (other.is_wall()) return pair_restitution(of_a, world_->walls->material.restitution);
    const auto row = static_cast<std::size_t>(
        other.is_edge() ? world_->handles.row_of_slot(world_->edges.body_of(other.edge_number()).id.index)
                        : static_cast<std::size_t>(other.row()));
    return pair_restitution(of_a, bodies.restitution[row]);
}

template <class Real>
double Impacts<Real>::smaller_radius(Place place) const {
    const auto radius_of = [&](std::int32_t row) {
        return static_cast<double>(world_->bodies.radius[static_cast<std::size_t>(row)]);
    };
    const double of_a = radius_of(row_of(place));
    const Partner other = partner_of(place);
    return other.is_body() ? std::min(of_a, radius_of(other.row())) : of_a;
}

/// What decides the tangential and rolling impulses; zero where nothing turns.
template <class Real>
void Impacts<Real>::set_materials(Place place, ContactTerms<double>& terms) const {
    if (place.has_row()) return materials_of_contact(store_of(place), place.index, *settings_, terms);
    materials_of_bodies(world_->bodies, row_of(place), partner_of(place).row(), *settings_, terms);
}

/// What comes fast enough, and may come to touch in this step, is an impact.
template <class Real>
void Impacts<Real>::mark_in(ContactRows<Real>& rows, Kind kind, std::size_t first, std::size_t last) {
    const double slack = std::sqrt(length_squared(gravity_)) * dt_ * dt_;
    for (std::size_t i = first; i < last; ++i) {
        const double approach = rows.approach[i];
        if (rows.normal_impulse[i] > 0 || !(approach < -rest_speed_) || !(rows.mass[i] > 0)) continue;
        const double separation = rows.separation[i];
        if (separation > slack - dt_ * approach) continue;
        const Place place{static_cast<std::uint32_t>(i) & kIndexBits, kind};
        // What lies no deeper than it came in one step is an impact that was missed, not a crowd's overlap.
        const double deepest = std::fmax(kOverlap * smaller_radius(place), -dt_ * approach);
        if (separation < -deepest || !(restitution_of(place) > 0)) continue;
        rows.separation[i] = kHiddenSeparation<Real>;
        impacts_.push_back(place);
    }
}

template <class Real>
void Impacts<Real>::mark(const WorldState<Real>& world, const StepView<Real>& step,
                         const Candidates<Real>& neighbours) {
    held.begin_step();
    ContactRows<Real>&pairs = step.graph.pairs, &supports = step.supports;
    world_ = &world, pairs_ = &pairs, supports_ = &supports, candidates_ = &step.graph.supports;
    neighbours_ = &neighbours, settings_ = &step.settings, groups_ = &step.graph.groups;
    dt_ = step.terms.dt, rest_speed_ = kRestingFalls * step.terms.fall_speed();
    gravity_ = (1 / step.terms.substep_dt) * step.terms.gravity_change;
    for (const Strangers& pair : strangers_)
        first_strangers_[static_cast<std::size_t>(pair.a)] =
            first_strangers_[static_cast<std::size_t>(pair.b)] = -1;
    strangers_.clear(), impacts_.clear();
    overshoot_ = 0;
    // Room that no later step of the same world outgrows, unless it gets more pairs than ever.
    impacts_.reserve(std::bit_ceil(pairs.a.size() + supports.a.size()));
    queue_.reserve(2 * std::bit_ceil(pairs.a.size() + supports.a.size()));
    of_pairs_.reserve(2 * pairs.a.size()), of_supports_.reserve(candidates_->a.size());
    are_supports_known_ = false;
    version_ = step.graph.version;
    budget_.begin_step(step.records.count());
    first_strangers_.resize(std::max(first_strangers_.size(), step.records.count()), -1);
    mark_of_.resize(first_strangers_.size(), 0);
    for (std::size_t group = 0; group < pairs.groups(); ++group) {
        const typename ContactRows<Real>::Run* run =
            pairs.run.data() + pairs.first_place(group) / kContactBlock;
        for (std::size_t r = 0; r < pairs.run_count[group]; ++r)
            mark_in(pairs, kPair, kHalfBlock * run[r].first, kHalfBlock * run[r].last);
    }
    supports.for_each([&](std::size_t i) { mark_in(supports, kSupport, i, i + 1); });
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

/// @param time  when the surfaces meet
template <class Real>
void Impacts<Real>::foresee(Place place, double time) {
    if (!(time <= bodies_->h)) return;
    const std::int32_t a = row_of(place);
    const Partner b = partner_of(place);
    queue_.push_back({time, place, a, b.stored(), paths_.impacts_of(a),
                      place.is_support() ? 0 : paths_.impacts_of(b.row())});
    std::push_heap(queue_.begin(), queue_.end(), Later{});
}

/// Whether a contact whose surfaces approach at a speed may have an impact. One becomes an impact where they
/// come fast, however far apart they still are: the normal that the sweeps know is of another path. One that
/// is pressed stays a contact, but takes part if the sweeps of the next substep would come too late. A force
/// that is little beside the blow presses nothing: balls of a cradle that lean on each other are struck
/// apart.
/// @param left  s, of the substep
template <class Real>
bool Impacts<Real>::takes_part(Place place, double speed, double left, double noise) {
    if (is_impact(place)) return true;
    const bool is_fast = speed > rest_speed_ && speed > noise;
    if (!is_pressed(place) && is_fast && restitution_of(place) > 0) {
        store_of(place).separation[place.index] = kHiddenSeparation<Real>;
        impacts_.push_back(place);
        return true;
    }
    if (is_fast && !is_pressed(place, speed)) return true;
    const double way = speed * left, smaller = smaller_radius(place);
    if (way > kDeepening * smaller) return true;
    if (way > kLeftClosing * smaller) {
        const double inelastic = 1 - restitution_of(place);
        if (way > (kLeftClosing + inelastic * (kDeepening - kLeftClosing)) * smaller)
            left_closing.add(*groups_, row_of(place));
    }
    return false;
}

/// The normal that the sweeps know of a deflected body's contact is of another path: with it they would stop
/// bodies that pass each other. Where nothing presses they are to see no more of it, unless a body is in a
/// crowd that collapses, in which they are to come between.
/// @param v  m/s, relative velocity
template <class Real>
void Impacts<Real>::hide_from_sweeps(Place place, Vec2 v) {
    if (is_impact(place) || is_pressed(place) || !(length_squared(v) > rest_speed_ * rest_speed_) ||
        budget_.may_collapse(row_of(place)) ||
        (!place.is_support() && budget_.may_collapse(partner_of(place).row())) ||
        !(restitution_of(place) > 0))
        return;
    store_of(place).separation[place.index] = kHiddenSeparation<Real>;
    impacts_.push_back(place);
}

/// Foresees the impact of two discs from a time in the substep on.
template <class Real>
void Impacts<Real>::look_at_pair(Place place, const Mover& a, const Mover& b, double from) {
    const Vec2 d = b.position_at(from) - a.position_at(from), v = b.velocity_at(from) - a.velocity_at(from);
    const double closing = dot(d, v);
    if (!(closing < 0)) return hide_from_sweeps(place, v);
    const Vec2 acceleration = b.acceleration - a.acceleration;
    const double left = bodies_->h - from, reach = a.radius + b.radius, squared = length_squared(d);
    // The distance of points on straight lines shrinks ever more slowly: they meet in time only if
    // distance + left closing / distance <= reach, here times the distance.
    const double bend = 0.5 * left * left * (std::fabs(acceleration.x) + std::fabs(acceleration.y)) + reach;
    const double nearest = squared + left * closing;
    const bool may_meet = nearest <= 0 || nearest * nearest <= bend * bend * squared;
    const bool is_slow = closing * closing <= rest_speed_ * rest_speed_ * squared;
    if (!may_meet && is_slow) return hide_from_sweeps(place, v);
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
    const Mover& a = paths_.of(supports_->a[place.index]);
    const Partner other = partner_of(place);
    if (other.is_body()) return look_at_pair(place, a, paths_.of_any(other.row()), from);
    const Clearance c = clearance_of(place, a);
    const double speed = -(c.rate + from * c.acceleration), left = bodies_->h - from;
    if (!(speed > 0) && !(is_impact(place) && c.acceleration < 0)) return;
    if (takes_part(place, speed, left, noise_of<Real>(a.velocity_at(from), {})))
        foresee(place, wall_impact_time(c.width, c.rate, c.acceleration, {from, bodies_->h, 0}));
}

template <class Real>
void Impacts<Real>::look_at(Place place, double from) {
    if (place.is_support())
        look_at_support(place, from);
    else
        look_at_pair(place, paths_.of(row_of(place)), paths_.of(partner_of(place).row()), from);
}

/// Calls fn(place, row of the other one).
template <class Real>
template <class Fn>
void Impacts<Real>::for_each_stranger_of(std::int32_t row, const Fn& fn) const {
    for (std::int32_t n = first_strangers_[static_cast<std::size_t>(row)]; n >= 0;) {
        const Strangers& pair = strangers_[static_cast<std::size_t>(n)];
        const bool is_a = pair.a == row;
        fn(Place{static_cast<std::uint32_t>(n) & kIndexBits, kStrangers}, is_a ? pair.b : pair.a);
        n = is_a ? pair.next_a : pair.next_b;
    }
}

/// Marks the bodies that a body has a contact or strangers with, and itself.
template <class Real>
void Impacts<Real>::mark_known(std::int32_t row) {
    if (++mark_ == 0) std::fill(mark_of_.begin(), mark_of_.end(), 0), mark_ = 1;
    const auto mark = [&](std::int32_t known) { mark_of_[static_cast<std::size_t>(known)] = mark_; };
    mark(row);
    for (const auto& entry : of_pairs_.of(static_cast<std::size_t>(row))) mark(entry.other);
    for_each_stranger_of(row, [&](Place, std::int32_t known) { mark(known); });
}

/// A body that leaves its margin may hit bodies that are no candidates.
template <class Real>
void Impacts<Real>::find_strangers(std::int32_t row, double from) {
    const Mover& self = paths_.of(row);
    const double left = dt_ - bodies_->elapsed - from;
    const Vec2 way = left * self.velocity_at(from) + (0.5 * left * left) * gravity_;
    const Vec2 end = self.position_at(from) + way;
    const double overshoot = neighbours_->overshoot_of(row, self.radius, end);
    if (!(overshoot > 0)) return;
    overshoot_ = std::fmax(overshoot_, overshoot);
    const double reach = self.radius + overshoot_ + std::sqrt(length_squared(way));
    const std::size_t found = neighbours_->find_around(static_cast<std::size_t>(row), reach, end, near_rows_);
    mark_known(row);
    for (std::size_t k = 0; k < found; ++k) {
        const std::int32_t other = near_rows_[k];
        if (world_->bodies.is_immovable(static_cast<std::size_t>(other)) ||
            !world_->bodies.is_disc(static_cast<std::size_t>(other)) ||
            mark_of_[static_cast<std::size_t>(other)] == mark_ ||
            !world_->may_collide(static_cast<std::size_t>(row), static_cast<std::size_t>(other)))
            continue;
        const auto number = static_cast<std::int32_t>(strangers_.size());
        const std::int32_t a = std::min(row, other), b = std::max(row, other);
        strangers_.push_back({a, b, first_strangers_[static_cast<std::size_t>(a)],
                              first_strangers_[static_cast<std::size_t>(b)]});
        first_strangers_[static_cast<std::size_t>(a)] = first_strangers_[static_cast<std::size_t>(b)] =
            number;
    }
}

/// What a deflected body may hit next.
template <class Real>
void Impacts<Real>::look_at_all_of(std::int32_t row, double from) {
    find_strangers(row, from);
    const Mover& self = paths_.of(row);
    for (const auto& entry : of_pairs_.of(static_cast<std::size_t>(row)))
        look_at_pair({entry.contact & kIndexBits, kPair}, self, paths_.of(entry.other), from);
    std::size_t looks = of_pairs_.of(static_cast<std::size_t>(row)).size();
    for_each_stranger_of(row, [&](Place place, std::int32_t other) {
        ++looks, look_at_pair(place, self, paths_.of(other), from);
    });
    for (const auto& entry : of_supports_.of(static_cast<std::size_t>(row)))
        ++looks, look_at_support({entry.contact & kIndexBits, kSupport}, from);
    budget_.look(looks);
}

/// The sweeps of the next substeps see it from now on.
template <class Real>
void Impacts<Real>::make_contact(Place place, Vec2 normal, double gap, double time) {
    if (!place.has_row() || !is_impact(place)) return;
    ContactRows<Real>& rows = store_of(place);
    if (place.is_support() && !partner_of(place).is_body()) {
        rows.separation[place.index] = rows.clearance[place.index];
        return;
    }
    Vec2 relative = -1.0 * paths_.displacement_of(rows.a[place.index], time);
    if (!place.is_support()) relative += paths_.displacement_of(rows.b[place.index], time);
    double separation = gap - dot(relative, normal);
    if (place.is_support()) {
        const double surface = dot(paths_.of_any(partner_of(place).row()).v, normal);
        rows.surface_normal[place.index] = static_cast<Real>(surface);
        separation -= surface * (bodies_->elapsed + time);
    }
    rows.normal_x[place.index] = static_cast<Real>(normal.x);
    rows.normal_y[place.index] = static_cast<Real>(normal.y);
    rows.separation[place.index] = static_cast<Real>(separation);
}

template <class Real>
bool Impacts<Real>::carry_out(Place place, double time, Books& books, double& gravity_work) {
    const std::int32_t row_a = row_of(place);
    const Partner other = partner_of(place);
    const Mover mover_a = paths_.of(row_a);
    DoubleBody a = body_of(paths_.record_of(row_a, mover_a, time)), b = kStillBody;
    Vec2 n;
    double gap = 0;
    if (other.is_body()) {
        const Mover mover_b = paths_.of_any(other.row());
        b = body_of(paths_.record_of(other.row(), mover_b, time));
        const Vec2 d = mover_b.position_at(time) - mover_a.position_at(time);
        const double distance = std::sqrt(length_squared(d));
        n = distance > 0 ? (1 / distance) * d
                         : normal_of_coincident(static_cast<std::uint32_t>(row_a),
                                                static_cast<std::uint32_t>(other.row()));
        gap = distance - mover_a.radius - mover_b.radius;
    } else {
        n = {supports_->normal_x[place.index], supports_->normal_y[place.index]};
    }
    const double noise = noise_of<Real>({a.record[0], a.record[1]}, {b.record[0], b.record[1]});
    ContactTerms<double> terms{};
    terms.nx = n.x, terms.ny = n.y;
    set_materials(place, terms);
    const auto for_each_mover = [&](const auto& fn) {
        fn(row_a);
        if (!place.is_support()) fn(other.row());
    };
    const auto collide = [&](auto& side) {
        const double speed = -normal_velocity(a, side, n.x, n.y);
        if (!(speed > noise)) return false;
        const bool would_be_deep = speed * (bodies_->h - time) > kDeepening * smaller_radius(place);
        bool has_enough = true, is_exhausted = false;
        std::size_t joints = 0;  // that answer the impact
        for_each_mover([&](std::int32_t row) {
            has_enough = has_enough && budget_.has_enough(row);
            is_exhausted = is_exhausted || budget_.is_exhausted(row, would_be_deep);
            joints += held.joints_of(row);
        });
        if (is_exhausted) {
            left_closing.add(*groups_, row_a);
            return make_contact(place, n, gap, time), false;
        }
        const double called_for = restitution_of(place);
        const bool bounces = has_enough && speed > rest_speed_;
        for_each_mover([&](std::int32_t row) { budget_.spend(row, called_for, speed, joints); });
        budget_.count(lighter_of(place));
        ++counters.impacts;
        counters.of_walls += other.is_wall(), counters.inelastic += !bounces;
        terms.floor = bounces ? called_for * speed : 0;
        [[maybe_unused]] const auto before = velocities(a, side, terms);
        // Seen from what stands still, what a support does is its own motion.
        const std::array<double, 3> of_support = place.is_support() && (joints > 0 || books.is_open)
                                                     ? velocities(kStillBody, side, terms)
                                                     : std::array<double, 3>{};
        const StruckDiscs discs{row_a, place.is_support() ? kNothing : other.row(), time};
        Blow blow;
        struck_.clear();
        if (joints == 0 ||
            !strike_held(held, discs, terms, bounces ? called_for : 0, of_support, paths_, blow, struck_))
            strike_free(discs, terms, a, side, paths_, blow);
        gravity_work += blow.gravity_work;
        if (!bounces) make_contact(place, n, gap, time);

        const ContactImpulses<double>& j = blow.impulses;
        assert(blow.by_normal <= j.normal * (kRoundOff * speed + noise) && "an impact never adds energy");
        assert(blow.by_friction <=
                   j.normal * (kRoundOff * (speed + std::fabs(before[1]) + std::fabs(before[2])) + noise) &&
               "friction never adds energy");
        if (other.is_wall()) books.wall_impulse += j.normal;
        if (!books.is_open) return true;
        books.restitution += blow.by_normal, books.friction += blow.by_friction;
        books.immovable_momentum += blow.by_joints;
        if (!place.is_support()) return true;
        const Vec2 t{-n.y, n.x};
        (other.is_wall() ? books.wall_momentum : books.immovable_momentum) -= j.normal * n + j.tangent * t;
        books.drive -= j.normal * of_support[0] + j.tangent * of_support[1] + j.rolling * of_support[2];
        return true;
    };
    if (other.is_body()) return collide(b);
    const auto value = [&](const Column<Real>& column) {
        return column.empty() ? 0 : static_cast<double>(column[place.index]);
    };
    DoubleSurface surface{value(supports_->surface_normal), value(supports_->surface_tangent),
                          value(supports_->surface_rolling)};
    return collide(surface);
}

template <class Real>
void Impacts<Real>::note_deflected(const Column<Real>& velocity) {
    if (shapes.deflected().empty()) return;
    find_contacts_of_bodies();
    const auto velocity_of = [&](std::int32_t row) {
        const Real* record = &velocity[4 * static_cast<std::size_t>(row)];
        return Vec2{record[0], record[1]};
    };
    for (const std::int32_t row : shapes.deflected()) {
        const Vec2 v = velocity_of(row);
        for (const auto& entry : of_pairs_.of(static_cast<std::size_t>(row)))
            hide_from_sweeps({entry.contact & kIndexBits, kPair}, velocity_of(entry.other) - v);
        for (const auto& entry : of_supports_.of(static_cast<std::size_t>(row)))
            hide_from_sweeps({entry.contact & kIndexBits, kSupport}, -v);
    }
}

template <class Real>
void Impacts<Real>::carry_out_all(const SubstepBodies<Real>& bodies, Books& books, double& gravity_work,
                                  Interruption& interruption) {
    bodies_ = &bodies;
    left_closing.clear();
    const std::size_t found = impacts_.size(), strangers = strangers_.size();
    if (found == 0) return;
    queue_.clear();
    paths_.begin_substep(*world_, bodies, held.joined(), gravity_);
    for (std::size_t i = 0; i < found; ++i)
        if (is_impact(impacts_[i])) look_at(impacts_[i], 0);
    for (std::size_t i = 0; i < strangers; ++i)
        look_at({static_cast<std::uint32_t>(i) & kIndexBits, kStrangers}, 0);
    while (!queue_.empty()) {
        if (interruption.is_due_after(Interruption::kImpact)) return;
        std::pop_heap(queue_.begin(), queue_.end(), Later{});
        const Event event = queue_.back();
        queue_.pop_back();
        if (paths_.impacts_of(event.a) != event.impacts_a ||
            (!event.place.is_support() && paths_.impacts_of(Partner(event.b).row()) != event.impacts_b))
            continue;
        find_contacts_of_bodies();
        if (!carry_out(event.place, event.time, books, gravity_work)) continue;
        for (const std::int32_t row : struck_)
            if (world_->bodies.is_disc(static_cast<std::size_t>(row))) look_at_all_of(row, event.time);
        if (!struck_.empty()) continue;
        look_at_all_of(event.a, event.time);
        if (!event.place.is_support()) look_at_all_of(Partner(event.b).row(), event.time);
    }
}

template <class Real>
std::size_t Impacts<Real>::bytes() const {
    return impacts_.capacity() * sizeof(Place) + strangers_.capacity() * sizeof(Strangers) +
           (first_strangers_.capacity() + mark_of_.capacity()) * sizeof(std::int32_t) + near_rows_.bytes() +
           queue_.capacity() * sizeof(Event) + left_closing.bytes() + of_pairs_.bytes() +
           of_supports_.bytes() + paths_.bytes() + budget_.bytes() + held.bytes() + shapes.bytes() +
           struck_.capacity() * sizeof(std::int32_t);
}

template class Impacts<float>;
template class Impacts<double>;

}  // namespace carom
