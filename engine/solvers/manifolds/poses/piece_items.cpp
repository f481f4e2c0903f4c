#include "solvers/manifolds/poses/piece_items.hpp"

#include <algorithm>

namespace carom {

template <class Real>
void PieceItems<Real>::list(const WorldState<Real>& world) {
    first_.clear(), shape_.clear(), row_.clear();
    if (!world.shapes.has_compounds()) return;
    const Bodies<Real>& bodies = world.bodies;
    const std::size_t rows = bodies.rows();
    first_.resize(rows + 1), shape_.resize(rows);
    std::copy_n(bodies.shape.data(), rows, shape_.data());
    for (std::size_t row = 0; row < rows; ++row) {
        first_[row] = static_cast<std::int32_t>(shape_.size());
        if (bodies.shape[row] < 0) continue;
        for (const StoredPiece& piece : world.shapes.pieces(bodies.shape[row]))
            shape_.push_back(piece.number), row_.push_back(static_cast<std::int32_t>(row));
    }
    first_[rows] = static_cast<std::int32_t>(shape_.size());
}

template class PieceItems<float>;
template class PieceItems<double>;

}  // namespace carom
