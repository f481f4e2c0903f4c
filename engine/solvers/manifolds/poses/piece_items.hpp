#pragma once

#include <cstdint>
#include <vector>

#include "state/columns/column.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What the find kernels look at in place of rows where some bodies are compounds: items, which are the
/// bodies by their rows and behind them the pieces of compounds, each with the pose of its body, in whose
/// frame its geometry is. Nothing is in it where there are no compounds.
template <class Real>
class PieceItems {
  public:
    /// Lists the pieces of all bodies; to be called when rows have changed.
    void list(const WorldState<Real>& world);
    bool empty() const { return shape_.empty(); }

    /// Calls fn(item, number of the piece) for what can touch of a body.
    template <class Fn>
    void for_each(std::int32_t row, const Fn& fn) const {
        const auto i = static_cast<std::size_t>(row);
        if (first_[i] == first_[i + 1]) fn(row, 0);
        for (std::int32_t item = first_[i]; item < first_[i + 1]; ++item) fn(item, item - first_[i]);
    }
    /// The piece that an item of a row is; null: the item is the body.
    const StoredPiece* piece_of(const WorldState<Real>& world, std::int32_t row, std::int32_t item) const {
        if (item == row) return nullptr;
        const auto i = static_cast<std::size_t>(row);
        return &world.shapes.pieces(world.bodies.shape[i])[static_cast<std::size_t>(item - first_[i])];
    }
    /// The number in the ShapeStore of the geometry of an item of a row: the body's, or a piece's.
    std::int32_t shape_of(const WorldState<Real>& world, std::int32_t row, std::int32_t item) const {
        const StoredPiece* piece = empty() ? nullptr : piece_of(world, row, item);
        return piece ? piece->number : world.bodies.shape[static_cast<std::size_t>(row)];
    }
    /// The item of a piece of a row; of a body that has none, the row.
    std::int32_t item_of(std::int32_t row, std::int32_t piece) const {
        const auto i = static_cast<std::size_t>(row);
        return first_[i] == first_[i + 1] ? row : first_[i] + piece;
    }
    /// Pieces, which are the items behind the rows.
    std::size_t count() const { return row_.size(); }
    /// Calls fn(item, row of its body, number of its geometry) for each piece.
    template <class Fn>
    void for_each_piece(const Fn& fn) const {
        const std::size_t rows = shape_.size() - row_.size();
        for (std::size_t i = 0; i < row_.size(); ++i)
            fn(rows + i, static_cast<std::size_t>(row_[i]), shape_[rows + i]);
    }

    std::size_t bytes() const {
        return first_.bytes() + shape_.bytes() + row_.capacity() * sizeof(std::int32_t);
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.first_, self.shape_, self.row_);
    }

  private:
    Column<std::int32_t> first_;     // [rows + 1], item of the first piece of a row
    Column<std::int32_t> shape_;     // by item
    std::vector<std::int32_t> row_;  // by item behind the rows: of its body
};

extern template class PieceItems<float>;
extern template class PieceItems<double>;

}  // namespace carom
