#include "solvers/manifolds/manifolds.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "effects/friction.hpp"
#include "effects/restitution.hpp"
#include "narrowphase/box_box.hpp"
#include "solvers/manifolds/finders/gaps.hpp"

namespace carom {
namespace {

// For the executor: ns a contact on one thread, and contacts of a task.
constexpr double kNanosecondsToFind = 10, kNanosecondsToList = 1, kNanosecondsToJudge = 3;
constexpr std::size_t kContactsPerTask = 256, kBlocksPerTask = kContactsPerTask / kRowPadding;

template <class Real>
bool moves(const Bodies<Real>& bodies, std::int32_t b) {
    const auto row = static_cast<std::size_t>(b);
    return row < bodies.count && !bodies.is_immovable(row);
}

}  // namespace

template <class Real>
bool Manifolds<Real>::can_touch(const WorldState<Real>& world, std::int32_t a, std::int32_t b) const {
    const Bodies<Real>& bodies = world.bodies;
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    if (bodies.is_disc(i) && bodies.is_disc(k)) return false;
    if (bodies.shape[i] < 0 || bodies.shape[k] < 0) return false;  // edges
    if (!moves(bodies, a) && !moves(bodies, b)) return false;
    return !world.has_filters() || world.may_collide(i, k);
}

template <class Real>
void Manifolds<Real>::list_pair(const WorldState<Real>& world, std::int32_t a, std::int32_t b) {
    if (a > b) std::swap(a, b);
    if (!moves(world.bodies, a)) std::swap(a, b);
    distant_.add(a, b);
}

template <class Real>
void Manifolds<Real>::add_pair(const WorldState<Real>& world, std::int32_t a, std::int32_t b) {
    const Bodies<Real>& bodies = world.bodies;
    const BodyId id_a = bodies.id[static_cast<std::size_t>(a)], id_b = bodies.id[static_cast<std::size_t>(b)];
    if (items_.empty()) return bodies_.add(a, b, {id_a, id_b, 0});
    items_.for_each(a, [&](std::int32_t item_a, std::int32_t piece_a) {
        items_.for_each(b, [&](std::int32_t item_b, std::int32_t piece_b) {
            bodies_.add(a, b, {id_a, id_b, ManifoldName::place_of_pieces(piece_a, piece_b)});
            bodies_.item_a.push_back(item_a), bodies_.item_b.push_back(item_b);
        });
    });
}

template <class Real>
bool Manifolds<Real>::are_boxes(const Bodies<Real>& bodies, std::int32_t a, std::int32_t b) const {
    const auto is_box = [&](std::int32_t row) {
        return is_box_of_[static_cast<std::size_t>(bodies.shape[static_cast<std::size_t>(row)])] != 0;
    };
    return is_box(a) && is_box(b);
}

template <class Real>
void Manifolds<Real>::renew(const WorldState<Real>& world, const Candidates<Real>& candidates,
                            const EdgeCandidates<Real>& edges, std::span<const SleeperPair> sleepers,
                            const Executor& executor) {
    live_.clear(), found_within_ = {};
    distant_.clear();
    surface_finder_.renew(world, edges);
    if (!world.bodies.has_shapes) return bodies_.clear(), surfaces_.clear();
    std::swap(bodies_, old_), bodies_.clear();
    // A contact that wakes has what it had when it fell asleep.
    if (world.bodies.asleep != asleep_then_)
        for (const KeptManifold<Real>& kept : asleep_)
            (kept.is_surface != 0 ? surfaces_ : old_).add_kept(kept);
    items_.list(world);
    const std::int32_t *pair_a = candidates.pair_a(), *pair_b = candidates.pair_b();
    chosen_pairs_.choose(candidates.pair_count(), kNanosecondsToJudge, executor,
                         [&](std::size_t p) { return can_touch(world, pair_a[p], pair_b[p]); });
    chosen_pairs_.for_each([&](std::int32_t number) {
        const auto p = static_cast<std::size_t>(number);
        list_pair(world, pair_a[p], pair_b[p]);
    });
    for (const SleeperPair& pair : sleepers)
        if (can_touch(world, pair.row, pair.sleeper)) list_pair(world, pair.row, pair.sleeper);
    poses_.begin_paths(), is_renewed_ = true;
}

template <class Real>
void Manifolds<Real>::take_near(const WorldState<Real>& world, double dt, const ContactDistance& near,
                                const StepLoops<Real>& loops) {
    const std::size_t before = bodies_.count();
    const bool is_crowd = kContactsOfBody * world.bodies.moving() >= kContactsOfSmallWorld;
    const auto taken =
        distant_.take_near(world, dt, is_crowd, poses_, near, *loops.kernels->convex, *loops.executor);
    read_shapes(world.shapes);
    // Boxes first: blocks of them alone have a quicker kernel.
    for (const bool boxes : {true, false})
        for (const auto& pair : taken)
            if (are_boxes(world.bodies, pair.a, pair.b) == boxes) add_pair(world, pair.a, pair.b);
    if (!taken.empty()) {
        bodies_.fit();
        find_box_blocks(world.bodies, before / kRowPadding);
        first_new_block_ = std::min(first_new_block_, before / kRowPadding);
    }
    if (!is_renewed_) return;
    is_renewed_ = false;
    recall(bodies_, old_, *loops.executor);
    if (world.bodies.asleep != asleep_then_) keep_of_sleepers(world);
    asleep_then_ = world.bodies.asleep;
}

template <class Real>
std::span<const LoadedContact> Manifolds<Real>::loaded() {
    loaded_.clear();
    for (const std::int32_t contact : live()) {
        const ManifoldList<Real>& list = list_of(contact);
        const std::size_t i = place_of(contact);
        if (list.memory[i].is_loaded())
            loaded_.push_back({list.a[i], Partner(list.b[i]),
                               static_cast<double>(list.memory[i].normal1 + list.memory[i].normal2)});
    }
    return loaded_;
}

template <class Real>
void Manifolds<Real>::read_shapes(const ShapeStore<Real>& shapes) {
    if (shapes_of_boxes_ == shapes.revision()) return;
    shapes_of_boxes_ = shapes.revision();
    ahead_.note_shapes(shapes);
    is_box_of_.resize(shapes.size());
    for (std::size_t shape = 0; shape < shapes.size(); ++shape)
        is_box_of_[shape] = is_box(shapes[static_cast<std::int32_t>(shape)]) &&
                            !shapes.is_piece(static_cast<std::int32_t>(shape));
}

template <class Real>
void Manifolds<Real>::find_box_blocks(const Bodies<Real>& bodies, std::size_t first) {
    blocks_are_boxes_.resize(padded(bodies_.count()) / kRowPadding);
    for (std::size_t block = first; block < blocks_are_boxes_.size(); ++block) {
        bool all = true;
        const std::size_t last = std::min(bodies_.count(), (block + 1) * kRowPadding);
        for (std::size_t i = block * kRowPadding; i < last; ++i)
            all = all && are_boxes(bodies, bodies_.a[i], bodies_.b[i]);
        blocks_are_boxes_[block] = all;
    }
}

template <class Real>
void Manifolds<Real>::add(const WorldState<Real>& world, const Candidates<Real>& candidates,
                          const EdgeCandidates<Real>& edges) {
    if (!world.bodies.has_shapes) return;
    surface_finder_.add(world, edges);
    for (const auto& pair : candidates.new_pairs())
        if (can_touch(world, pair.a, pair.b)) list_pair(world, pair.a, pair.b);
}

template <class Real>
void Manifolds<Real>::rescale(double factor) {
    if (factor == 1) return;
    const auto kept = static_cast<Real>(factor);
    for (ManifoldList<Real>* list : {&bodies_, &surfaces_})
        for (ManifoldMemory<Real>& memory : list->memory) memory.rescale(kept);
    for (KeptManifold<Real>& kept_manifold : asleep_) kept_manifold.memory.rescale(kept);
}

template <class Real>
bool Manifolds<Real>::must_find(std::size_t block) const {
    if (block >= first_new_block_) return true;
    if (block < is_changed_block_.size() && is_changed_block_[block] != 0) return true;
    const std::size_t last = std::min(bodies_.count(), (block + 1) * kRowPadding);
    unsigned moved = 0;  // without a branch for each, as most blocks have to be looked at whole
    for (std::size_t i = block * kRowPadding; i < last; ++i)
        moved |= unsigned{poses_.has_moved(bodies_.a[i])} | unsigned{poses_.has_moved(bodies_.b[i])};
    return moved != 0;
}

template <class Real>
void Manifolds<Real>::note_thicknesses(std::size_t first) {
    for (std::size_t i = first; i < bodies_.count(); ++i)
        for (const std::int32_t row : {bodies_.a[i], bodies_.b[i]})
            poses_.note_thickness(row, bodies_.thickness[i]);
}

template <class Real>
bool Manifolds<Real>::find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                           const SubstepTerms& terms, const ContactDistance& near,
                           const StepLoops<Real>& loops) {
    std::swap(surfaces_, old_surfaces_);
    if (is_idle(world)) {
        surfaces_.clear(), live_.clear();
        return true;
    }
    const Within within{near.share, near.fall, terms.dt};
    const bool finds_all = !(found_within_ == within);
    if (finds_all) first_new_block_ = 0;
    found_within_ = within;
    poses_.look(world, terms.dt, near, finds_all, *loops.kernels->convex, *loops.executor);
    take_near(world, terms.dt, near, loops);
    choose_blocks(*loops.executor);
    flights_.clear();
    flights_.hold_what_pressed(world, edges, items_, poses_, terms.dt, bodies_, old_surfaces_);
    flights_.settle(world.bodies, terms.dt);
    ahead_.look(world, terms.dt, poses_, flights_, items_, rows_to_find(world), *loops.executor);
    ahead_.look_at_surfaces(world, terms, old_surfaces_);
    surface_finder_.find({world, edges, terms, near, poses_, flights_, ahead_.on_surfaces(), old_surfaces_},
                         surfaces_, *loops.executor);
    recall_surfaces();
    ahead_.resize_places(bodies_.count());
    const auto for_each_found_block = [&](double nanoseconds, const auto& fn) {
        loops.executor->for_each_chunk(found_blocks_.size(), kBlocksPerTask, kRowPadding * nanoseconds,
                                       [&](std::size_t, std::size_t first, std::size_t last) {
                                           for (std::size_t n = first; n < last; ++n) fn(found_blocks_[n]);
                                       });
    };
    for_each_found_block(kNanosecondsToFind, [&](std::size_t block) {
        const std::size_t first = block * kRowPadding;
        describe_pairs(world, near, first, std::min(bodies_.count(), first + kRowPadding));
        find_pairs(world, terms, *loops.kernels->convex, block);
    });
    Gaps<Real> gaps({world, items_, poses_, flights_, near, terms.dt, *loops.kernels->convex}, bodies_);
    find_flights(gaps, world, terms.dt, *loops.executor);
    live_.begin(block_is_found_.size());
    for_each_found_block(kNanosecondsToJudge, [&](std::size_t block) {
        const std::size_t first = block * kRowPadding;
        gaps.look_at(first, std::min(bodies_.count(), first + kRowPadding));
        note_live(block);
    });
    note_thicknesses(std::min(bodies_.count(), first_new_block_ * kRowPadding));
    surface_finder_.for_each_near_edges([&](std::size_t row) {
        if (!world.shapes.is_compound(world.bodies.shape[row]))
            poses_.note_thickness(static_cast<std::int32_t>(row), world.bodies.inradius(row));
    });
    first_new_block_ = block_is_found_.size();
    const auto none = static_cast<Real>(kNoPoint);
    const auto is_live = [&](std::size_t i) {
        const bool can_touch = surfaces_.separation1[i] < none;
        if (!can_touch) surfaces_.memory[i] = {};
        return can_touch;
    };
    const bool is_same = live_.list(found_blocks_, surfaces_.count(), is_live,
                                    [&](std::size_t i) { return surface_finder_.carried_from(i) < 0; });
    return is_same && surface_finder_.keep_numbers() &&
           std::equal(surfaces_.a.begin(), surfaces_.a.end(), old_surfaces_.a.begin(), old_surfaces_.a.end());
}

/// Which contacts of a block could touch when it was found last, a bit each; all where that is not known.
/// Others carry nothing.
template <class Real>
std::uint32_t Manifolds<Real>::live_then(std::size_t block) const {
    return block < first_new_block_ ? live_.mask(block) : 0xffffu;
}

template <class Real>
void Manifolds<Real>::note_live(std::size_t block) {
    const auto none = static_cast<Real>(kNoPoint);
    std::uint32_t mask = 0;
    const std::size_t first = block * kRowPadding, last = std::min(bodies_.count(), first + kRowPadding);
    for (std::size_t i = first; i < last; ++i)
        mask |= std::uint32_t{bodies_.separation1[i] < none} << (i - first);
    for (std::uint32_t gone = live_then(block) & ~mask; gone != 0; gone &= gone - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(gone));
        if (i < last) bodies_.memory[i] = {};
    }
    live_.set(block, static_cast<std::uint16_t>(mask));
}

/// The blocks that must be found in this step.
template <class Real>
void Manifolds<Real>::choose_blocks(const Executor& executor) {
    block_is_found_.resize(padded(bodies_.count()) / kRowPadding);
    executor.for_each_chunk(block_is_found_.size(), kBlocksPerTask, kRowPadding * kNanosecondsToList,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t block = first; block < last; ++block)
                                    block_is_found_[block] = must_find(block);
                            });
    is_changed_block_.clear();
    found_blocks_.clear();
    for (std::size_t block = 0; block < block_is_found_.size(); ++block)
        if (block_is_found_[block] != 0) found_blocks_.push_back(static_cast<std::uint32_t>(block));
}

/// The rows whose contacts are found in this step, if they are few, each once; else nothing: all are.
template <class Real>
std::optional<std::span<const std::int32_t>> Manifolds<Real>::rows_to_find(const WorldState<Real>& world) {
    // A row is in several blocks.
    constexpr double kFew = 0.25;
    if (!items_.empty() ||
        static_cast<double>(found_blocks_.size()) > kFew * static_cast<double>(block_is_found_.size()))
        return std::nullopt;
    rows_.clear(), is_listed_.assign(world.bodies.rows(), 0);
    const auto list = [&](std::size_t row) {
        if (std::exchange(is_listed_[row], 1) == 0) rows_.push_back(static_cast<std::int32_t>(row));
    };
    for (const std::size_t block : found_blocks_) {
        const std::size_t first = block * kRowPadding, last = std::min(bodies_.count(), first + kRowPadding);
        for (std::size_t i = first; i < last; ++i)
            list(static_cast<std::size_t>(bodies_.a[i])), list(static_cast<std::size_t>(bodies_.b[i]));
    }
    for (const ManifoldName& name : old_surfaces_.names)
        if (world.handles.is_alive(name.a)) list(world.handles.row_of_slot(name.a.index));
    // Padding of a list of contacts names the bodies of its first one.
    if (bodies_.count() > 0)
        list(static_cast<std::size_t>(bodies_.a[0])), list(static_cast<std::size_t>(bodies_.b[0]));
    return rows_;
}

template <class Real>
void Manifolds<Real>::find_flights(const Gaps<Real>& gaps, const WorldState<Real>& world, double dt,
                                   const Executor& executor) {
    const auto none = static_cast<Real>(kNoPoint);
    const auto contact_of = [&](std::size_t n) {
        return kRowPadding * found_blocks_[n / kRowPadding] + n % kRowPadding;
    };
    const std::size_t blocks = world.immovable_rows.empty() ? 0 : found_blocks_.size();  // nothing holds
    holding_.choose(kRowPadding * blocks, kNanosecondsToList, executor, [&](std::size_t n) {
        const std::size_t i = contact_of(n);
        return i < bodies_.count() && bodies_.separation1[i] < none && gaps.holds(i);
    });
    const auto hold = [&](const ManifoldList<Real>& list, std::size_t i) {
        flights_.hold(static_cast<std::size_t>(list.a[i]), {list.normal_x[i], list.normal_y[i]},
                      std::min(list.separation1[i], list.separation2[i]));
    };
    holding_.for_each([&](std::int32_t n) { hold(bodies_, contact_of(static_cast<std::size_t>(n))); });
    const Bodies<Real>& bodies = world.bodies;
    for (std::size_t i = 0; i < surfaces_.count(); ++i) {
        const auto row = static_cast<std::size_t>(surfaces_.a[i]);
        const BodyId of_edge = surfaces_.names[i].b;
        if (of_edge == BodyId{} || !bodies.stands(world.handles.row_of_slot(of_edge.index))) continue;
        if (HeldFlights<Real>::comes_into({bodies.velocity_x[row], bodies.velocity_y[row]},
                                          {surfaces_.normal_x[i], surfaces_.normal_y[i]},
                                          std::min(surfaces_.separation1[i], surfaces_.separation2[i]),
                                          surfaces_.thickness[i], dt))
            hold(surfaces_, i);
    }
    flights_.settle(bodies, dt);
}

/// Coefficients, and how near is near enough: what both fly in the step, wherever to, and some more.
template <class Real>
void Manifolds<Real>::describe_pairs(const WorldState<Real>& world, const ContactDistance& near,
                                     std::size_t first, std::size_t last) {
    const Bodies<Real>& bodies = world.bodies;
    const bool friction_varies = !bodies.friction.is_uniform();
    for (std::size_t i = first; i < last; ++i) {
        const auto a = static_cast<std::size_t>(bodies_.a[i]), b = static_cast<std::size_t>(bodies_.b[i]);
        bodies_.thickness[i] = pair_thickness(bodies, a, b);
        bodies_.margin[i] = static_cast<Real>(near(static_cast<double>(bodies_.thickness[i]))) +
                            poses_.way(a) + poses_.way(b);
        bodies_.restitution[i] =
            static_cast<Real>(pair_restitution(bodies.restitution[a], bodies.restitution[b]));
        bodies_.friction[i] = friction_varies
                                  ? static_cast<Real>(pair_friction(bodies.friction[a], bodies.friction[b]))
                                  : bodies.friction[a];
        if (!items_.empty() && (bodies_.item_a[i] != bodies_.a[i] || bodies_.item_b[i] != bodies_.b[i]))
            describe_pieces(world, near, i);
    }
}

/// What differs where one of the two is a piece.
template <class Real>
void Manifolds<Real>::describe_pieces(const WorldState<Real>& world, const ContactDistance& near,
                                      std::size_t i) {
    const Bodies<Real>& bodies = world.bodies;
    const std::int32_t a = bodies_.a[i], b = bodies_.b[i];
    const StoredPiece *of_a = items_.piece_of(world, a, bodies_.item_a[i]),
                      *of_b = items_.piece_of(world, b, bodies_.item_b[i]);
    struct Side {
        Real thickness;
        double friction, restitution;
    };
    const auto side = [&](std::int32_t number, const StoredPiece* piece) -> Side {
        const auto row = static_cast<std::size_t>(number);
        if (!piece) return {bodies.inradius(row), bodies.friction[row], bodies.restitution[row]};
        return {world.shapes[piece->number].inradius, piece->material.friction, piece->material.restitution};
    };
    const Side at_a = side(a, of_a), at_b = side(b, of_b);
    const auto row_b = static_cast<std::size_t>(b);
    const bool b_moves = row_b < bodies.count && !bodies.is_immovable(row_b);
    const Real before = bodies_.thickness[i];
    bodies_.thickness[i] = b_moves ? std::min(at_a.thickness, at_b.thickness) : at_a.thickness;
    bodies_.margin[i] += static_cast<Real>(near(static_cast<double>(bodies_.thickness[i])) -
                                           near(static_cast<double>(before)));
    bodies_.friction[i] = static_cast<Real>(pair_friction(at_a.friction, at_b.friction));
    bodies_.restitution[i] = static_cast<Real>(pair_restitution(at_a.restitution, at_b.restitution));
}

template <class Real>
void Manifolds<Real>::find_pairs(const WorldState<Real>& world, const SubstepTerms& terms,
                                 const ConvexKernels<Real>& kernels, std::size_t block) {
    const bool all_rows = items_.empty();
    const bool has_ahead = !ahead_.empty();  // it has the poses of pieces, too
    const FindManifolds<Real> now{has_ahead ? ahead_.pose.data() : poses_.pose.data(),
                                  nullptr,
                                  has_ahead ? ahead_.shape.data() : world.bodies.shape.data(),
                                  world.shapes.data(),
                                  all_rows ? bodies_.a.data() : bodies_.item_a.data(),
                                  all_rows ? bodies_.b.data() : bodies_.item_b.data(),
                                  bodies_.margin.data(),
                                  bodies_.columns()};
    FindManifolds<Real> ahead = now;
    ahead.come = ahead_.come.data(), ahead.a = ahead_.a.data(), ahead.b = ahead_.b.data();
    const std::size_t first = block * kRowPadding;
    const auto find = blocks_are_boxes_[block] != 0 ? kernels.find_box_manifolds : kernels.find_manifolds;
    const bool are_ahead = ahead_.place(world, terms, bodies_, live_then(block), first);
    find(are_ahead ? ahead : now, first, first + kRowPadding);
}

template <class Real>
std::size_t Manifolds<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return bodies_.bytes() + surfaces_.bytes() + old_.bytes() + old_surfaces_.bytes() +
           surface_finder_.bytes() + items_.bytes() + distant_.bytes() + of(asleep_) + of(is_recalled_) +
           of(loaded_) + of(is_box_of_) + of(blocks_are_boxes_) + index_.bytes() + poses_.bytes() +
           ahead_.bytes() + flights_.bytes() + of(block_is_found_) + of(found_blocks_) + of(rows_) +
           of(is_listed_) + live_.bytes() + chosen_pairs_.bytes();
}

template class Manifolds<float>;
template class Manifolds<double>;

}  // namespace carom
