#pragma once

#include <carom/shapes.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "shapes/convex_shape.hpp"
#include "state/column.hpp"

namespace carom {

/// The distinct convex geometries of a world: bodies of the same shape share one. Nothing is in it while all
/// bodies are discs or edges.
template <class Real>
class ShapeStore {
  public:
    /// A world of discs and edges alone.
    bool empty() const { return shapes_.empty(); }
    /// Numbers are below it; some may be free.
    std::size_t size() const { return shapes_.size(); }
    /// Geometries in use.
    std::size_t distinct() const { return shapes_.size() - free_.size(); }

    const ConvexShape<Real>& operator[](std::int32_t number) const {
        return shapes_[static_cast<std::size_t>(number)];
    }
    const ConvexShape<Real>* data() const { return shapes_.data(); }
    /// What was added under a number: a polygon around its centroid, counter-clockwise.
    Shape shape(std::int32_t number) const;

    /// Counts one more body of a convex shape. Cost: O(1), expected.
    /// @return its number, the same until the last body of the shape is removed
    std::int32_t add(const Shape& shape);
    /// Counts one body less; a number that no body has is free.
    void remove(std::int32_t number);

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.shapes_, self.records_, self.bodies_, self.free_);
        if constexpr (!std::is_const_v<Self>) self.make_index();
    }

    std::size_t bytes() const {
        return shapes_.bytes() + records_.capacity() * sizeof(Record) +
               bodies_.capacity() * sizeof(std::uint32_t) +
               (free_.capacity() + index_.capacity()) * sizeof(std::int32_t);
    }

  private:
    /// A shape as plain data, which tells whether two are the same.
    struct Record {
        std::int32_t kind = 0;  // place in the variant Shape
        std::int32_t count = 0;
        double radius = 0;                         // m
        std::array<Vec2, kMostVertices> points{};  // m; of a box width and height, of a capsule the length
        friend bool operator==(const Record&, const Record&) = default;
    };
    static Record record_of(const Shape& shape);
    static std::size_t hash_of(const Record& record);

    std::size_t slot_of(const Record& record) const;
    void make_index();
    void leave_index(std::int32_t number);

    Column<ConvexShape<Real>> shapes_;
    std::vector<Record> records_;        // by number
    std::vector<std::uint32_t> bodies_;  // by number: how many have it
    std::vector<std::int32_t> free_;     // numbers
    // Numbers by hash of their record, open addressing: a power of two of slots, -1 where there is none.
    std::vector<std::int32_t> index_;
};

extern template class ShapeStore<float>;
extern template class ShapeStore<double>;

}  // namespace carom
