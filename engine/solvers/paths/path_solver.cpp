#include "solvers/paths/path_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "constraints/partner.hpp"
#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "math/rotation.hpp"
#include "narrowphase/box_box.hpp"

namespace carom {
namespace {

// docs/decisions/0027-paths-of-contacts.md has the measurements behind these.

/// Share of an overlap that a substep takes away. Pushes do work on the loads that they lift: at 0.4 heaps of
/// boxes shake for ever.
constexpr double kRecovery = 0.05;
/// Largest displacement of that kind, in thicknesses a second.
constexpr double kPushThicknesses = 6;
/// Contacts in a path: what is longer is cut. While many paths do not settle they are kept short: a long one
/// that fails has done more in vain.
constexpr std::size_t kLongestPath = 128, kLongestOfRestless = 16;
/// Share of paths that do not settle, below which paths become long and above which they become short.
constexpr double kCalm = 0.001, kRestless = 0.01;
/// Fewer contacts have long paths from the start; more begin with short ones, as heaps do that still settle.
constexpr std::size_t kFewContacts = 1024;
/// Iterations of the active set: those that change all of its rows that are wrong; all, while paths are long
/// and while they are short. Gauss-Seidel sweeps over a path where it does not settle by then.
constexpr int kBoldIterations = 4, kMostIterations = 40, kMostOfRestless = 8, kSweepsOfUnsettled = 4;
/// By which a contact may miss its law, in shares of what gravity adds to a speed in a substep.
constexpr double kTolerance = 2e-4;
/// A contact that may be rotated by so much keeps its impulses: cosine of 25 degrees.
constexpr double kSameNormal = 0.9;
/// Two points whose rows are alike by more than this are solved as one: det K / (k11 k22).
constexpr double kLeastDeterminant = 1e-3;
/// Paths are cut anew after so many steps, since loads have changed.
constexpr int kStepsOfCut = 30;

// ns on one thread, for the executor.
constexpr double kNanosecondsToFind = 10, kNanosecondsToFill = 10, kNanosecondsToSolve = 10;
constexpr std::size_t kBundlesPerTask = 4, kContactsPerTask = 256;

}  // namespace

template <class Real>
void PathSolver<Real>::add_pair(const WorldState<Real>& world, std::int32_t a, std::int32_t b, bool boxes) {
    const Bodies<Real>& bodies = world.bodies;
    if (a > b) std::swap(a, b);
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    if (bodies.is_disc(i) && bodies.is_disc(k)) return;
    if (bodies.shape[i] < 0 || bodies.shape[k] < 0) return;  // edges
    if (boxes != (is_box_of_[static_cast<std::size_t>(bodies.shape[i])] &&
                  is_box_of_[static_cast<std::size_t>(bodies.shape[k])]))
        return;
    const bool a_moves = !bodies.is_immovable(i), b_moves = k < bodies.count && !bodies.is_immovable(k);
    if (!a_moves && !b_moves) return;
    if (!a_moves) std::swap(a, b);
    bodies_.add(a, b, {bodies.id[static_cast<std::size_t>(a)], bodies.id[static_cast<std::size_t>(b)], 0});
}

template <class Real>
void PathSolver<Real>::renew(const WorldState<Real>& world, const Candidates<Real>& candidates,
                             const EdgeCandidates<Real>& edges, std::span<const SleeperPair> sleepers) {
    live_.clear();
    surface_finder_.renew(world, edges);
    if (!world.bodies.has_shapes) return bodies_.clear(), surfaces_.clear();
    std::swap(bodies_, old_), bodies_.clear();
    // Of a contact that wakes, what it had when it fell asleep.
    if (world.bodies.asleep != asleep_then_)
        for (const KeptManifold<Real>& kept : asleep_) {
            ManifoldList<Real>& list = kept.is_surface ? surfaces_ : old_;
            list.add(0, 0, kept.name), list.memory.back() = kept.memory;
        }
    list_boxes(world.shapes);
    // Boxes first: blocks of them alone have a quicker kernel.
    for (const bool boxes : {true, false}) {
        for (std::size_t p = 0; p < candidates.pair_count(); ++p)
            add_pair(world, candidates.pair_a()[p], candidates.pair_b()[p], boxes);
        for (const SleeperPair& pair : sleepers) add_pair(world, pair.row, pair.sleeper, boxes);
    }
    recall(bodies_, old_);
    find_box_blocks(world.bodies, 0);
    if (world.bodies.asleep != asleep_then_) keep_of_sleepers(world);
    asleep_then_ = world.bodies.asleep;
}

/// Keeps what no contact has recalled, if it is of a body that sleeps.
template <class Real>
void PathSolver<Real>::keep_of_sleepers(const WorldState<Real>& world) {
    asleep_.clear();
    const auto sleeps = [&](BodyId id) {
        return world.handles.is_alive(id) && world.handles.row_of_slot(id.index) >= world.bodies.count;
    };
    for (std::size_t i = 0; i < old_.count(); ++i)
        if (!is_recalled_[i] && old_.memory[i].is_loaded() &&
            (sleeps(old_.names[i].a) || sleeps(old_.names[i].b)))
            asleep_.push_back({old_.names[i], old_.memory[i], false});
    for (std::size_t i = 0; i < surfaces_.count(); ++i)
        if (surfaces_.memory[i].is_loaded() && sleeps(surfaces_.names[i].a))
            asleep_.push_back({surfaces_.names[i], surfaces_.memory[i], true});
}

template <class Real>
std::span<const LoadedContact> PathSolver<Real>::loaded() {
    loaded_.clear();
    for (const std::int32_t contact : live_) {
        const ManifoldList<Real>& list = list_of(contact);
        const std::size_t i = place_of(contact);
        if (list.memory[i].is_loaded())
            loaded_.push_back({list.a[i], Partner(list.b[i]),
                               static_cast<double>(list.memory[i].normal1 + list.memory[i].normal2)});
    }
    return loaded_;
}

template <class Real>
void PathSolver<Real>::list_boxes(const ShapeStore<Real>& shapes) {
    is_box_of_.resize(shapes.size());
    for (std::size_t shape = 0; shape < shapes.size(); ++shape)
        is_box_of_[shape] = is_box(shapes[static_cast<std::int32_t>(shape)]);
}

template <class Real>
void PathSolver<Real>::find_box_blocks(const Bodies<Real>& bodies, std::size_t first) {
    blocks_are_boxes_.resize(padded(bodies_.count()) / kRowPadding);
    for (std::size_t block = first; block < blocks_are_boxes_.size(); ++block) {
        bool all = true;
        const std::size_t last = std::min(bodies_.count(), (block + 1) * kRowPadding);
        for (std::size_t i = block * kRowPadding; i < last; ++i)
            for (const std::int32_t row : {bodies_.a[i], bodies_.b[i]})
                all =
                    all && is_box_of_[static_cast<std::size_t>(bodies.shape[static_cast<std::size_t>(row)])];
        blocks_are_boxes_[block] = all;
    }
}

template <class Real>
void PathSolver<Real>::add(const WorldState<Real>& world, const Candidates<Real>& candidates,
                           const EdgeCandidates<Real>& edges) {
    if (!world.bodies.has_shapes) return;
    surface_finder_.add(world, edges);
    const std::size_t before = bodies_.count();
    list_boxes(world.shapes);
    for (const bool boxes : {true, false})
        for (const auto& pair : candidates.new_pairs()) add_pair(world, pair.a, pair.b, boxes);
    bodies_.fit();
    find_box_blocks(world.bodies, before / kRowPadding);
}

/// Files the contacts that carry something by their body a.
template <class Real>
void PathSolver<Real>::file_by_slot(const ManifoldList<Real>& old) {
    std::uint32_t slots = 0;
    for (const auto& name : old.names) slots = std::max(slots, name.a.index + 1);
    first_of_slot_.assign(slots, -1);
    next_of_slot_.resize(old.count());
    for (std::size_t i = 0; i < old.count(); ++i) {
        if (!old.memory[i].is_loaded()) continue;
        std::int32_t& first = first_of_slot_[old.names[i].a.index];
        next_of_slot_[i] = first, first = static_cast<std::int32_t>(i);
    }
}

/// Gives the contacts of a list what those of the same name had in the old one.
template <class Real>
void PathSolver<Real>::recall(ManifoldList<Real>& list, const ManifoldList<Real>& old) {
    list.fit();
    file_by_slot(old);
    const std::size_t slots = first_of_slot_.size();
    is_recalled_.assign(old.count(), 0);
    const auto find = [&](const ManifoldName& name) -> const ManifoldMemory<Real>* {
        if (name.a.index >= slots) return nullptr;
        for (std::int32_t n = first_of_slot_[name.a.index]; n >= 0;
             n = next_of_slot_[static_cast<std::size_t>(n)]) {
            const auto i = static_cast<std::size_t>(n);
            if (old.names[i] == name) return is_recalled_[i] = 1, &old.memory[i];
        }
        return nullptr;
    };
    for (std::size_t i = 0; i < list.count(); ++i) {
        const ManifoldName& name = list.names[i];
        if (const auto* memory = find(name))
            list.memory[i] = *memory;
        else if (const auto* other = find({name.b, name.a, name.place}))
            list.memory[i] = other->reversed();
    }
}

/// A body may touch a chain in several places: each takes what the one before it had that faced the same way.
template <class Real>
void PathSolver<Real>::recall_surfaces() {
    file_by_slot(old_surfaces_);
    is_recalled_.assign(old_surfaces_.count(), 0);
    for (std::size_t i = 0; i < surfaces_.count(); ++i) {
        const ManifoldName& name = surfaces_.names[i];
        if (name.a.index >= first_of_slot_.size()) continue;
        std::int32_t best = -1;
        Real most = static_cast<Real>(kSameNormal);
        for (std::int32_t n = first_of_slot_[name.a.index]; n >= 0;
             n = next_of_slot_[static_cast<std::size_t>(n)]) {
            const auto k = static_cast<std::size_t>(n);
            if (is_recalled_[k] || !(old_surfaces_.names[k] == name)) continue;
            const ManifoldMemory<Real>& memory = old_surfaces_.memory[k];
            const Real alike =
                memory.normal_x * surfaces_.normal_x[i] + memory.normal_y * surfaces_.normal_y[i];
            if (alike > most) best = n, most = alike;
        }
        if (best < 0) continue;
        is_recalled_[static_cast<std::size_t>(best)] = 1;
        surfaces_.memory[i] = old_surfaces_.memory[static_cast<std::size_t>(best)];
    }
}

template <class Real>
void PathSolver<Real>::rescale(double factor) {
    if (factor == 1) return;
    const auto kept = static_cast<Real>(factor);
    for (ManifoldList<Real>* list : {&bodies_, &surfaces_})
        for (ManifoldMemory<Real>& memory : list->memory) memory.rescale(kept);
    for (KeptManifold<Real>& kept_manifold : asleep_) kept_manifold.memory.rescale(kept);
}

template <class Real>
void PathSolver<Real>::pose_bodies(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    const std::size_t rows = bodies.rows();
    pose_.resize(4 * rows), pose_angle_.resize(rows);
    for (std::size_t row = 0; row < rows; ++row) {
        Real* pose = &pose_[4 * row];
        pose[0] = bodies.position_x[row], pose[1] = bodies.position_y[row];
        const double angle = bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0;
        if (angle == pose_angle_[row] && (pose[2] != 0 || pose[3] != 0)) continue;
        const Rotation turn = rotation_by(angle);
        pose[2] = static_cast<Real>(turn.cos), pose[3] = static_cast<Real>(turn.sin);
        pose_angle_[row] = angle;
    }
}

template <class Real>
void PathSolver<Real>::find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                            const SubstepTerms& terms, const ContactDistance& near,
                            BodyRecords<Real>& records, const StepLoops<Real>& loops) {
    std::swap(surfaces_, old_surfaces_);
    if (is_idle(world)) {
        surfaces_.clear(), live_.clear(), was_live_.clear(), counters.contacts = 0;
        return;
    }
    pose_bodies(world);
    surface_finder_.find(world, edges, terms, near, surfaces_);
    recall_surfaces();
    const Bodies<Real>& bodies = world.bodies;
    const auto reach_in_step = [&](std::size_t row) {
        if (bodies.is_immovable(row) && (bodies.flags_of(row) & kKinematic) == 0) return Real(0);
        return std::fabs(bodies.velocity_x[row]) + std::fabs(bodies.velocity_y[row]) +
               std::fabs(bodies.angular_velocity[row]) * bodies.radius[row];
    };
    const auto real_dt = static_cast<Real>(terms.dt);
    const bool friction_varies = !bodies.friction.is_uniform();
    const Property<Real>& inradius = bodies.inradius();
    loops.executor->for_each_chunk(
        bodies_.count(), kContactsPerTask, kNanosecondsToFind,
        [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const auto a = static_cast<std::size_t>(bodies_.a[i]),
                           b = static_cast<std::size_t>(bodies_.b[i]);
                const bool b_moves = b < bodies.count && !bodies.is_immovable(b);
                // What nothing moves may be huge: how thick it is says nothing of the contact.
                bodies_.thickness[i] = b_moves ? std::min(inradius[a], inradius[b]) : inradius[a];
                bodies_.margin[i] = static_cast<Real>(near(static_cast<double>(bodies_.thickness[i]))) +
                                    real_dt * (reach_in_step(a) + reach_in_step(b));
                bodies_.restitution[i] =
                    static_cast<Real>(pair_restitution(bodies.restitution[a], bodies.restitution[b]));
                bodies_.friction[i] =
                    friction_varies ? static_cast<Real>(pair_friction(bodies.friction[a], bodies.friction[b]))
                                    : bodies.friction[a];
            }
            const FindManifolds<Real> k{pose_.data(),     bodies.shape.data(), world.shapes.data(),
                                        bodies_.a.data(), bodies_.b.data(),    bodies_.margin.data(),
                                        bodies_.columns()};
            for (std::size_t i = first; i < last; i += kRowPadding) {
                const auto kernel = blocks_are_boxes_[i / kRowPadding]
                                        ? loops.kernels->convex->find_box_manifolds
                                        : loops.kernels->convex->find_manifolds;
                kernel(k, i, i + kRowPadding);
            }
        });
    const bool is_same = list_live();
    note_calm();
    if (!is_same || ++since_cut_ >= kStepsOfCut || is_cut_calm_ != is_calm_) cut_paths(world);
    lay_out(world, edges, records, loops);
}

/// @return whether they are those of the step before
template <class Real>
bool PathSolver<Real>::list_live() {
    std::swap(live_, was_live_);
    live_.clear();
    const auto none = static_cast<Real>(kNoPoint);
    for (std::size_t i = 0; i < bodies_.count(); ++i)
        if (bodies_.separation1[i] < none)
            live_.push_back(static_cast<std::int32_t>(i));
        else
            bodies_.memory[i] = {};
    for (std::size_t i = 0; i < surfaces_.count(); ++i)
        if (surfaces_.separation1[i] < none)
            live_.push_back(~static_cast<std::int32_t>(i));
        else
            surfaces_.memory[i] = {};
    counters.contacts = static_cast<std::int64_t>(live_.size());
    return live_ == was_live_ &&
           std::equal(surfaces_.a.begin(), surfaces_.a.end(), old_surfaces_.a.begin(), old_surfaces_.a.end());
}

/// Judges by the last step whether paths settle.
template <class Real>
void PathSolver<Real>::note_calm() {
    if (solved_ == 0) {
        is_calm_ = live_.size() < kFewContacts;
        return;
    }
    const double share = static_cast<double>(counters.unsettled) / static_cast<double>(solved_);
    is_calm_ = share < (is_calm_ ? kRestless : kCalm);
    solved_ = 0;
}

template <class Real>
void PathSolver<Real>::cut_paths(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    contact_links_.clear();
    for (const std::int32_t contact : live_) {
        const ManifoldList<Real>& list = list_of(contact);
        const std::size_t i = place_of(contact);
        const ManifoldMemory<Real>& memory = list.memory[i];
        const Real sum = memory.normal1 + memory.normal2;
        const bool has_two = list.separation2[i] < static_cast<Real>(kNoPoint);
        const Real share = sum > 0 ? memory.normal2 / sum : has_two ? Real(0.5) : Real(0);
        const auto arm = [&](Real lever1, Real lever2, Real lever_t, float& x, float& y) {
            const Real lever = lever1 + share * (lever2 - lever1);  // r x n = -(r . t)
            x = static_cast<float>(lever_t * list.normal_x[i] + lever * list.normal_y[i]);
            y = static_cast<float>(lever_t * list.normal_y[i] - lever * list.normal_x[i]);
        };
        ContactLink link{list.a[i], list.b[i], 0, 0, 0, 0, sum > 0};
        const auto b = static_cast<std::size_t>(link.b);
        if (link.b < 0 || b >= bodies.count || bodies.is_immovable(b)) link.b = ContactLink::kNothing;
        arm(list.lever_a1[i], list.lever_a2[i], list.lever_a_t[i], link.arm_a_x, link.arm_a_y);
        arm(list.lever_b1[i], list.lever_b2[i], list.lever_b_t[i], link.arm_b_x, link.arm_b_y);
        contact_links_.push_back(link);
    }
    is_cut_calm_ = is_calm_;
    cut_.cut(contact_links_, bodies.count, is_calm_ ? kLongestPath : kLongestOfRestless);
    since_cut_ = 0, ++counters.cuts;
}

/// Rows at rest for the padding of each bundle and for what nothing moves, then the links of all contacts.
template <class Real>
void PathSolver<Real>::lay_out(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                               BodyRecords<Real>& records, const StepLoops<Real>& loops) {
    const Bodies<Real>& bodies = world.bodies;
    counters.bundles = static_cast<std::int64_t>(cut_.bundles());
    counters.links = static_cast<std::int64_t>(cut_.links());
    row_of_far_.resize(live_.size());
    first_still_row_ = records.rows();
    std::size_t row = first_still_row_ + cut_.bundles();
    for (std::size_t n = 0; n < live_.size(); ++n) {
        const std::int32_t partner = list_of(live_[n]).b[place_of(live_[n])];
        const auto b = static_cast<std::size_t>(partner);
        const bool b_moves = partner >= 0 && b < bodies.count && !bodies.is_immovable(b);
        row_of_far_[n] = b_moves ? partner : static_cast<std::int32_t>(row++);
    }
    records.add_still_rows(row - first_still_row_);
    links_.resize_for_overwrite(cut_.links());
    heads_.resize_for_overwrite(kPathLanes * cut_.bundles());
    const auto none = static_cast<Real>(kNoPoint);
    loops.executor->for_each_chunk(
        cut_.bundles(), kBundlesPerTask, kNanosecondsToFill * kPathLanes,
        [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t bundle = first; bundle < last; ++bundle) {
                const auto still = static_cast<std::int32_t>(first_still_row_ + bundle);
                std::fill_n(&heads_[kPathLanes * bundle], kPathLanes, still);
                for (std::size_t i = cut_.first_link()[bundle]; i < cut_.first_link()[bundle + 1]; ++i) {
                    PathLink<Real>& link = links_[i];
                    link = {};
                    std::fill_n(link.body, kPathLanes, still);
                    std::fill_n(link.separation1, kPathLanes, none);
                    std::fill_n(link.separation2, kPathLanes, none);
                }
            }
        });
    loops.executor->for_each_chunk(live_.size(), kContactsPerTask, kNanosecondsToFill,
                                   [&](std::size_t, std::size_t first, std::size_t last) {
                                       for (std::size_t n = first; n < last; ++n)
                                           fill_link(world, records, n);
                                   });
    for (std::size_t lane = 0; lane < kPathLanes * cut_.bundles(); ++lane) {
        const std::int32_t n = cut_.first_contacts()[lane];
        if (n < 0) continue;
        const auto number = static_cast<std::size_t>(n);
        const std::int32_t a = list_of(live_[number]).a[place_of(live_[number])];
        heads_[lane] = cut_.places()[number].is_reversed ? row_of_far_[number] : a;
    }
    for (std::size_t n = 0; n < live_.size(); ++n) {
        const Partner partner(list_of(live_[n]).b[place_of(live_[n])]);
        if (partner.stored() == row_of_far_[n] || partner.is_wall()) continue;
        const std::size_t b = partner.is_edge() ? edges.pose_of(world.edges[partner.edge_number()]).row
                                                : static_cast<std::size_t>(partner.row());
        if ((bodies.flags_of(b) & kKinematic) == 0) continue;
        Real* velocity = &records.velocity[4 * static_cast<std::size_t>(row_of_far_[n])];
        velocity[0] = bodies.velocity_x[b], velocity[1] = bodies.velocity_y[b];
        if (bodies.has_rotation)
            velocity[2] = bodies.angular_velocity[b] * (partner.is_edge() ? Real(1) : bodies.rim(b));
    }
    scratch_.resize(path_scratch_bytes(cut_.longest()) * std::size_t{16});
}

template <class Real>
void PathSolver<Real>::fill_link(const WorldState<Real>& world, const BodyRecords<Real>& records,
                                 std::size_t number) {
    const Bodies<Real>& bodies = world.bodies;
    ManifoldList<Real>& list = list_of(live_[number]);
    const std::size_t i = place_of(live_[number]);
    const typename PathCut::Place place = cut_.places()[number];
    PathLink<Real>& link = links_[place.link];
    const std::size_t lane = place.lane;
    const auto none = static_cast<Real>(kNoPoint);
    const auto row_a = static_cast<std::size_t>(list.a[i]);
    const Real rim_a = 1 / bodies.rim(row_a);
    const bool is_body = list.b[i] >= 0;
    // The rim of what is no body is 1 m.
    const Real rim_b = is_body ? 1 / bodies.rim(static_cast<std::size_t>(list.b[i])) : Real(1);
    Real a1 = list.lever_a1[i] * rim_a, a2 = list.lever_a2[i] * rim_a, at = list.lever_a_t[i] * rim_a;
    Real b1 = list.lever_b1[i] * rim_b, b2 = list.lever_b2[i] * rim_b, bt = list.lever_b_t[i] * rim_b;
    Real s1 = list.separation1[i], s2 = list.separation2[i];
    ManifoldMemory<Real>& memory = list.memory[i];
    if (!(memory.normal_x * list.normal_x[i] + memory.normal_y * list.normal_y[i] >
          static_cast<Real>(kSameNormal)))
        memory = {};
    memory.normal_x = list.normal_x[i], memory.normal_y = list.normal_y[i];
    // Two points that no impulse can tell apart are one: the deeper.
    const auto mass = [&](std::size_t row, Real& w, Real& w2) {
        const Real signed_mass = records.velocity[4 * row + 3];
        w = std::fabs(signed_mass), w2 = 2 * std::max(signed_mass, Real(0));
    };
    Real wa, wa2, wb = 0, wb2 = 0;
    mass(row_a, wa, wa2);
    if (row_of_far_[number] == list.b[i]) mass(static_cast<std::size_t>(list.b[i]), wb, wb2);
    if (s2 < none) {
        const Real w = wa + wb, k11 = w + wa2 * a1 * a1 + wb2 * b1 * b1,
                   k22 = w + wa2 * a2 * a2 + wb2 * b2 * b2, k12 = w + wa2 * a1 * a2 + wb2 * b1 * b2;
        if (k11 * k22 - k12 * k12 < static_cast<Real>(kLeastDeterminant) * (k11 * k22)) {
            if (s2 < s1) s1 = s2, a1 = a2, b1 = b2;
            s2 = none;
        }
    }
    if (!(s2 < none)) {
        a2 = a1, b2 = b1;
        memory.normal1 += memory.normal2, memory.normal2 = 0;
    }
    const bool back = place.is_reversed;
    link.body[lane] = back ? list.a[i] : row_of_far_[number];
    link.normal_x[lane] = back ? -list.normal_x[i] : list.normal_x[i];
    link.normal_y[lane] = back ? -list.normal_y[i] : list.normal_y[i];
    link.near1[lane] = back ? -b1 : a1, link.near2[lane] = back ? -b2 : a2,
    link.near_t[lane] = back ? -bt : at;
    link.far1[lane] = back ? -a1 : b1, link.far2[lane] = back ? -a2 : b2, link.far_t[lane] = back ? -at : bt;
    link.separation1[lane] = s1, link.separation2[lane] = s2;
    link.normal1[lane] = memory.normal1, link.normal2[lane] = memory.normal2;
    link.tangent[lane] = memory.tangent;
    link.friction[lane] = list.friction[i], link.thickness[lane] = list.thickness[i];
}

template <class Real>
SolvePaths<Real> PathSolver<Real>::arguments(const SubstepTerms& terms, BodyRecords<Real>& records) {
    SolvePaths<Real> k{};
    k.links = links_.data(), k.first_link = cut_.first_link().data(), k.heads = heads_.data();
    k.velocity = records.velocity.data(), k.displacement = records.displacement.data();
    k.turn = records.turn();
    k.h = static_cast<Real>(terms.substep_dt), k.inverse_h = static_cast<Real>(1 / terms.substep_dt);
    k.recovery = static_cast<Real>(kRecovery), k.push = static_cast<Real>(kPushThicknesses);
    k.velocity_tolerance = static_cast<Real>(kTolerance * terms.fall_speed());
    k.bold_iterations = kBoldIterations;
    k.most_iterations = is_cut_calm_ ? kMostIterations : kMostOfRestless;
    k.sweeps_of_unsettled = kSweepsOfUnsettled;
    return k;
}

/// Colour after colour; the bundles of a colour side by side.
template <class Real>
void PathSolver<Real>::run(Pass pass, SolvePaths<Real> arguments, const StepLoops<Real>& loops) {
    const std::size_t bytes = path_scratch_bytes(cut_.longest());
    for (std::size_t colour = 0; colour < cut_.colours(); ++colour) {
        const std::size_t first = cut_.first_bundle()[colour],
                          count = cut_.first_bundle()[colour + 1] - first;
        const std::size_t tasks = std::min<std::size_t>(16, (count + kBundlesPerTask - 1) / kBundlesPerTask);
        const std::size_t links = cut_.first_link()[first + count] - cut_.first_link()[first];
        std::array<std::size_t, 16> unsettled{};
        loops.executor->for_each_task(
            tasks, kNanosecondsToSolve * kPathLanes * static_cast<double>(links), [&](std::size_t task) {
                SolvePaths<Real> k = arguments;
                k.scratch = scratch_.data() + task * bytes;
                unsettled[task] =
                    pass(k, first + task * count / tasks, first + (task + 1) * count / tasks).unsettled;
            });
        for (const std::size_t more : unsettled) counters.unsettled += static_cast<std::int64_t>(more);
    }
}

template <class Real>
void PathSolver<Real>::warm_start(const SubstepTerms& terms, BodyRecords<Real>& records,
                                  const StepLoops<Real>& loops) {
    counters.unsettled = 0;
    if (!live_.empty()) run(loops.kernels->convex->paths.warm_start, arguments(terms, records), loops);
}

template <class Real>
void PathSolver<Real>::solve(const SubstepTerms& terms, BodyRecords<Real>& records,
                             const StepLoops<Real>& loops, int passes, bool sweeps) {
    if (live_.empty()) return;
    const PathKernels<Real>& kernels = loops.kernels->convex->paths;
    const SolvePaths<Real> k = arguments(terms, records);
    for (int pass = 0; pass < passes; ++pass) run(kernels.solve, k, loops);
    solved_ += static_cast<std::int64_t>(cut_.paths()) * passes;
    if (sweeps) run(kernels.sweep, k, loops);
}

template <class Real>
void PathSolver<Real>::advance(const SubstepTerms& terms, BodyRecords<Real>& records) {
    if (live_.empty()) return;
    const auto h = static_cast<Real>(terms.substep_dt);
    for (std::size_t row = first_still_row_; row < records.rows(); ++row) {
        const Real* velocity = &records.velocity[4 * row];
        records.displacement[2 * row] += h * velocity[0],
            records.displacement[2 * row + 1] += h * velocity[1];
        records.turn()[row] += h * velocity[2];
    }
}

template <class Real>
void PathSolver<Real>::end() {
    for (std::size_t n = 0; n < live_.size(); ++n) {
        const typename PathCut::Place place = cut_.places()[n];
        ManifoldMemory<Real>& memory = list_of(live_[n]).memory[place_of(live_[n])];
        const PathLink<Real>& link = links_[place.link];
        memory.normal1 = link.normal1[place.lane], memory.normal2 = link.normal2[place.lane];
        memory.tangent = link.tangent[place.lane];
    }
}

template <class Real>
std::size_t PathSolver<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return bodies_.bytes() + surfaces_.bytes() + old_.bytes() + old_surfaces_.bytes() +
           surface_finder_.bytes() + of(first_of_slot_) + of(next_of_slot_) + pose_.bytes() +
           pose_angle_.bytes() + of(live_) + of(was_live_) + of(row_of_far_) + of(contact_links_) +
           cut_.bytes() + links_.bytes() + heads_.bytes() + scratch_.bytes();
}

template class PathSolver<float>;
template class PathSolver<double>;

}  // namespace carom
