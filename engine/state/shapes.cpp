#include "state/shapes.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <utility>

#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"

namespace carom {
namespace {

constexpr std::size_t kFewestSlots = 16;  // of the table that finds equal shapes; a power of two

std::uint64_t mix(std::uint64_t sum, double value) {
    constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15u;  // 2^64 over the golden ratio (Knuth)
    sum = (sum ^ std::bit_cast<std::uint64_t>(value)) * kOdd;
    return sum ^ (sum >> 32);
}

}  // namespace

template <class Real>
auto ShapeStore<Real>::record_of(const Shape& shape) -> Record {
    Record record;
    record.kind = static_cast<std::int32_t>(shape.index());
    if (const auto* disc = std::get_if<Disc>(&shape)) {
        record.radius = static_cast<double>(static_cast<Real>(disc->radius));  // as the column has it
    } else if (const auto* box = std::get_if<Box>(&shape)) {
        record.points[0] = {box->width, box->height};
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
        record.radius = capsule->radius, record.points[0] = {capsule->length, 0};
    } else if (const auto* polygon = std::get_if<Polygon>(&shape)) {
        const Polygon centred = recentred(*polygon);
        record.radius = centred.radius, record.count = static_cast<std::int32_t>(centred.vertices.size());
        std::copy(centred.vertices.begin(), centred.vertices.end(), record.points.begin());
    }
    return record;
}

template <class Real>
std::size_t ShapeStore<Real>::hash_of(const Record& record) {
    std::uint64_t sum = mix(static_cast<std::uint64_t>(record.kind), record.radius);
    for (const Vec2 point : record.points) sum = mix(mix(sum, point.x), point.y);
    sum = record.is_piece == 0 ? sum : mix(sum, static_cast<double>(record.is_piece));
    return static_cast<std::size_t>(sum);
}

template <class Real>
Shape ShapeStore<Real>::shape(std::int32_t number) const {
    const Record& record = records_[static_cast<std::size_t>(number)];
    if (const std::span<const StoredPiece> all = pieces(number); !all.empty()) {
        Compound compound;
        for (const StoredPiece& piece : all)
            std::visit(
                [&](const auto& kind) {
                    if constexpr (requires { Piece{kind, {}, 0, {}}; })
                        compound.pieces.push_back({kind, {piece.x, piece.y}, piece.angle, piece.material});
                },
                shape(piece.number));
        return compound;
    }
    const auto is = [&](const Shape& kind) { return record.kind == static_cast<std::int32_t>(kind.index()); };
    if (is(Box{})) return Box{record.points[0].x, record.points[0].y};
    if (is(Capsule{})) return Capsule{record.points[0].x, record.radius};
    if (is(Polygon{}))
        return Polygon{{record.points.begin(), record.points.begin() + record.count}, record.radius};
    return Disc{record.radius};
}

/// The slot that holds the record's number, or the free one where it belongs.
template <class Real>
std::size_t ShapeStore<Real>::slot_of(const Record& record) const {
    const std::size_t mask = index_.size() - 1;
    std::size_t slot = hash_of(record) & mask;
    while (index_[slot] >= 0 && !(records_[static_cast<std::size_t>(index_[slot])] == record))
        slot = (slot + 1) & mask;
    return slot;
}

template <class Real>
void ShapeStore<Real>::make_index() {
    index_.assign(records_.empty() ? 0 : std::max(kFewestSlots, std::bit_ceil(2 * records_.size())), -1);
    for (std::size_t number = 0; number < records_.size(); ++number)
        if (bodies_[number] > 0) index_[slot_of(records_[number])] = static_cast<std::int32_t>(number);
}

template <class Real>
std::int32_t ShapeStore<Real>::add(const Shape& shape, const Material& standard) {
    if (const auto* compound = std::get_if<Compound>(&shape)) return add_compound(*compound, standard);
    assert(is_convex(shape));
    const Record record = record_of(shape);
    if (!index_.empty())
        if (const std::int32_t known = index_[slot_of(record)]; known >= 0) {
            ++bodies_[static_cast<std::size_t>(known)];
            return known;
        }
    return make_number(record, convex_shape_of<Real>(shape));
}

/// A number for a record that has none.
template <class Real>
std::int32_t ShapeStore<Real>::make_number(const Record& record, const ConvexShape<Real>& shape) {
    ++revision_;
    if (free_.empty()) {
        free_.push_back(static_cast<std::int32_t>(records_.size()));
        shapes_.resize(records_.size() + 1), records_.emplace_back(), bodies_.push_back(0);
        if (2 * records_.size() > index_.size()) make_index();
    }
    const std::int32_t number = free_.back();
    free_.pop_back();
    const auto i = static_cast<std::size_t>(number);
    shapes_[i] = shape;
    records_[i] = record, bodies_[i] = 1;
    index_[slot_of(record)] = number;
    return number;
}

template <class Real>
bool ShapeStore<Real>::is_same(std::int32_t number, const Compound& compound) const {
    const std::span<const StoredPiece> all = pieces(number);
    if (all.size() != compound.pieces.size()) return false;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Piece& piece = compound.pieces[i];
        Record record = record_of(carom::shape_of(piece));
        record.is_piece = all[i].number + 1;
        if (!(records_[static_cast<std::size_t>(all[i].number)] == record) ||
            piece.position != Vec2{all[i].x, all[i].y} || piece.angle != all[i].angle ||
            !(*piece.material == all[i].material))
            return false;
    }
    return true;
}

/// A compound is known by a hash of its pieces, and by how many others of that hash there are.
template <class Real>
std::int32_t ShapeStore<Real>::add_compound(const Compound& given, const Material& standard) {
    Compound compound = recentred(given, standard);
    Record record;
    record.kind = static_cast<std::int32_t>(Shape(Compound{}).index());
    record.count = static_cast<std::int32_t>(compound.pieces.size());
    std::uint64_t sum = compound.pieces.size();
    ConvexShape<Real> around = convex_shape_of<Real>(Disc{1});
    around.extent = 0, around.inradius = std::numeric_limits<Real>::infinity();
    std::vector<ConvexShape<Real>> shapes;
    for (Piece& piece : compound.pieces) {
        piece.material = material_of(piece, standard);
        const Material& m = *piece.material;
        sum = mix(sum, static_cast<double>(hash_of(record_of(carom::shape_of(piece)))));
        for (const double value : {piece.position.x, piece.position.y, piece.angle, m.density, m.friction,
                                   m.restitution, m.rolling_resistance})
            sum = mix(sum, value);
        shapes.push_back(convex_shape_of<Real>(carom::shape_of(piece), piece.position, piece.angle));
        around.extent = std::max(around.extent, shapes.back().extent);
        around.inradius = std::min(around.inradius, shapes.back().inradius);
    }
    around.radius = around.extent;
    record.points[0] = {static_cast<double>(sum >> 32), static_cast<double>(sum & UINT32_MAX)};
    for (; !index_.empty(); ++record.radius) {
        const std::int32_t known = index_[slot_of(record)];
        if (known < 0) break;
        if (!is_same(known, compound)) continue;
        ++bodies_[static_cast<std::size_t>(known)];
        return known;
    }
    const std::int32_t number = make_number(record, around);
    std::vector<StoredPiece> stored;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Piece& piece = compound.pieces[i];
        Record own = record_of(carom::shape_of(piece));
        // Each has a record of its own, by the number it is about to get.
        own.is_piece = 1 + (free_.empty() ? static_cast<std::int32_t>(records_.size()) : free_.back());
        stored.push_back(
            {make_number(own, shapes[i]), piece.position.x, piece.position.y, piece.angle, *piece.material});
    }
    compounds_.resize(std::max(compounds_.size(), static_cast<std::size_t>(number) + 1));
    compounds_[static_cast<std::size_t>(number)] = std::move(stored);
    ++revision_;
    return number;
}

template <class Real>
void ShapeStore<Real>::remove(std::int32_t number) {
    if (--bodies_[static_cast<std::size_t>(number)] > 0) return;
    if (is_compound(number)) {
        for (const StoredPiece& piece : pieces(number)) remove(piece.number);
        compounds_[static_cast<std::size_t>(number)].clear();
    }
    ++revision_;
    leave_index(number);
    free_.push_back(number);
}

/// Frees the number's slot; those behind it that would not be found any more move up.
template <class Real>
void ShapeStore<Real>::leave_index(std::int32_t number) {
    const std::size_t mask = index_.size() - 1;
    std::size_t gap = slot_of(records_[static_cast<std::size_t>(number)]);
    for (std::size_t slot = (gap + 1) & mask; index_[slot] >= 0; slot = (slot + 1) & mask) {
        const std::size_t home = hash_of(records_[static_cast<std::size_t>(index_[slot])]) & mask;
        if (((slot - home) & mask) < ((slot - gap) & mask)) continue;  // it is found without the gap
        index_[gap] = index_[slot], gap = slot;
    }
    index_[gap] = -1;
}

template class ShapeStore<float>;
template class ShapeStore<double>;

}  // namespace carom
