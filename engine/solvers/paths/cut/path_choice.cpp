#include "solvers/paths/cut/path_choice.hpp"

#include <cstdint>
#include <utility>

namespace carom {
namespace {

/// Contacts in a path, by PathMood; what is longer is cut. While many paths do not settle they are kept
/// short: a long one that fails has done more in vain.
constexpr std::size_t kLongest[] = {128, 16, 12};
/// Share of paths that do not settle, below which paths are calm and above which they are restless.
constexpr double kCalm = 0.001, kRestless = 0.01;
/// Share of contacts that come or go in a step, above which paths are wild and below which no longer.
constexpr double kWild = 0.005, kTame = 0.002;
/// Paths are cut anew after so many steps, since loads have changed.
constexpr int kStepsOfCut = 30;
/// Wild ones of many contacts are kept for so many, whatever contacts come and go: what comes stands beside
/// them. docs/decisions/0043-contacts-beside-paths.md has the measurements.
constexpr int kStepsOfWildCut = 4;
/// Others of many contacts are kept for kStepsOfCut, too, while no larger share of the contacts than this
/// stands beside them. docs/decisions/0083-cuts-that-are-kept.md.
constexpr double kMostBeside = 0.003;
/// In crowds of mechanisms more may: their limbs swing on, and paths are no worse for it.
/// docs/decisions/0090-crowds-of-mechanisms.md.
constexpr double kMostBesideOfCrowd = 0.01;

template <class Real>
bool is_nothing(const Bodies<Real>& bodies, std::int32_t b) {
    const auto row = static_cast<std::size_t>(b);
    return b < 0 || row >= bodies.count || bodies.is_immovable(row);
}

/// Whether a contact of two bodies carries nothing and, if both go on as they fly, does not close in the
/// step.
template <class Real>
bool stays_apart(const WorldState<Real>& world, const Manifolds<Real>& manifolds, std::int32_t contact,
                 double dt) {
    const Bodies<Real>& bodies = world.bodies;
    if (contact < 0) return false;
    const ManifoldList<Real>& list = manifolds.list_of(contact);
    const std::size_t i = Manifolds<Real>::place_of(contact);
    const ManifoldMemory<Real>& memory = list.memory[i];
    if (memory.is_loaded()) return false;
    const auto a = static_cast<std::size_t>(list.a[i]), b = static_cast<std::size_t>(list.b[i]);
    const auto spin = [&](std::size_t row) {
        return bodies.has_rotation ? bodies.angular_velocity[row] : Real(0);
    };
    const Real vn = (bodies.velocity_x[b] - bodies.velocity_x[a]) * list.normal_x[i] +
                    (bodies.velocity_y[b] - bodies.velocity_y[a]) * list.normal_y[i];
    const bool is_found = manifolds.is_found(contact);
    const auto is_far = [&](Real found, Real carried, Real lever_a, Real lever_b) {
        const Real separation = is_found ? found : carried;
        return separation > 0 &&
               separation + static_cast<Real>(dt) * (vn + spin(b) * lever_b - spin(a) * lever_a) > 0;
    };
    return is_far(list.separation1[i], memory.separation1, list.lever_a1[i], list.lever_b1[i]) &&
           is_far(list.separation2[i], memory.separation2, list.lever_a2[i], list.lever_b2[i]);
}

}  // namespace

template <class Real>
typename PathChoice<Real>::Change PathChoice<Real>::choose(const WorldState<Real>& world,
                                                           Manifolds<Real>& manifolds, double dt,
                                                           bool is_same, std::int64_t unsettled,
                                                           TurnRows& turns, bool is_of_crowd,
                                                           const Executor& executor) {
    judge_mood(manifolds, unsettled);
    ++since_cut_;
    const bool is_wild = is_wild_crowd(manifolds);
    if (mood_of_cut_ == mood_ && since_cut_ < (is_wild ? kStepsOfWildCut : kStepsOfCut)) {
        if (is_same && !is_wild) return Change::none;
        if (manifolds.is_crowd() && !is_cut_forgotten_ &&
            keep_paths(world, manifolds, turns,
                       is_wild       ? 1
                       : is_of_crowd ? kMostBesideOfCrowd
                                     : kMostBeside))
            return Change::contacts;
    }
    cut_paths(world, manifolds, dt, turns, executor);
    return Change::paths;
}

/// Whether there are contacts that come and go among so many that their paths are kept meanwhile.
template <class Real>
bool PathChoice<Real>::is_wild_crowd(const Manifolds<Real>& manifolds) const {
    return mood_ == PathMood::wild && manifolds.is_crowd();
}

/// Judges by the last step whether paths settle, and by this one whether contacts come and go.
template <class Real>
void PathChoice<Real>::judge_mood(const Manifolds<Real>& manifolds, std::int64_t unsettled) {
    const double share = solved_ > 0 ? static_cast<double>(unsettled) / static_cast<double>(solved_) : 0;
    const bool was_solved = std::exchange(solved_, 0) > 0;
    const double changed = manifolds.changed_share();
    if (changed > (mood_ == PathMood::wild ? kTame : kWild) || (changed < 0 && mood_ == PathMood::wild))
        mood_ = PathMood::wild;
    else if (!was_solved)
        // Small worlds have long paths from the start; others short ones, as heaps do that still settle.
        mood_ = manifolds.is_crowd() ? PathMood::restless : PathMood::calm;
    else
        mood_ = share < (mood_ == PathMood::calm ? kRestless : kCalm) ? PathMood::calm : PathMood::restless;
}

template <class Real>
void PathChoice<Real>::cut_paths(const WorldState<Real>& world, Manifolds<Real>& manifolds, double dt,
                                 TurnRows& turns, const Executor& executor) {
    const bool is_wild = is_wild_crowd(manifolds);
    const Bodies<Real>& bodies = world.bodies;
    contact_links_.clear();
    for (const std::int32_t contact : manifolds.live()) {
        const ManifoldList<Real>& list = manifolds.list_of(contact);
        const std::size_t i = Manifolds<Real>::place_of(contact);
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
        if (is_nothing(bodies, link.b)) link.b = ContactLink::kNothing;
        arm(list.lever_a1[i], list.lever_a2[i], list.lever_a_t[i], link.arm_a_x, link.arm_a_y);
        arm(list.lever_b1[i], list.lever_b2[i], list.lever_b_t[i], link.arm_b_x, link.arm_b_y);
        link.is_watched = is_wild && stays_apart(world, manifolds, contact, dt);
        contact_links_.push_back(link);
    }
    turns.mark(contact_links_);
    mood_of_cut_ = mood_;
    cut_.cut(contact_links_, bodies.moving(), kLongest[static_cast<std::size_t>(mood_)], executor);
    since_cut_ = 0;
    is_cut_forgotten_ = !manifolds.is_crowd();  // then no contact knows its place
    if (is_cut_forgotten_) return;
    for (std::size_t n = 0; n < contact_links_.size(); ++n) {
        const PathCut::Slot slot = cut_.slot_of(n);
        ManifoldMemory<Real>& memory = manifolds.memory_of(manifolds.live()[n]);
        memory.slot = slot.number;
        memory.slot_kind = (slot.is_reversed ? kTurnedSlot : 0) |
                           (contact_links_[n].b == ContactLink::kNothing ? kStillSlot : 0);
    }
}

/// Contacts stay where the last cut has put them. Those that have come, and those with a body that has begun
/// to move or to stand since, so that it may be in two paths of a colour, stand beside the paths.
/// @param most  share of the contacts that may stand beside
/// @return whether no more do; if not, the cut is that of another step
template <class Real>
bool PathChoice<Real>::keep_paths(const WorldState<Real>& world, Manifolds<Real>& manifolds,
                                  const TurnRows& turns, double most) {
    slots_.clear();
    std::size_t beside = 0;
    for (const std::int32_t contact : manifolds.live()) {
        ManifoldMemory<Real>& memory = manifolds.memory_of(contact);
        const ManifoldList<Real>& list = manifolds.list_of(contact);
        const std::size_t i = Manifolds<Real>::place_of(contact);
        const std::int32_t a = list.a[i], b = list.b[i];
        if (is_nothing(world.bodies, b) != ((memory.slot_kind & kStillSlot) != 0)) memory.slot = -1;
        slots_.push_back(
            {memory.slot, (memory.slot_kind & kTurnedSlot) != 0, turns.is_near(a) || turns.is_near(b)});
        beside += memory.slot < 0 ? 1 : 0;
    }
    if (static_cast<double>(beside) > most * static_cast<double>(slots_.size())) return false;
    cut_.keep(slots_);
    return true;
}

template <class Real>
std::size_t PathChoice<Real>::bytes() const {
    return cut_.bytes() + contact_links_.capacity() * sizeof(ContactLink) +
           slots_.capacity() * sizeof(PathCut::Slot);
}

template class PathChoice<float>;
template class PathChoice<double>;

}  // namespace carom
