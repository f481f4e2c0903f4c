// Links of paths as a step begins, and what they leave to the next one: the contacts that the manifolds list,
// put where the cut has them.
#include <algorithm>
#include <cstdint>
#include <span>

#include "solvers/paths/path_link.hpp"
#include "solvers/paths/path_solver.hpp"

namespace carom {
namespace {

// ns on one thread, for the executor.
constexpr double kNanosecondsToFill = 10, kNanosecondsToKeep = 5;
constexpr std::size_t kBundlesPerTask = 4, kContactsPerTaskOfLayout = 256;

/// Calls fn(n) for n below `count`, on all threads.
template <class Fn>
void for_each_number(std::size_t count, double nanoseconds, const Executor& executor, const Fn& fn) {
    executor.for_each_chunk(count, kContactsPerTaskOfLayout, nanoseconds,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t n = first; n < last; ++n) fn(n);
                            });
}

}  // namespace

/// The links of all contacts: of those that are carried on, moved by what their bodies have come, and of
/// those that were found, as they were found.
template <class Real>
void PathSolver<Real>::lay_out(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                               const SubstepTerms& terms, BodyRecords<Real>& records,
                               const StepLoops<Real>& loops) {
    counters.bundles = static_cast<std::int64_t>(cut().bundles());
    counters.links = static_cast<std::int64_t>(cut().links());
    if (first_still_row_ != records.rows()) links_hold_ = false;
    if (!links_hold_) name_rows(world, records, loops);
    records.add_still_rows(still_rows_);
    if (!links_hold_) {
        lay_out_padding(loops);
        if (manifolds.some_are_carried()) fill_links(false, world, records, loops);
    }
    if (manifolds.some_are_carried()) carry_links(terms, records, loops);
    fill_links(true, world, records, loops);
    links_hold_ = true;
    pieces_.forget();
    move_still_rows(world, edges, terms, records);
}

template <class Real>
std::int32_t PathSolver<Real>::head_row(std::int32_t first) const {
    const auto n = static_cast<std::size_t>(first);
    if (cut().places()[n].is_reversed) return row_of_far_[n];
    const std::int32_t contact = manifolds.live()[n];
    return manifolds.list_of(contact).a[Manifolds<Real>::place_of(contact)];
}

template <class Real>
void PathSolver<Real>::lay_out_padding(const StepLoops<Real>& loops) {
    links_.resize_for_overwrite(cut().links());
    restless_.resize_for_overwrite(kPathLanes * cut().bundles());
    const auto none = static_cast<Real>(kNoPoint);
    loops.executor->for_each_chunk(
        cut().bundles(), kBundlesPerTask, kNanosecondsToFill * kPathLanes,
        [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t bundle = first; bundle < last; ++bundle) {
                const auto still = static_cast<std::int32_t>(first_still_row_ + bundle);
                for (std::size_t i = cut().first_link()[bundle]; i < cut().first_link()[bundle + 1]; ++i) {
                    PathLink<Real>& link = links_[i];
                    link = {};
                    std::fill_n(link.body, kPathLanes, still);
                    std::fill_n(link.separation1, kPathLanes, none);
                    std::fill_n(link.separation2, kPathLanes, none);
                }
            }
        });
    for (const PathCut::Jump& jump : cut().jumps())
        links_[jump.link].body[jump.lane] = head_row(jump.contact);
}

/// Fills the links of the contacts that were found in this step, or of the others.
template <class Real>
void PathSolver<Real>::fill_links(bool found, const WorldState<Real>& world, const BodyRecords<Real>& records,
                                  const StepLoops<Real>& loops) {
    const auto fill = [&](std::size_t n) {
        const std::int32_t contact = manifolds.live()[n];
        const PathCut::Place place = cut().places()[n];
        const LinkPlace<Real> link{links_[place.link], place.lane, place.is_reversed, row_of_far_[n]};
        ManifoldList<Real>& list = manifolds.list_of(contact);
        const std::size_t i = Manifolds<Real>::place_of(contact);
        // What is carried on behind a contact that was found needs its body: found ones are filled later.
        if (!found && manifolds.is_found(contact)) return link.write_body(list, i);
        write_link<Real>(link, list, i, found, world.bodies, records);
    };
    if (found) {
        const std::span<const std::int32_t> numbers = manifolds.found();
        for_each_number(numbers.size(), kNanosecondsToFill, *loops.executor,
                        [&](std::size_t i) { fill(static_cast<std::size_t>(numbers[i])); });
    } else {
        for_each_number(manifolds.live().size(), kNanosecondsToFill, *loops.executor, fill);
    }
}

template <class Real>
void PathSolver<Real>::carry_links(const SubstepTerms& terms, BodyRecords<Real>& records,
                                   const StepLoops<Real>& loops) {
    SolvePaths<Real> k = arguments(terms, records);
    k.come = manifolds.poses().come(records.rows()), k.turned = manifolds.poses().turned();
    run(loops.kernels->convex->paths.carry, k, loops);
    loops.kernels->convex->paths.carry(k, cut().first_watched(), cut().bundles());
}

/// Velocities of kinematic bodies where they touch.
template <class Real>
void PathSolver<Real>::move_still_rows(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                       const SubstepTerms& terms, BodyRecords<Real>& records) {
    const Bodies<Real>& bodies = world.bodies;
    const std::span<const std::int32_t> live = manifolds.live();
    const auto move = [&](std::size_t n) {
        const ManifoldList<Real>& list = manifolds.list_of(live[n]);
        const std::size_t i = Manifolds<Real>::place_of(live[n]);
        const Partner partner(list.b[i]);
        if (partner.is_wall()) return;
        const std::size_t b = partner.is_edge() ? edges.pose_of(world.edges[partner.edge_number()]).row
                                                : static_cast<std::size_t>(partner.row());
        if ((bodies.flags_of(b) & kKinematic) == 0) return;
        Real* velocity = &records.velocity[4 * static_cast<std::size_t>(row_of_far_[n])];
        velocity[0] = bodies.velocity_x[b], velocity[1] = bodies.velocity_y[b];
        // An edge has the rim of what touches it: write_link.
        const std::size_t of_rim = partner.is_edge() ? static_cast<std::size_t>(list.a[i]) : b;
        if (bodies.has_rotation) velocity[2] = bodies.angular_velocity[b] * bodies.rim(of_rim);
        if (partner.is_edge()) {
            const Edge& edge = world.edges[partner.edge_number()];
            turning_edges_.add_edge(list, i, row_of_far_[n], edge, edges.pose_of(edge), terms, records);
        } else {
            const std::int32_t item = list.item_b.empty() ? list.b[i] : list.item_b[i];
            turning_edges_.add_side(list, i, row_of_far_[n], bodies,
                                    world.shapes[manifolds.shape_of_item(world, b, item)], terms, records);
        }
    };
    turning_edges_.clear();
    for (const std::int32_t n : with_kinematic_) move(static_cast<std::size_t>(n));
    for (std::size_t n = live.size(); n-- > 0 && live[n] < 0;) move(n);  // surfaces come last
}

template <class Real>
void PathSolver<Real>::end(const Executor& executor) {
    const auto keep = [&](std::size_t n) {
        const PathCut::Place place = cut().places()[n];
        const PathLink<Real>& link = links_[place.link];
        const std::size_t lane = place.lane;
        ManifoldMemory<Real>& memory = manifolds.memory_of(manifolds.live()[n]);
        memory.normal1 = link.normal1[lane], memory.normal2 = link.normal2[lane];
        memory.tangent = link.tangent[lane];
        memory.separation1 = link.separation1[lane], memory.separation2 = link.separation2[lane];
    };
    for_each_number(manifolds.live().size(), kNanosecondsToKeep, executor, keep);
}

template class PathSolver<float>;
template class PathSolver<double>;

}  // namespace carom
