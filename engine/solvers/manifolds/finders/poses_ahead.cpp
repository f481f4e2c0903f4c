#include "solvers/manifolds/finders/poses_ahead.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace carom {
namespace {

/// A body that comes by more than this share of its thinnest contact in a step is not looked for at its end:
/// what flies into another one would be seen so deep in it that another side of it is nearer.
constexpr double kLeadShare = 0.1;
/// Nor is one looked for in the middle that comes by more than this share.
constexpr double kLeadShareOfRound = 1;
/// A contact whose load alone would move the lighter body by more than this in a step, in thicknesses, is not
/// looked for ahead.
constexpr double kLargestWayOfLoad = 0.25;

constexpr std::array kLeads{Lead::none, Lead::half, Lead::whole};

constexpr std::size_t kRowsPerTaskAhead = 1024;  // some microseconds of work
constexpr double kNanosecondsToLookAhead = 3;    // a row, on one thread, for the executor

/// Whether some contact may have no friction. Pieces have materials of their own, which are not looked at.
template <class Real>
bool may_be_smooth(const WorldState<Real>& world, const PieceItems<Real>& pieces) {
    const auto is_smooth = [](double friction) { return !(friction > 0); };
    const auto& friction = world.bodies.friction;
    if (!pieces.empty() || (world.walls && is_smooth(world.walls->material.friction))) return true;
    if (friction.is_uniform()) return is_smooth(friction.uniform_value());
    return std::any_of(friction.column().begin(), friction.column().end(), is_smooth);
}

/// How far ahead a contact is looked for if its bodies are not too fast. What does not press is looked for
/// where it is, as it may be an impact; and so is what would swing faster than steps can follow, whose
/// velocity is noise.
/// @param is_round   whether one of the two has a rounding, as discs and capsules have
/// @param friction   coefficient of the contact
/// @param thickness  m, of the contact
/// @param mass       kg, of the lighter body
template <class Real>
Lead lead_of(const ManifoldMemory<Real>& memory, bool is_round, Real friction, Real thickness, Real mass,
             const SubstepTerms& terms) {
    if (friction > 0 && !is_round) return Lead::none;
    const Real load = memory.normal1 + memory.normal2;
    const auto way = static_cast<Real>(terms.dt * terms.dt / terms.substep_dt) * load;  // kg m
    if (!(load > 0) || !(way < static_cast<Real>(kLargestWayOfLoad) * thickness * mass)) return Lead::none;
    return friction > 0 ? Lead::half : Lead::whole;
}

}  // namespace

template <class Real>
void PosesAhead<Real>::note_shapes(const ShapeStore<Real>& shapes) {
    is_round_.resize(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i)
        is_round_[i] = shapes[static_cast<std::int32_t>(i)].radius > 0;
    some_are_round_ = std::find(is_round_.begin(), is_round_.end(), 1) != is_round_.end();
}

template <class Real>
void PosesAhead<Real>::look(const WorldState<Real>& world, double dt, const PoseWatch<Real>& now,
                            const HeldFlights<Real>& flights, const PieceItems<Real>& pieces,
                            std::optional<std::span<const std::int32_t>> asked, const Executor& executor) {
    some_are_smooth_ = may_be_smooth(world, pieces);
    items_ = 0;
    const std::size_t rows = world.bodies.rows();
    const Layout written = std::exchange(written_, {});
    if (!some_are_smooth_ && !some_are_round_) return;
    items_ = rows + pieces.count();
    written_ = {rows, items_, is_used(Lead::half), is_used(Lead::whole)};
    pose.resize(12 * items_), come.resize(12 * items_), shape.resize(3 * items_);
    // What stands or sleeps is where it was.
    const bool others_stay = written == written_ && now.rows_looked_at() < rows;
    const std::size_t all = others_stay ? now.rows_looked_at() : rows;
    if (asked && !others_stay) written_ = {};
    executor.for_each_chunk(asked ? asked->size() : all, kRowsPerTaskAhead, kNanosecondsToLookAhead,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                const auto h = static_cast<Real>(dt);
                                if (!asked) return look_at(world.bodies, h, now, first, last);
                                for (std::size_t n = first; n < last; ++n) {
                                    const auto row = static_cast<std::size_t>((*asked)[n]);
                                    look_at(world.bodies, h, now, row, row + 1);
                                }
                            });
    flights.for_each([&](std::size_t row, Vec2 velocity) { hold(row, velocity); });
    pieces.for_each_piece([&](std::size_t item, std::size_t row, std::int32_t number) {
        for (const Lead lead : kLeads) {
            if (!is_used(lead)) continue;
            const std::size_t to = place_of(item, lead), from = place_of(row, lead);
            std::copy_n(&pose[4 * from], 4, &pose[4 * to]), std::copy_n(&come[4 * from], 4, &come[4 * to]);
            shape[to] = number;
        }
    });
}

/// Writes the places of some rows.
template <class Real>
void PosesAhead<Real>::look_at(const Bodies<Real>& bodies, Real dt, const PoseWatch<Real>& now,
                               std::size_t first, std::size_t last) {
    for (const Lead lead : kLeads) {
        if (!is_used(lead)) continue;
        std::copy_n(&now.pose[4 * first], 4 * (last - first), &pose[4 * place_of(first, lead)]);
        std::fill_n(&come[4 * place_of(first, lead)], 4 * (last - first), Real(0));
        std::copy_n(&bodies.shape[first], last - first, &shape[place_of(first, lead)]);
    }
    const auto round = static_cast<Real>(some_are_round_ ? kLeadShareOfRound : 0),
               smooth = static_cast<Real>(some_are_smooth_ ? kLeadShare : 0);
    for (std::size_t row = first; row < last; ++row) {
        const Real way = now.way(row), thinnest = std::min(bodies.inradius(row), now.thinnest(row));  // m
        if (!(way > 0)) continue;  // what nothing moves may have a velocity all the same
        if (way <= round * thinnest) move(bodies, row, Lead::half, Real(0.5) * dt);
        if (way <= smooth * thinnest) move(bodies, row, Lead::whole, dt);
    }
}

/// @param ahead  s
template <class Real>
void PosesAhead<Real>::move(const Bodies<Real>& bodies, std::size_t row, Lead lead, Real ahead) {
    Real *to = &pose[4 * place_of(row, lead)], *way = &come[4 * place_of(row, lead)];
    way[0] = ahead * bodies.velocity_x[row], way[1] = ahead * bodies.velocity_y[row], way[3] = ahead;
    to[0] += way[0], to[1] += way[1];
    if (!bodies.has_rotation) return;
    way[2] = ahead * bodies.angular_velocity[row];
    // By the tangent of half of the angle, as small as it is: a turn of any angle, whatever rounding does.
    const Real half = Real(0.5) * way[2], grown = 1 / (1 + half * half), cosine = (1 - half * half) * grown,
               sine = 2 * half * grown;
    const Real cosine_now = to[2], sine_now = to[3];
    to[2] = cosine_now * cosine - sine_now * sine, to[3] = sine_now * cosine + cosine_now * sine;
}

/// Places of a row whose flight is held: what it goes by is that of another velocity.
template <class Real>
void PosesAhead<Real>::hold(std::size_t row, Vec2 velocity) {
    for (const Lead lead : {Lead::half, Lead::whole}) {
        Real *to = &pose[4 * place_of(row, lead)], *way = &come[4 * place_of(row, lead)];
        if (!is_used(lead) || !(way[3] > 0)) continue;
        const Real x = way[3] * static_cast<Real>(velocity.x), y = way[3] * static_cast<Real>(velocity.y);
        to[0] += x - way[0], to[1] += y - way[1];
        way[0] = x, way[1] = y;
    }
}

template <class Real>
void PosesAhead<Real>::look_at_surfaces(const WorldState<Real>& world, const SubstepTerms& terms,
                                        const ManifoldList<Real>& surfaces) {
    const Bodies<Real>& bodies = world.bodies;
    on_surfaces_.assign(bodies.rows(), 0);
    if (empty()) return;
    for (std::size_t i = 0; i < surfaces.count(); ++i) {
        const ManifoldName& name = surfaces.names[i];
        if (!world.handles.is_alive(name.a)) continue;
        const std::size_t row = world.handles.row_of_slot(name.a.index);
        const std::span<const StoredPiece> pieces = world.shapes.pieces(bodies.shape[row]);
        const auto piece = static_cast<std::size_t>(ManifoldName::piece_of_surface(name.place));
        const std::int32_t number = pieces.empty() ? bodies.shape[row] : pieces[piece].number;
        const Lead lead = used_or_none(lead_of(surfaces.memory[i], is_round(number), surfaces.friction[i],
                                               bodies.inradius(row), bodies.mass[row], terms));
        on_surfaces_[row] =
            std::max(on_surfaces_[row], static_cast<double>(come[4 * place_of(row, lead) + 3]));
    }
}

template <class Real>
void PosesAhead<Real>::resize_places(std::size_t contacts) {
    if (!empty()) a.resize(padded(contacts)), b.resize(padded(contacts));
}

template <class Real>
bool PosesAhead<Real>::place(const WorldState<Real>& world, const SubstepTerms& terms,
                             const ManifoldList<Real>& contacts, std::uint32_t may_press, std::size_t first) {
    if (empty()) return false;
    const Bodies<Real>& bodies = world.bodies;
    const bool all_rows = contacts.item_a.empty();
    const Column<std::int32_t>&item_a = all_rows ? contacts.a : contacts.item_a,
          &item_b = all_rows ? contacts.b : contacts.item_b;
    const std::size_t last = std::min(contacts.count(), first + kRowPadding);
    std::array<Lead, kRowPadding> leads{};
    const auto has_round = [&](std::int32_t item) { return is_round(shape[static_cast<std::size_t>(item)]); };
    bool any = false;
    for (std::uint32_t left = may_press; left != 0; left &= left - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(left));
        if (i >= last) break;
        if (!contacts.memory[i].is_loaded()) continue;
        const auto row_a = static_cast<std::size_t>(contacts.a[i]),
                   row_b = static_cast<std::size_t>(contacts.b[i]);
        const bool b_moves = row_b < bodies.count && !bodies.is_immovable(row_b);
        const Real mass = b_moves ? std::min(bodies.mass[row_a], bodies.mass[row_b]) : bodies.mass[row_a];
        leads[i - first] =
            used_or_none(lead_of(contacts.memory[i], has_round(item_a[i]) || has_round(item_b[i]),
                                 contacts.friction[i], contacts.thickness[i], mass, terms));
        any = any || leads[i - first] != Lead::none;
    }
    if (!any) return false;
    for (std::size_t k = 0; k < kRowPadding; ++k) {
        const auto beyond = static_cast<std::int32_t>(place_of(0, leads[k]));
        a[first + k] = item_a[first + k] + beyond, b[first + k] = item_b[first + k] + beyond;
    }
    return true;
}

template <class Real>
std::size_t PosesAhead<Real>::bytes() const {
    return pose.bytes() + come.bytes() + shape.bytes() + a.bytes() + b.bytes() +
           on_surfaces_.capacity() * sizeof(double) + is_round_.capacity();
}

template class PosesAhead<float>;
template class PosesAhead<double>;

}  // namespace carom
