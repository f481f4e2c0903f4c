#include "solvers/soft/contacts/support_finder.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "constraints/support_surface.hpp"
#include "effects/friction.hpp"
#include "effects/rolling_resistance.hpp"

namespace carom {
namespace {

/// A flat support as near as this, in radii of the body, is kept however slowly the body nears it.
constexpr double kCrowdedRadii = 1;
/// |x| + |y| of a vector, in lengths of it, at most.
constexpr double kBothAxes = 1.415;
constexpr double kNanosecondsToFind = 10;  // a support on one thread, for the executor

/// Writes a support that can touch.
/// @param candidate, at  its places in the graph and in the supports of the step
template <class Real>
void add_support(const SupportSurface& surface, std::size_t candidate, std::size_t at,
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
    supports.separation[at] = real(surface.separation);
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
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
    if (effects.restitution) supports.approach[at] = real(dot(surface.velocity - v, n));
    if (effects.restitution) supports.clearance[at] = supports.separation[at];
    supports.candidate[at] = static_cast<std::int32_t>(candidate);
}

}  // namespace

template <class Real>
void SupportFinder<Real>::find(const StepView<Real>& step, const WorldState<Real>& world,
                               const EdgeCandidates<Real>& edges) {
    const ContactRows<Real>& candidates = step.graph.supports;
    step.supports.resize_for_some_of(candidates, step.settings.effects.of_supports());
    const std::size_t groups = candidates.groups();
    left_edges_of_.resize(std::max(left_edges_of_.size(), groups));
    const Search search{step, world, edges};
    note_pressing(search);
    const double work = kNanosecondsToFind * static_cast<double>(candidates.a.size());
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
    if (search.world.edges.empty()) return;
    presses_on_edges_.assign(search.world.bodies.rows(), 0);
    const ContactRows<Real>& candidates = search.step.graph.supports;
    candidates.for_each([&](std::size_t i) {
        if (candidates.normal_impulse[i] > 0 && candidates.partner(i).is_edge())
            presses_on_edges_[static_cast<std::size_t>(candidates.a[i])] = 1;
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
            if (support.is_edge() && !(candidates.normal_impulse[i] > 0)) {
                const auto [clearance, way] = clearance_of_edge(world, edges, row, support.edge_number(), dt);
                if (clearance > at_rest + std::max(kCrowdedRadii * radius, kBothAxes * way)) {
                    let_go(i);
                    continue;
                }
            }
            const SupportSurface s = support.is_edge()
                                         ? surface_of_edge(world, edges, row, support.edge_number(), dt,
                                                           presses_on_edges_[row] != 0)
                                         : surface_of(world, row, support);
            const Vec2 dv = s.velocity - Vec2{bodies.velocity_x[row], bodies.velocity_y[row]};
            // A wall is a wall everywhere, so it is kept however slowly a body nears it: in a crowd another
            // one may yet throw it there within this step. What is round only holds where it is met.
            const double crowd = s.is_flat ? kCrowdedRadii * radius : 0;
            const double near = at_rest + std::fmax(crowd, dt * (std::fabs(dv.x) + std::fabs(dv.y)));
            const bool is_far = !support.is_wall() && s.separation > near;
            if (!s.is_contact || is_far) {
                if (!s.is_contact) note_left_edge(i, group, search);
                let_go(i);
                continue;
            }
            add_support(s, i, at, step, world);
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
        {candidates.a[candidate], search.world.edges[candidates.partner(candidate).edge_number()].body,
         static_cast<std::int32_t>(candidate), candidates.normal_impulse[candidate],
         effects.friction ? candidates.friction_impulse[candidate] : Real(0),
         effects.rolling ? candidates.rolling_impulse[candidate] : Real(0)});
}

/// A disc that rolls from one edge of a chain to the next rests on the second with what it rested on the
/// first.
template <class Real>
void SupportFinder<Real>::hand_on_impulses(const Search& search) {
    if (left_edges_.empty()) return;
    ContactRows<Real>& supports = search.step.supports;
    const ContactEffects& effects = search.step.settings.effects;
    const auto by_row = [](const LeftEdge& left, const LeftEdge& right) {
        return std::tie(left.row, left.body, left.candidate) <
               std::tie(right.row, right.body, right.candidate);
    };
    std::sort(left_edges_.begin(), left_edges_.end(), by_row);
    supports.for_each([&](std::size_t i) {
        const Partner support =
            search.step.graph.supports.partner(static_cast<std::size_t>(supports.candidate[i]));
        if (!support.is_edge() || supports.normal_impulse[i] > 0) return;
        const LeftEdge wanted{supports.a[i], search.world.edges[support.edge_number()].body, -1, 0, 0, 0};
        const auto left = std::lower_bound(left_edges_.begin(), left_edges_.end(), wanted, by_row);
        if (left == left_edges_.end() || left->row != wanted.row || left->body != wanted.body) return;
        supports.normal_impulse[i] = left->normal_impulse;
        if (effects.friction) supports.friction_impulse[i] = left->friction_impulse;
        if (effects.rolling) supports.rolling_impulse[i] = left->rolling_impulse;
        left->normal_impulse = left->friction_impulse = left->rolling_impulse = 0;  // one takes it
    });
}

template class SupportFinder<float>;
template class SupportFinder<double>;

}  // namespace carom
