#include "solvers/soft/contacts/support_finder.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "constraints/support_surface.hpp"
#include "effects/contact_law.hpp"
#include "effects/friction.hpp"
#include "effects/rolling_resistance.hpp"
#include "narrowphase/smooth_track.hpp"

namespace carom {
namespace {

/// A flat support as near as this, in radii of the body, is kept however slowly the body nears it; with
/// restitution any other, too.
constexpr double kCrowdedRadii = 1;
/// A disc that a curve leads comes by less than this in a step, in radii.
constexpr double kLongestLed = 2;
/// N s, that a contact keeps which pressed by turning a disc and carries nothing else: it moves nothing.
template <class Real>
constexpr Real kHeldByTurn = Real(1e-30);
/// |x| + |y| of a vector, in lengths of it, at most.
constexpr double kBothAxes = 1.415;
constexpr double kNanosecondsToFindSupport = 10;  // a support on one thread, for the executor

/// What gravity adds to velocities in a step [m/s].
Vec2 fall_of(const SubstepTerms& terms) {
    return (terms.dt / terms.substep_dt) * terms.gravity_change;
}

/// Way along both axes that a velocity leads in dt [m], at least that of the vector.
double way_within(double dt, Vec2 v) {
    return dt * (std::fabs(v.x) + std::fabs(v.y));
}

/// Writes a support that can touch.
/// @param v  m/s, of the body  @param candidate, at  its places in the graph and in the supports of the step
template <class Real>
void add_support(const SupportSurface& surface, Vec2 v, std::size_t candidate, std::size_t at,
                 const StepView<Real>& step, const WorldState<Real>& world) {
    const ContactRows<Real>& candidates = step.graph.supports;
    ContactRows<Real>& supports = step.supports;
    const ContactEffects& effects = step.settings.effects;
    const Bodies<Real>& bodies = world.bodies;
    const auto row = static_cast<std::size_t>(candidates.a[candidate]);
    const auto real = [](double value) { return static_cast<Real>(value); };
    const Vec2 n = surface.normal;
    supports.a[at] = candidates.a[candidate];
    supports.normal_x[at] = real(n.x), supports.normal_y[at] = real(n.y);
    const bool is_paced = surface.separation > 0 && candidates.normal_impulse[candidate] > 0;
    supports.separation[at] = real(is_paced ? step.settings.pace * surface.separation : surface.separation);
    supports.mass[at] = real(1 / bodies.inverse_mass(row));
    if (effects.radius_varies) supports.smaller[at] = bodies.radius[row];
    supports.normal_impulse[at] = candidates.normal_impulse[candidate];
    supports.surface_normal[at] = real(dot(surface.velocity, n));
    supports.surface_tangent[at] = real(cross(n, surface.velocity));
    if (effects.friction) {
        supports.friction_impulse[at] = candidates.friction_impulse[candidate];
        supports.friction[at] = real(pair_friction(bodies.friction[row], surface.friction));
    }
    if (effects.rolling) {
        supports.rolling_impulse[at] = candidates.rolling_impulse[candidate];
        supports.rolling[at] =
            real(pair_rolling_resistance(bodies.rolling_resistance[row], surface.rolling_resistance));
        supports.rolling_share[at] = real(surface.rolling_share);
        supports.surface_rolling[at] = real(surface.rolling_velocity);
    }
    if (effects.restitution) supports.approach[at] = real(dot(surface.velocity - v, n));
    if (effects.restitution) supports.clearance[at] = supports.separation[at];
    supports.candidate[at] = static_cast<std::int32_t>(candidate);
}

}  // namespace

template <class Real>
void SupportFinder<Real>::find(const StepView<Real>& step, const WorldState<Real>& world,
                               const EdgeCandidates<Real>& edges, const Real* joined, Books& books) {
    const ContactRows<Real>& candidates = step.graph.supports;
    step.supports.resize_for_some_of(candidates, step.settings.effects.of_supports());
    const std::size_t groups = candidates.groups();
    left_edges_of_.resize(std::max(left_edges_of_.size(), groups));
    const Search search{step, world, edges};
    hold_.clear();
    if (!world.edges.empty()) note_pressing(search), lead_discs(search, joined, books);
    const double work = kNanosecondsToFindSupport * static_cast<double>(candidates.a.size());
    step.loops.executor->for_each_task(groups, work,
                                       [&](std::size_t group) { find_in_group(group, search); });
    left_edges_.clear();
    for (std::size_t group = 0; group < groups; ++group)
        left_edges_.insert(left_edges_.end(), left_edges_of_[group].begin(), left_edges_of_[group].end());
    hand_on_impulses(search);
}

/// Notes which bodies pressed on an edge in the step before.
template <class Real>
void SupportFinder<Real>::note_pressing(const Search& search) {
    hold_.resize(search.world.bodies.rows(), EdgeHold::none);
    const ContactRows<Real>& candidates = search.step.graph.supports;
    candidates.for_each([&](std::size_t i) {
        if (candidates.normal_impulse[i] > 0 && candidates.partner(i).is_edge())
            hold_[static_cast<std::size_t>(candidates.a[i])] = EdgeHold::pressed;
    });
}

/// Turns the velocities of discs that curves hold (narrowphase/smooth_track.hpp). What turns them presses
/// them on the curve, so friction may act up to that, and rolling resistance.
///
/// Where nothing has pressed, a disc that a curve holds is one that touches it and has no restitution. A disc
/// that has joints turns with the others of its mechanism, and edges that move do work.
template <class Real>
void SupportFinder<Real>::lead_discs(const Search& search, const Real* joined, Books& books) {
    const WorldState<Real>& world = search.world;
    const EdgeCandidates<Real>& edges = search.edges;
    const auto may_lead = [&](std::int32_t mover) {
        return is_curve_at_rest(search, world.edges.bodies[static_cast<std::size_t>(mover)].first);
    };
    const std::vector<std::int32_t>& movers = world.edges.movers;
    if (!edges.have_standing_tracks() && std::none_of(movers.begin(), movers.end(), may_lead)) return;
    velocity_.resize(hold_.size());
    const ContactRows<Real>& candidates = search.step.graph.supports;
    candidates.for_each([&](std::size_t i) {
        const auto row = static_cast<std::size_t>(candidates.a[i]);
        if (!candidates.partner(i).is_edge() || hold_[row] == EdgeHold::led ||
            (joined && joined[row] > Real(0)))
            return;
        const std::int32_t edge = candidates.partner(i).edge_number();
        const std::optional<Vec2> led = velocity_along_curve(search, row, edge);
        if (!led) return;
        hold_[row] = EdgeHold::led;
        velocity_[row] = *led;
        give_turn(search, row, edges.pose_of(world.edges[edge]).row, books);
    });
}

/// Whether an edge has others that go on where it ends, and stands still.
template <class Real>
bool SupportFinder<Real>::is_curve_at_rest(const Search& search, std::int32_t number) {
    const Edge& edge = search.world.edges[number];
    const EdgePose& pose = search.edges.pose_of(edge);
    return (edge.previous >= 0 || edge.next >= 0) && !pose.turns() &&
           pose.position.x == pose.end_position.x && pose.position.y == pose.end_position.y;
}

/// What a curve makes of a disc's velocity [m/s], if it holds the disc.
template <class Real>
std::optional<Vec2> SupportFinder<Real>::velocity_along_curve(const Search& search, std::size_t row,
                                                              std::int32_t number) const {
    const auto& [step, world, edges] = search;
    const Bodies<Real>& bodies = world.bodies;
    const Edge& edge = world.edges[number];
    const EdgePose& pose = edges.pose_of(edge);
    const bool may_bounce = step.settings.effects.restitution && hold_[row] == EdgeHold::none &&
                            (bodies.restitution[row] > 0 || bodies.restitution[pose.row] > 0);
    if (may_bounce || !is_curve_at_rest(search, number)) return {};
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
    const double dt = step.terms.dt, radius = bodies.radius[row],
                 touching = radius + step.settings.contact_distance(radius), longest = kLongestLed * radius;
    const auto [p, way] = relative_way(bodies, pose, row, v, dt);
    const double share = nearest_share(p, edge.a, edge.b),
                 distance = length_squared(p - point_at(edge.a, edge.b, share));
    if (!(distance > 0) || !(distance <= touching * touching) || !(length_squared(way) < longest * longest) ||
        !is_touched_here(p, share, world.edges, edge))
        return {};
    const Vec2 fall = fall_of(step.terms);
    const auto led = lead_along_curve(
        world.edges,
        {number, radius, p, rotate_back(pose.turn, v), rotate_back(pose.turn, fall), step.terms.substep_dt},
        dt);
    if (!led) return {};
    return rotate(pose.turn, *led);
}

/// Gives a disc the impulse that turns its velocity, with friction and rolling resistance.
template <class Real>
void SupportFinder<Real>::give_turn(const Search& search, std::size_t row, std::size_t of_edge,
                                    Books& books) {
    const StepView<Real>& step = search.step;
    const Bodies<Real>& bodies = search.world.bodies;
    const ContactEffects& effects = step.settings.effects;
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]}, led = velocity_[row], change = led - v;
    const Vec2 fall = fall_of(step.terms);
    const double mass = bodies.mass[row], turn = mass * std::sqrt(length_squared(change));  // N s
    const auto number = static_cast<std::int32_t>(row);
    DoubleBody disc = body_at(step.records.velocity, number);
    const double rim = step.records.start_of_substep(number)[2];
    disc.record[0] = led.x, disc.record[1] = led.y, disc.record[2] = rim;
    const DoubleSurface surface{0, 0, 0};
    const double sense = cross(led, change) > 0 ? 1 : -1, speed = std::sqrt(length_squared(led));
    ContactTerms<double> terms{};
    terms.nx = sense / speed * led.y, terms.ny = -sense / speed * led.x;  // into the curve
    terms.of_a = 1;
    if (effects.friction) {
        double slip = tangent_velocity(disc, surface, terms.nx, terms.ny);
        if (effects.rolling) {
            terms.rolling =
                pair_rolling_resistance(bodies.rolling_resistance[row], bodies.rolling_resistance[of_edge]);
            const double rolls = rolling_velocity(disc, surface, terms.of_a);
            const double roll = solve_rolling(disc, surface, terms, 0.0, turn, slip).added;
            if (books.is_open)
                books.friction += 0.5 * roll * (rolls + rolling_velocity(disc, surface, terms.of_a));
        }
        // What rolls has no slip in the middle of the step. To be free of it at its start only would take
        // from each step what gravity makes in it; never more is left than there was.
        const double most = std::fabs(slip), by_gravity = 0.5 * (fall.y * terms.nx - fall.x * terms.ny),
                     left = std::clamp(by_gravity, -most, most);
        const double limit = pair_friction(bodies.friction[row], bodies.friction[of_edge]) * turn;
        const double drag =
            hold_within(0.0, (left - slip) / inverse_tangent_mass(disc, surface), limit).added;
        disc.apply_impulse(0, drag, terms.nx, terms.ny, -1);
        if (books.is_open)
            books.friction += 0.5 * drag * (slip + tangent_velocity(disc, surface, terms.nx, terms.ny));
    }
    velocity_[row] = {disc.record[0], disc.record[1]};
    step.records.add_velocity(number, velocity_[row] - v, disc.record[2] - rim, step.terms);
    if (books.is_open) books.immovable_momentum += mass * (velocity_[row] - v);
}

template <class Real>
void SupportFinder<Real>::remember_led(ContactRows<Real>& candidates,
                                       const ContactRows<Real>& supports) const {
    if (hold_.empty()) return;
    supports.for_each([&](std::size_t i) {
        const auto candidate = static_cast<std::size_t>(supports.candidate[i]);
        Real& impulse = candidates.normal_impulse[candidate];
        if (hold_[static_cast<std::size_t>(supports.a[i])] == EdgeHold::led &&
            candidates.partner(candidate).is_edge() && !(impulse > 0))
            impulse = kHeldByTurn<Real>;
    });
}

/// The supports of a group stand where its candidates stand, closer together.
template <class Real>
void SupportFinder<Real>::find_in_group(std::size_t group, const Search& search) {
    const auto& [step, world, edges] = search;
    ContactRows<Real>& candidates = step.graph.supports;
    const ContactSettings& settings = step.settings;
    const double dt = step.terms.dt;
    const Bodies<Real>& bodies = world.bodies;
    const bool rolls = settings.effects.rolling;
    const auto padding_row =
        static_cast<std::int32_t>(step.records.count() + step.graph.groups.count() + group);
    left_edges_of_[group].clear();
    // A contact that is out of reach holds nothing: neither now nor when the body is back.
    const auto let_go = [&](std::size_t i) {
        candidates.normal_impulse[i] = candidates.friction_impulse[i] = 0;
        if (rolls) candidates.rolling_impulse[i] = 0;
    };
    std::size_t place = candidates.first_place(group);
    for (std::size_t c = candidates.first_colour[group]; c < candidates.first_colour[group + 1]; ++c) {
        std::size_t at = place;
        for (std::size_t i = candidates.begin[c]; i < candidates.begin[c] + candidates.count[c]; ++i) {
            const auto row = static_cast<std::size_t>(candidates.a[i]);
            const Partner support = candidates.partner(i);
            const double radius = bodies.radius[row], at_rest = settings.contact_distance(radius);
            // Separation up to which a support is kept: the body may be thrown there, or come that way.
            const auto near = [&](bool may_be_thrown, double way) {
                return at_rest + std::max(may_be_thrown ? kCrowdedRadii * radius : 0, way);
            };
            const Vec2 v = velocity_of(bodies, row);
            // A wall that an impact or a heavy body may throw a body to is kept wherever it is. Others are
            // far away as a rule in a small box: that is told before anything else.
            const bool is_kept =
                support.is_wall() && (settings.effects.restitution || settings.masses_are_uneven);
            if (support.is_wall() && !is_kept) {
                const Vec2 x{bodies.position_x[row], bodies.position_y[row]};
                if (wall_clearance(*world.walls, support.side(), x) - radius >
                    near(true, way_within(dt, v))) {
                    let_go(i);
                    continue;
                }
            } else if (support.is_edge() && !(candidates.normal_impulse[i] > 0)) {
                const auto [clearance, way] = clearance_of_edge(world, edges, row, support.edge_number(), dt);
                if (clearance > near(true, kBothAxes * way)) {
                    let_go(i);
                    continue;
                }
            }
            const SupportSurface s =
                support.is_edge()
                    ? surface_of_edge(world, edges, row, support.edge_number(), v, dt, hold_[row])
                    : surface_of(world, row, support);
            const Vec2 dv = s.velocity - v;
            // What is flat is so everywhere, so it is kept however slowly a body nears it: in a crowd another
            // one may yet throw it there within this step. What is round only holds where it is met, but an
            // impact may throw the body there, too.
            const bool may_be_thrown = s.is_flat || settings.effects.restitution;
            const bool is_far = s.separation > near(may_be_thrown, way_within(dt, dv));
            if (!s.is_contact || (is_far && !is_kept)) {
                if (!s.is_contact) note_left_edge(i, group, search);
                let_go(i);
                continue;
            }
            add_support(s, v, i, at, step, world);
            ++at;
        }
        place = step.supports.close_colour(c, place, at - place, padding_row);
    }
}

template <class Real>
void SupportFinder<Real>::note_left_edge(std::size_t candidate, std::size_t group, const Search& search) {
    const ContactRows<Real>& candidates = search.step.graph.supports;
    const ContactEffects& effects = search.step.settings.effects;
    if (!(candidates.normal_impulse[candidate] > 0)) return;
    left_edges_of_[group].push_back(
        {candidates.a[candidate], search.world.edges.track_of(candidates.partner(candidate).edge_number()),
         static_cast<std::int32_t>(candidate), candidates.normal_impulse[candidate],
         effects.friction ? candidates.friction_impulse[candidate] : Real(0),
         effects.rolling ? candidates.rolling_impulse[candidate] : Real(0)});
}

/// A disc that rolls from one edge of a chain, or of a track, to the next rests on the second with what it
/// rested on the first.
template <class Real>
void SupportFinder<Real>::hand_on_impulses(const Search& search) {
    if (left_edges_.empty()) return;
    ContactRows<Real>& supports = search.step.supports;
    const ContactEffects& effects = search.step.settings.effects;
    const auto by_row = [](const LeftEdge& left, const LeftEdge& right) {
        return std::tie(left.row, left.track, left.candidate) <
               std::tie(right.row, right.track, right.candidate);
    };
    std::sort(left_edges_.begin(), left_edges_.end(), by_row);
    supports.for_each([&](std::size_t i) {
        const Partner support =
            search.step.graph.supports.partner(static_cast<std::size_t>(supports.candidate[i]));
        if (!support.is_edge() || supports.normal_impulse[i] > 0) return;
        const LeftEdge wanted{supports.a[i], search.world.edges.track_of(support.edge_number()), -1, 0, 0, 0};
        const auto left = std::lower_bound(left_edges_.begin(), left_edges_.end(), wanted, by_row);
        if (left == left_edges_.end() || left->row != wanted.row || left->track != wanted.track) return;
        supports.normal_impulse[i] = left->normal_impulse;
        if (effects.friction) supports.friction_impulse[i] = left->friction_impulse;
        if (effects.rolling) supports.rolling_impulse[i] = left->rolling_impulse;
        left->normal_impulse = left->friction_impulse = left->rolling_impulse = 0;  // one takes it
    });
}

template class SupportFinder<float>;
template class SupportFinder<double>;

}  // namespace carom
