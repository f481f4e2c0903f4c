// What nothing moves, as the contacts of solver `soft` see it: walls, static and kinematic bodies, edges.
#include "solvers/soft/soft_solver.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "constraints/support_surface.hpp"
#include "effects/friction.hpp"
#include "effects/rolling_resistance.hpp"

namespace carom {
namespace {

/// Of an edge that is kept like a wall, however slowly a disc nears it.
constexpr double kCrowdedRadii = 1;
/// |x| + |y| of a vector, in lengths of it, at most.
constexpr double kBothAxes = 1.415;
constexpr double kNanosecondsToFind = 10;  // a support on one thread, for the executor

}  // namespace

template <class Real>
void SoftSolver<Real>::add_support(const SupportSurface& surface, std::size_t candidate, std::size_t at,
                                   const WorldState<Real>& world) {
    const ContactRows<Real>& candidates = graph.supports;
    const Bodies<Real>& bodies = world.bodies;
    const auto row = static_cast<std::size_t>(candidates.a[candidate]);
    const auto real = [](double value) { return static_cast<Real>(value); };
    const Vec2 n = surface.normal;
    supports_.a[at] = candidates.a[candidate];
    supports_.normal_x[at] = real(n.x), supports_.normal_y[at] = real(n.y);
    supports_.separation[at] = real(surface.separation);
    supports_.mass[at] = real(1 / bodies.inverse_mass(row));
    if (radius_varies_) supports_.smaller[at] = bodies.radius[row];
    supports_.normal_impulse[at] = candidates.normal_impulse[candidate];
    supports_.surface_normal[at] = real(dot(surface.velocity, n));
    supports_.surface_tangent[at] = real(cross(n, surface.velocity));
    if (has_friction_) {
        supports_.friction_impulse[at] = candidates.friction_impulse[candidate];
        supports_.friction[at] = real(pair_friction(bodies.friction[row], surface.friction));
    }
    if (rolls_) {
        supports_.rolling_impulse[at] = candidates.rolling_impulse[candidate];
        supports_.rolling[at] =
            real(pair_rolling_resistance(bodies.rolling_resistance[row], surface.rolling_resistance));
        supports_.rolling_share[at] = real(surface.rolling_share);
        supports_.surface_rolling[at] = real(surface.rolling_velocity);
    }
    const Vec2 v{bodies.velocity_x[row], bodies.velocity_y[row]};
    if (bounces_) supports_.approach[at] = real(dot(surface.velocity - v, n));
    if (bounces_) supports_.clearance[at] = supports_.separation[at];
    supports_.candidate[at] = static_cast<std::int32_t>(candidate);
}

template <class Real>
void SoftSolver<Real>::find_supports(const WorldState<Real>& world, const EdgeCandidates<Real>& edges) {
    ContactRows<Real>& candidates = graph.supports;
    supports_.resize_for_some_of(candidates, contact_effects().of_supports());
    const std::size_t groups = candidates.groups();
    left_edges_of_.resize(std::max(left_edges_of_.size(), groups));
    const double work = kNanosecondsToFind * static_cast<double>(candidates.a.size());
    executor_->for_each_task(groups, work, [&](std::size_t group) { find_supports_of(group, world, edges); });
    left_edges_.clear();
    for (std::size_t group = 0; group < groups; ++group)
        left_edges_.insert(left_edges_.end(), left_edges_of_[group].begin(), left_edges_of_[group].end());
    hand_on_impulses(world);
}

/// The supports of a group stand where its candidates stand, closer together.
template <class Real>
void SoftSolver<Real>::find_supports_of(std::size_t group, const WorldState<Real>& world,
                                        const EdgeCandidates<Real>& edges) {
    ContactRows<Real>& candidates = graph.supports;
    const Bodies<Real>& bodies = world.bodies;
    left_edges_of_[group].clear();
    // A contact that is out of reach holds nothing: neither now nor when the body is back.
    const auto let_go = [&](std::size_t i) {
        candidates.normal_impulse[i] = candidates.friction_impulse[i] = 0;
        if (rolls_) candidates.rolling_impulse[i] = 0;
    };
    std::size_t place = candidates.first_place(group);
    for (std::size_t c = candidates.first_colour[group]; c < candidates.first_colour[group + 1]; ++c) {
        std::size_t at = place;
        for (std::size_t i = candidates.begin[c]; i < candidates.begin[c] + candidates.count[c]; ++i) {
            const auto row = static_cast<std::size_t>(candidates.a[i]);
            const Partner support = candidates.partner(i);
            const double radius = bodies.radius[row], at_rest = contact_distance(radius);
            if (support.is_edge() && !(candidates.normal_impulse[i] > 0)) {
                const auto [clearance, way] =
                    clearance_of_edge(world, edges, row, support.edge_number(), dt_);
                if (clearance > at_rest + std::max(kCrowdedRadii * radius, kBothAxes * way)) {
                    let_go(i);
                    continue;
                }
            }
            const SupportSurface s = support.is_edge()
                                         ? surface_of_edge(world, edges, row, support.edge_number(), dt_)
                                         : surface_of(world, row, support);
            const Vec2 dv = s.velocity - Vec2{bodies.velocity_x[row], bodies.velocity_y[row]};
            // A wall is a wall everywhere, so it is kept however slowly a body nears it: in a crowd another
            // one may yet throw it there within this step. What is round only holds where it is met.
            const double crowd = s.is_flat ? kCrowdedRadii * radius : 0;
            const double near = at_rest + std::fmax(crowd, dt_ * (std::fabs(dv.x) + std::fabs(dv.y)));
            const bool is_far = !support.is_wall() && s.separation > near;
            if (!s.is_contact || is_far) {
                if (!s.is_contact) note_left_edge(i, group, world);
                let_go(i);
                continue;
            }
            add_support(s, i, at, world);
            ++at;
        }
        place = supports_.close_colour(c, place, at - place, padding_row_of_supports(group));
    }
}

template <class Real>
void SoftSolver<Real>::note_left_edge(std::size_t candidate, std::size_t group,
                                      const WorldState<Real>& world) {
    const ContactRows<Real>& candidates = graph.supports;
    if (!(candidates.normal_impulse[candidate] > 0)) return;
    left_edges_of_[group].push_back(
        {candidates.a[candidate], world.edges[candidates.partner(candidate).edge_number()].body,
         static_cast<std::int32_t>(candidate), candidates.normal_impulse[candidate],
         has_friction_ ? candidates.friction_impulse[candidate] : Real(0),
         rolls_ ? candidates.rolling_impulse[candidate] : Real(0)});
}

/// A disc that rolls from one edge of a chain to the next rests on the second with what it rested on the
/// first.
template <class Real>
void SoftSolver<Real>::hand_on_impulses(const WorldState<Real>& world) {
    if (left_edges_.empty()) return;
    const auto by_row = [](const LeftEdge& left, const LeftEdge& right) {
        return std::tie(left.row, left.body, left.candidate) <
               std::tie(right.row, right.body, right.candidate);
    };
    std::sort(left_edges_.begin(), left_edges_.end(), by_row);
    supports_.for_each([&](std::size_t i) {
        const Partner support = graph.supports.partner(static_cast<std::size_t>(supports_.candidate[i]));
        if (!support.is_edge() || supports_.normal_impulse[i] > 0) return;
        const LeftEdge wanted{supports_.a[i], world.edges[support.edge_number()].body, -1, 0, 0, 0};
        const auto left = std::lower_bound(left_edges_.begin(), left_edges_.end(), wanted, by_row);
        if (left == left_edges_.end() || left->row != wanted.row || left->body != wanted.body) return;
        supports_.normal_impulse[i] = left->normal_impulse;
        if (has_friction_) supports_.friction_impulse[i] = left->friction_impulse;
        if (rolls_) supports_.rolling_impulse[i] = left->rolling_impulse;
        left->normal_impulse = left->friction_impulse = left->rolling_impulse = 0;  // one takes it
    });
}

template void SoftSolver<float>::add_support(const SupportSurface&, std::size_t, std::size_t,
                                             const WorldState<float>&);
template void SoftSolver<double>::add_support(const SupportSurface&, std::size_t, std::size_t,
                                              const WorldState<double>&);
template void SoftSolver<float>::note_left_edge(std::size_t, std::size_t, const WorldState<float>&);
template void SoftSolver<double>::note_left_edge(std::size_t, std::size_t, const WorldState<double>&);
template void SoftSolver<float>::hand_on_impulses(const WorldState<float>&);
template void SoftSolver<double>::hand_on_impulses(const WorldState<double>&);
template void SoftSolver<float>::find_supports_of(std::size_t, const WorldState<float>&,
                                                  const EdgeCandidates<float>&);
template void SoftSolver<double>::find_supports_of(std::size_t, const WorldState<double>&,
                                                   const EdgeCandidates<double>&);
template void SoftSolver<float>::find_supports(const WorldState<float>&, const EdgeCandidates<float>&);
template void SoftSolver<double>::find_supports(const WorldState<double>&, const EdgeCandidates<double>&);

}  // namespace carom
