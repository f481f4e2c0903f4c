#include <algorithm>

#include "solvers/manifolds/manifolds.hpp"

// What contacts keep where rows change, pairs are found anew or bodies fall asleep.

namespace carom {
namespace {

// For the executor: ns a contact on one thread, and contacts of a task.
constexpr double kNanosecondsToRecall = 5;
constexpr std::size_t kContactsPerTask = 256;

}  // namespace

/// Keeps what no contact has recalled, if it is of a body that sleeps. Called before surfaces are found anew.
template <class Real>
void Manifolds<Real>::keep_of_sleepers(const WorldState<Real>& world) {
    asleep_.clear();
    const auto sleeps = [&](BodyId id) {
        return world.handles.is_alive(id) && world.handles.row_of_slot(id.index) >= world.bodies.count;
    };
    for (std::size_t i = 0; i < old_.count(); ++i)
        if (!is_recalled_[i] && old_.memory[i].is_loaded() &&
            (sleeps(old_.names[i].a) || sleeps(old_.names[i].b)))
            asleep_.push_back({old_.names[i], 0, old_.memory[i], old_.friction[i]});
    const ManifoldList<Real>& then = old_surfaces_;
    for (std::size_t i = 0; i < then.count(); ++i)
        if (then.memory[i].is_loaded() && sleeps(then.names[i].a))
            asleep_.push_back({then.names[i], 1, then.memory[i], then.friction[i]});
}

template <class Real>
void Manifolds<Real>::follow_rows(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                  std::span<const std::int32_t> now,
                                  std::span<const std::uint8_t> is_elsewhere) {
    if (!world.bodies.has_shapes) return;
    const auto row_now = [&](std::int32_t row) {
        const std::int32_t present = now[static_cast<std::size_t>(row)];
        return present < 0 || is_elsewhere[static_cast<std::size_t>(present)] != 0 ? -1 : present;
    };
    items_.list(world);
    surface_finder_.renew(world, edges);
    distant_.follow_rows(row_now);
    poses_.follow_rows(world.bodies, now, is_elsewhere);
    live_.note_new_rows();
    is_changed_block_.assign(padded(bodies_.count()) / kRowPadding, 0);
    for (std::size_t i = 0; i < bodies_.count();) {
        const std::int32_t a = row_now(bodies_.a[i]), b = row_now(bodies_.b[i]);
        if (a >= 0 && b >= 0) {
            bodies_.a[i] = a, bodies_.b[i] = b;
            if (!items_.empty()) {
                bodies_.item_a[i] = items_.item_of(a, ManifoldName::piece_of_a(bodies_.names[i].place));
                bodies_.item_b[i] = items_.item_of(b, ManifoldName::piece_of_b(bodies_.names[i].place));
            }
            ++i;
            continue;
        }
        const std::size_t last = bodies_.count() - 1;
        is_changed_block_[i / kRowPadding] = is_changed_block_[last / kRowPadding] = 1;
        live_.move(last, i);
        bodies_.remove(i);
    }
    bodies_.fit();
    first_new_block_ = std::min(first_new_block_, padded(bodies_.count()) / kRowPadding);
    read_shapes(world.shapes);
    find_box_blocks(world.bodies, 0);
}

/// Gives the contacts of a list what those of the same name had in the old one.
template <class Real>
void Manifolds<Real>::recall(ManifoldList<Real>& list, const ManifoldList<Real>& old,
                             const Executor& executor) {
    list.fit();
    index_.file(old);
    is_recalled_.assign(old.count(), 0);
    const auto recall_one = [&](std::size_t i) {
        const ManifoldName &name = list.names[i], reversed = name.reversed();
        index_.for_each_like(name, [&](std::size_t n) {
            const bool is_same = old.names[n] == name;
            if (!is_same && !(old.names[n] == reversed)) return;
            list.memory[i] = is_same ? old.memory[n] : old.memory[n].reversed(), is_recalled_[n] = 1;
        });
    };
    executor.for_each_chunk(list.count(), kContactsPerTask, kNanosecondsToRecall,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t i = first; i < last; ++i) recall_one(i);
                            });
}

/// A body may touch a chain in several places: each takes what the one before it had that faced the same way.
/// What is carried on has its memory already.
template <class Real>
void Manifolds<Real>::recall_surfaces() {
    index_.file(old_surfaces_);
    is_recalled_.assign(old_surfaces_.count(), 0);
    const auto carried_from = [&](std::size_t i) { return surface_finder_.carried_from(i); };
    for (std::size_t i = 0; i < surfaces_.count(); ++i)
        if (carried_from(i) >= 0) is_recalled_[static_cast<std::size_t>(carried_from(i))] = 1;
    for (std::size_t i = 0; i < surfaces_.count(); ++i) {
        if (carried_from(i) >= 0) continue;
        const ManifoldName& name = surfaces_.names[i];
        std::size_t best = old_surfaces_.count();
        Real most = static_cast<Real>(kSameNormal);
        index_.for_each_like(name, [&](std::size_t k) {
            if (is_recalled_[k] || !(old_surfaces_.names[k] == name)) return;
            const ManifoldMemory<Real>& memory = old_surfaces_.memory[k];
            const Real alike =
                memory.normal_x * surfaces_.normal_x[i] + memory.normal_y * surfaces_.normal_y[i];
            if (alike > most) best = k, most = alike;
        });
        if (best == old_surfaces_.count()) continue;
        is_recalled_[best] = 1, surfaces_.memory[i] = old_surfaces_.memory[best];
    }
}

template class Manifolds<float>;
template class Manifolds<double>;

}  // namespace carom
