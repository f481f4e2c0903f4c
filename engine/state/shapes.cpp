#include "state/shapes.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

#include "shapes/convex_geometry.hpp"

namespace carom {
namespace {

constexpr std::size_t kFewestSlots = 16;

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
    return static_cast<std::size_t>(sum);
}

template <class Real>
Shape ShapeStore<Real>::shape(std::int32_t number) const {
    const Record& record = records_[static_cast<std::size_t>(number)];
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
std::int32_t ShapeStore<Real>::add(const Shape& shape) {
    assert(is_convex(shape));
    const Record record = record_of(shape);
    if (!index_.empty())
        if (const std::int32_t known = index_[slot_of(record)]; known >= 0) {
            ++bodies_[static_cast<std::size_t>(known)];
            return known;
        }
    if (free_.empty()) {
        free_.push_back(static_cast<std::int32_t>(records_.size()));
        shapes_.resize(records_.size() + 1), records_.emplace_back(), bodies_.push_back(0);
        if (2 * records_.size() > index_.size()) make_index();
    }
    const std::int32_t number = free_.back();
    free_.pop_back();
    const auto i = static_cast<std::size_t>(number);
    shapes_[i] = convex_shape_of<Real>(shape);
    records_[i] = record, bodies_[i] = 1;
    index_[slot_of(record)] = number;
    return number;
}

template <class Real>
void ShapeStore<Real>::remove(std::int32_t number) {
    if (--bodies_[static_cast<std::size_t>(number)] > 0) return;
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
