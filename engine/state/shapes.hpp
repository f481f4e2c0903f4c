#pragma once

#include <carom/shapes.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "math/rotation.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/convex_shape.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// A piece of a compound, as plain data.
struct StoredPiece {
    std::int32_t number = 0;  // of its geometry, in the frame of the body
    double x = 0, y = 0;      // m, its centroid in the frame of the body
    double angle = 0;         // rad
    Material material;
};

/// The distinct convex geometries of a world: bodies of the same shape share one. Nothing is in it while all
/// bodies are discs or edges.
template <class Real>
class ShapeStore {
  public:
    /// A world of discs and edges alone.
    bool empty() const { return shapes_.empty(); }
    /// Numbers are below it; some may be free.
    std::size_t size() const { return shapes_.size(); }
    /// Another number whenever geometries have come or gone, from 1 on.
    std::uint64_t revision() const { return revision_; }
    /// Geometries in use.
    std::size_t distinct() const { return shapes_.size() - free_.size(); }

    const ConvexShape<Real>& operator[](std::int32_t number) const {
        return shapes_[static_cast<std::size_t>(number)];
    }
    const ConvexShape<Real>* data() const { return shapes_.data(); }
    /// Some body is, or was, a compound.
    bool has_compounds() const { return !compounds_.empty(); }
    bool is_compound(std::int32_t number) const { return has_compounds() && !pieces(number).empty(); }
    /// Pieces of a compound; none for other geometries. The compound itself counts as the disc around it.
    std::span<const StoredPiece> pieces(std::int32_t number) const {
        const auto i = static_cast<std::size_t>(number);
        return i < compounds_.size() ? std::span<const StoredPiece>(compounds_[i])
                                     : std::span<const StoredPiece>{};
    }
    /// Whether a number is that of a piece.
    bool is_piece(std::int32_t number) const {
        return records_[static_cast<std::size_t>(number)].is_piece != 0;
    }
    /// Calls fn(geometry, number of the piece, its StoredPiece or null) for all that a geometry consists of.
    template <class Fn>
    void for_each_piece(std::int32_t number, const Fn& fn) const {
        const std::span<const StoredPiece> all = pieces(number);
        if (all.empty()) fn((*this)[number], 0, static_cast<const StoredPiece*>(nullptr));
        for (std::size_t i = 0; i < all.size(); ++i)
            fn((*this)[all[i].number], static_cast<std::int32_t>(i), &all[i]);
    }

    /// How far a geometry, compounds included, reaches from its centre in a direction [m].
    /// @param direction  of length 1
    double reach_along(std::int32_t number, Rotation turn, Vec2 direction) const {
        double reach = -std::numeric_limits<double>::infinity();
        for_each_piece(number, [&](const ConvexShape<Real>& shape, std::int32_t, const StoredPiece*) {
            reach = std::fmax(reach, carom::reach_along(shape, turn, direction));
        });
        return reach;
    }

    /// What was added under a number: a polygon around its centroid, counter-clockwise.
    Shape shape(std::int32_t number) const;

    /// Counts one more body of a shape with an area. Cost: O(1), expected; of a compound O(pieces).
    /// @param standard  material of the pieces of a compound that have none
    /// @return its number, the same until the last body of the shape is removed
    std::int32_t add(const Shape& shape, const Material& standard = {});
    /// Counts one body less; a number that no body has is free.
    void remove(std::int32_t number);

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.shapes_, self.records_, self.bodies_, self.free_, self.compounds_);
        if constexpr (!std::is_const_v<Self>) self.make_index(), ++self.revision_;
    }

    std::size_t bytes() const {
        std::size_t of_pieces = compounds_.capacity() * sizeof(compounds_[0]);
        for (const auto& pieces : compounds_) of_pieces += pieces.capacity() * sizeof(StoredPiece);
        return of_pieces + shapes_.bytes() + records_.capacity() * sizeof(Record) +
               bodies_.capacity() * sizeof(std::uint32_t) +
               (free_.capacity() + index_.capacity()) * sizeof(std::int32_t);
    }

  private:
    /// A shape as plain data, which tells whether two are the same.
    struct Record {
        std::int32_t kind = 0;  // place in the variant Shape
        std::int32_t count = 0;
        double radius = 0;                         // m; of a compound how many others have its hash
        std::int64_t is_piece = 0;                 // whether it is one: then no two share it
        std::array<Vec2, kMostVertices> points{};  // m; of a box width and height, of a capsule the length
        friend bool operator==(const Record&, const Record&) = default;
    };
    static Record record_of(const Shape& shape);
    static std::size_t hash_of(const Record& record);
    std::int32_t make_number(const Record& record, const ConvexShape<Real>& shape);
    std::int32_t add_compound(const Compound& compound, const Material& standard);
    bool is_same(std::int32_t number, const Compound& compound) const;

    std::size_t slot_of(const Record& record) const;
    void make_index();
    void leave_index(std::int32_t number);

    Column<ConvexShape<Real>> shapes_;
    std::vector<std::vector<StoredPiece>> compounds_;  // by number; empty without compounds
    std::vector<Record> records_;                      // by number
    std::vector<std::uint32_t> bodies_;                // by number: how many have it
    std::vector<std::int32_t> free_;                   // numbers
    // Numbers by hash of their record, open addressing: a power of two of slots, -1 where there is none.
    std::vector<std::int32_t> index_;
    std::uint64_t revision_ = 1;
};

extern template class ShapeStore<float>;
extern template class ShapeStore<double>;

}  // namespace carom
