#include "solvers/contact_sets/coarse_correction.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

// docs/decisions/0017-heave.md has the measurements of all of these.
constexpr double kBodiesOfCell = 192;  // bodies a cell, about: half and four times as many did worse
constexpr double kSmallestCell = 8;    // largest radii: s is taken to be linear around a body
/// Fewer than kFewestLoaded bodies are a slender pile if they are as long as so many of the largest are wide;
/// docs/decisions/0047-columns-of-discs.md.
constexpr double kFewestRows = 32;
constexpr double kBodiesOfSmallCell = 24;  // likewise
constexpr double kLeast = -0.9;            // least s: a contact never pulls, and keeps some load
constexpr double kMost = 4;                // largest s
constexpr int kSweepsOverNodes = 20;
// A correction is small if it takes less than either of these; then the pause after it is twice as long.
/// Share of the energy that gravity gives to the pile in a substep from rest.
constexpr double kSmallDrop = 0.1;
/// Share of the kinetic energy around the centre of mass, which matters for a drum that turns.
constexpr double kSmallShare = 0.006;
constexpr int kLongestPause = 64;  // substeps
/// After a pause longer than the shortest, contacts keep this share of the 1/n that deadbeat would leave
/// them: in so many substeps the shortest waves swing back, and all of it would drive them.
constexpr double kKeptAfterLong = 0.25;
/// The grid reaches this many root mean squares of the bodies' distances to each side of their mean; evenly
/// spread bodies end at 1.73.
constexpr double kHalfWidth = 2;

// ns a body on one thread, for the executor.
constexpr double kNanosecondsToMeasure = 2, kNanosecondsToAdd = 20, kNanosecondsToScale = 4;

// Nodes of a cell: low left, low right, high left, high right.
constexpr std::array<std::array<std::size_t, 2>, 10> kPairsOfNodes{
    {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}}};

}  // namespace

template <class Real>
bool CoarseCorrection<Real>::is_due(std::size_t bodies, int substeps, std::size_t fewest) {
    substeps_since_ = std::min(substeps_since_, kLongestPause) + substeps;
    fewest_ = fewest;
    if (bodies < fewest || substeps_since_ < pause_) return false;
    kept_ = (substeps_since_ > kShortestPause ? kKeptAfterLong : 1.0) / substeps_since_;
    substeps_since_ = 0;
    return true;
}

template <class Real>
void CoarseCorrection<Real>::begin(std::size_t rows) {
    load_.resize(4 * rows), stress_.resize(4 * rows), scale_.resize(rows);
    for (Column<Real>* column : {&load_, &stress_}) std::fill(column->begin(), column->end(), Real(0));
}

template <class Real>
template <class Fn>
void CoarseCorrection<Real>::for_each_part(std::size_t count, double nanoseconds, const Executor& executor,
                                           const Fn& fn) const {
    executor.for_each_task(kParts, nanoseconds * static_cast<double>(count), [&](std::size_t part) {
        fn(part, part * count / kParts, (part + 1) * count / kParts);
    });
}

/// Lays cells over the middle of the loaded bodies; a body outside has the s of the nearest node or edge.
template <class Real>
void CoarseCorrection<Real>::lay_out(std::size_t count, const Real* motion, const Real* velocity,
                                     double largest_radius, const Executor& executor) {
    const double from_x = motion[0], from_y = motion[1];
    for_each_part(count, kNanosecondsToMeasure, executor,
                  [&](std::size_t part, std::size_t first, std::size_t last) {
                      Extent sum;
                      for (std::size_t row = first; row < last; ++row) {
                          if (!is_loaded(row)) continue;
                          const double x = static_cast<double>(motion[4 * row]) - from_x,
                                       y = static_cast<double>(motion[4 * row + 1]) - from_y;
                          sum.count += 1;
                          const double mass = 1 / std::fabs(static_cast<double>(velocity[4 * row + 3])),
                                       vx = velocity[4 * row], vy = velocity[4 * row + 1];
                          sum.mass += mass, sum.px += mass * vx, sum.py += mass * vy;
                          sum.energy += 0.5 * mass * (vx * vx + vy * vy);
                          sum.x += x, sum.y += y, sum.xx += x * x, sum.yy += y * y;
                      }
                      extents_[part] = sum;
                  });
    Extent all;
    for (const Extent& part : extents_) {
        all.count += part.count, all.mass += part.mass;
        all.px += part.px, all.py += part.py, all.energy += part.energy;
        all.x += part.x, all.y += part.y, all.xx += part.xx, all.yy += part.yy;
    }
    nodes_.clear();
    if (all.count < static_cast<double>(fewest_)) return;
    const double x = all.x / all.count, y = all.y / all.count;
    const double half_x = kHalfWidth * std::sqrt(std::fmax(all.xx / all.count - x * x, 0)),
                 half_y = kHalfWidth * std::sqrt(std::fmax(all.yy / all.count - y * y, 0));
    mass_ = all.mass;
    energy_ = all.energy - 0.5 * (all.px * all.px + all.py * all.py) / all.mass;
    is_small_ = all.count < static_cast<double>(kFewestLoaded);
    if (is_small_ && std::fmax(half_x, half_y) < kFewestRows * largest_radius) return;
    const double of_cell = is_small_ ? kBodiesOfSmallCell : kBodiesOfCell;
    const double least =
        std::fmax(kSmallestCell * largest_radius, std::sqrt(of_cell / all.count * 4 * half_x * half_y));
    const double most = all.count / of_cell;  // cells along a heap of no height
    const auto cells_along = [&](double half) {
        return static_cast<std::size_t>(std::clamp(std::ceil(2 * half / least), 1.0, most));
    };
    const std::size_t along_x = cells_along(half_x), along_y = cells_along(half_y);
    const double side = std::fmax(
        least, 2 * std::fmax(half_x / static_cast<double>(along_x), half_y / static_cast<double>(along_y)));
    per_metre_ = 1 / side;
    low_ = {from_x + x - 0.5 * side * static_cast<double>(along_x),
            from_y + y - 0.5 * side * static_cast<double>(along_y)};
    width_ = along_x + 1, height_ = along_y + 1;
    nodes_.assign(width_ * height_, {});
}

/// Takes in a body at (f, g) of the cell: the momentum that a node brings about is its hat there times p, and
/// the slopes of the hat times x and y.
template <class Real>
void CoarseCorrection<Real>::Cell::add(double f, double g, Vec2 p, Vec2 x, Vec2 y, double of_rate,
                                       double inverse_mass) {
    const Vec2 low = (1 - g) * p - y, high = g * p + y;
    const std::array<Vec2, 4> momentum{(1 - f) * low - (1 - g) * x, f * low + (1 - g) * x,
                                       (1 - f) * high - g * x, f * high + g * x};
    const auto add_product = [&](std::size_t pair, std::size_t of, std::size_t with) {
        product[pair] += inverse_mass * dot(momentum[of], momentum[with]);
    };
    // The calls are in the order of kPairsOfNodes: a loop over that takes twice as long.
    add_product(0, 0, 0), add_product(1, 0, 1), add_product(2, 0, 2), add_product(3, 0, 3);
    add_product(4, 1, 1), add_product(5, 1, 2), add_product(6, 1, 3);
    add_product(7, 2, 2), add_product(8, 2, 3), add_product(9, 3, 3);
    rate[0] += (1 - f) * (1 - g) * of_rate, rate[1] += f * (1 - g) * of_rate;
    rate[2] += (1 - f) * g * of_rate, rate[3] += f * g * of_rate;
}

template <class Real>
void CoarseCorrection<Real>::add_bodies(std::size_t count, const Real* motion, const Real* velocity,
                                        const Executor& executor) {
    const std::size_t cells = (width_ - 1) * (height_ - 1);
    cells_.resize(kParts * cells);
    const auto add = [&](std::size_t part, std::size_t first, std::size_t last) {
        Cell* const of_part = cells_.data() + part * cells;
        std::fill(of_part, of_part + cells, Cell{});
        for (std::size_t row = first; row < last; ++row) {
            if (!is_loaded(row)) continue;
            const At at = at_place(motion + 4 * row);
            const Real *load = load_.data() + 4 * row, *stress = stress_.data() + 4 * row;
            const auto vector = [](Real x, Real y) {
                return Vec2{static_cast<double>(x), static_cast<double>(y)};
            };
            of_part[at.j * (width_ - 1) + at.i].add(
                at.f, at.g, vector(load[0], load[1]), per_metre_ * vector(stress[0], stress[2]),
                per_metre_ * vector(stress[1], stress[3]), static_cast<double>(load[2]),
                std::fabs(static_cast<double>(velocity[4 * row + 3])));
        }
    };
    for_each_part(count, kNanosecondsToAdd, executor, add);
}

template <class Real>
void CoarseCorrection<Real>::add_cells() {
    const std::size_t cells = (width_ - 1) * (height_ - 1);
    const auto line_of = [](std::size_t node) { return node / 2; };
    const auto place_of = [](std::size_t node) { return node % 2; };
    for (std::size_t cell = 0; cell < cells; ++cell) {
        Cell sum{};
        for (std::size_t part = 0; part < kParts; ++part) {
            const Cell& of_part = cells_[part * cells + cell];
            for (std::size_t k = 0; k < 4; ++k) sum.rate[k] += of_part.rate[k];
            for (std::size_t k = 0; k < sum.product.size(); ++k) sum.product[k] += of_part.product[k];
        }
        Node* const first = &nodes_[cell / (width_ - 1) * width_ + cell % (width_ - 1)];
        const auto node = [&](std::size_t k) -> Node& { return first[line_of(k) * width_ + place_of(k)]; };
        for (std::size_t k = 0; k < 4; ++k) node(k).rate += sum.rate[k];
        for (std::size_t k = 0; k < kPairsOfNodes.size(); ++k) {
            const auto [of, with] = kPairsOfNodes[k];
            const std::size_t there = 4 + 3 * (line_of(with) - line_of(of)) + place_of(with) - place_of(of);
            node(of).product[there] += sum.product[k];
            if (of != with) node(with).product[8 - there] += sum.product[k];
        }
    }
}

/// Projected Gauss-Seidel, forth and back. Products with nodes beyond the border are zero.
template <class Real>
void CoarseCorrection<Real>::solve() {
    const std::size_t count = nodes_.size();
    for (int sweep = 0; sweep < kSweepsOverNodes; ++sweep)
        for (std::size_t n = 0; n < count; ++n) {
            const std::size_t at = sweep % 2 == 0 ? n : count - 1 - n, i = at % width_, j = at / width_;
            Node& node = nodes_[at];
            if (!(node.product[4] > 0)) continue;
            double rate = node.rate;
            for (std::size_t v = j > 0 ? j - 1 : 0; v < std::min(j + 2, height_); ++v)
                for (std::size_t u = i > 0 ? i - 1 : 0; u < std::min(i + 2, width_); ++u)
                    rate += node.product[3 * (v + 1 - j) + u + 1 - i] * nodes_[v * width_ + u].s;
            node.s = std::clamp(node.s - rate / node.product[4], kLeast, kMost);
        }
}

/// J, about: what the correction takes from E if nothing kept it from its minimum, and less than that if so.
template <class Real>
double CoarseCorrection<Real>::drop() const {
    double sum = 0;
    for (const Node& node : nodes_) sum -= node.rate * node.s;
    return 0.5 * sum;
}

template <class Real>
bool CoarseCorrection<Real>::find_scale(std::size_t count, const Real* motion, const Real* velocity,
                                        double largest_radius, Vec2 gain, const Executor& executor) {
    pause_ = std::min(2 * pause_, kLongestPause);
    lay_out(count, motion, velocity, largest_radius, executor);
    if (nodes_.empty()) return false;
    add_bodies(count, motion, velocity, executor);
    add_cells();
    solve();
    if (drop() > std::fmax(kSmallDrop * 0.5 * mass_ * length_squared(gain), kSmallShare * energy_))
        pause_ = kShortestPause;
    else if (is_small_)
        return false;  // seldom corrected, it would be kept swinging
    const auto interpolate = [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t row = first; row < last; ++row) {
            const At at = at_place(motion + 4 * row);
            const Node *low = &nodes_[at.j * width_ + at.i], *high = low + width_;
            scale_[row] = static_cast<Real>((1 - at.g) * ((1 - at.f) * low[0].s + at.f * low[1].s) +
                                            at.g * ((1 - at.f) * high[0].s + at.f * high[1].s));
        }
    };
    for_each_part(count, kNanosecondsToScale, executor, interpolate);
    std::fill(scale_.begin() + static_cast<std::ptrdiff_t>(count), scale_.end(), Real(0));
    return true;
}

template <class Real>
std::size_t CoarseCorrection<Real>::bytes() const {
    return load_.bytes() + stress_.bytes() + scale_.bytes() + cells_.capacity() * sizeof(Cell) +
           nodes_.capacity() * sizeof(Node);
}

template class CoarseCorrection<float>;
template class CoarseCorrection<double>;

}  // namespace carom
