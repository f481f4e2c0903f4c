#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/vec2_math.hpp"
#include "parallel/executor.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// Stops the motion of a pile as a whole, which sweeps over contacts do not see.
///
/// A sweep tells a body what its neighbours do. A motion of hundreds of them together it makes into a wave,
/// which takes as many substeps as the pile has rows: a pile that is dropped bounces, as if it was elastic.
/// Here the impulses of all contacts, the loads, are multiplied by 1 + s, with one s for each node of a
/// coarse grid and bilinear between them, the s of a contact being the mean of those of its bodies. Loads
/// nearly balance gravity, body by body, so with a smooth s what they change is smooth as well: whole regions
/// are stopped. The s are those that leave the least kinetic energy E relative to what the contacts allow,
///
///     E(s) = E(0) + r·s + s·A s / 2,    s >= kLeast
///
/// with r_k the rate at which node k changes E and A_kl the product of the momenta that nodes k and l bring
/// about, over the mass, summed over bodies. That is the coarse level of a multigrid method whose smooth
/// vectors are the loads themselves. r is exact; A takes s to be linear around each body.
///
/// Impulses act on both bodies of a contact, so momentum is kept; they push, and friction stays within its
/// limit. E cannot grow, unless A is off by more than a factor of two.
///
/// Loads last from substep to substep. Loads that stop in one substep a motion that took n to come about
/// would turn it back in the next ones, so the contacts keep 1/n of the change. Numbers:
/// docs/decisions/0017-heave.md. Source: smoothed aggregation multigrid (Vanek, Mandel & Brezina 1996), whose
/// coarse space is made of the vectors that sweeps leave over.
template <class Real>
class CoarseCorrection {
  public:
    static constexpr std::size_t kFewestLoaded = 1024;  // bodies; in smaller piles a wave is soon through
    /// Likewise of slender piles, as columns in a shaft are: they have as many rows with fewer bodies.
    static constexpr std::size_t kFewestOfSlender = 64;

    /// To be called once a step: whether a correction is to follow. After one that did little pauses grow.
    /// @param substeps  of this step
    /// @param fewest  bodies that are corrected
    bool is_due(std::size_t bodies, int substeps, std::size_t fewest = kFewestLoaded);

    /// Makes room for the sums over contacts (kernels/contacts/coarse_correction.hpp) and clears them.
    void begin(std::size_t rows);

    /// Finds s of each row from the sums.
    /// @param motion  [rows][4], places of the bodies in the first two
    /// @param velocity  [rows][4], inverse masses in the last
    /// @param gain  m/s, what gravity adds in a substep
    /// Cost: O(bodies) and 20 sweeps over the nodes.
    /// @return false if too few bodies push on others, or few that are no slender pile: nothing is to be done
    /// then
    bool find_scale(std::size_t count, const Real* motion, const Real* velocity, double largest_radius,
                    Vec2 gain, const Executor& executor);

    Real* load() { return load_.data(); }
    Real* stress() { return stress_.data(); }
    const Real* scale() const { return scale_.data(); }
    double kept() const { return kept_; }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.pause_, self.substeps_since_);
    }

  private:
    static constexpr int kShortestPause = 8;  // substeps
    static constexpr std::size_t kParts = 8;  // parts that rows are cut into, for any number of threads
    /// Sums over loaded bodies.
    struct Extent {
        double count = 0, mass = 0, px = 0, py = 0, energy = 0, x = 0, y = 0, xx = 0, yy = 0;
    };
    /// Sums over the bodies of a cell for its four nodes, and for the ten pairs of them.
    struct Cell {
        std::array<double, 4> rate;
        std::array<double, 10> product;
        void add(double f, double g, Vec2 p, Vec2 x, Vec2 y, double of_rate, double inverse_mass);
    };
    struct Node {
        double s, rate;
        std::array<double, 9> product;  // with the nodes around it, line by line; itself in the middle
    };
    /// Place of a body on the grid.
    struct At {
        std::size_t i, j;  // cell along x and y
        double f, g;       // from its low left node to the next ones, 0 ... 1
    };
    At at_place(const Real* record) const {
        const double u = std::clamp((static_cast<double>(record[0]) - low_.x) * per_metre_, 0.0,
                                    static_cast<double>(width_ - 1)),
                     v = std::clamp((static_cast<double>(record[1]) - low_.y) * per_metre_, 0.0,
                                    static_cast<double>(height_ - 1));
        const auto i = std::min(static_cast<std::int32_t>(u), static_cast<std::int32_t>(width_ - 2)),
                   j = std::min(static_cast<std::int32_t>(v), static_cast<std::int32_t>(height_ - 2));
        return {static_cast<std::size_t>(i), static_cast<std::size_t>(j), u - i, v - j};
    }

    template <class Fn>
    void for_each_part(std::size_t count, double nanoseconds, const Executor& executor, const Fn& fn) const;
    void lay_out(std::size_t count, const Real* motion, const Real* velocity, double largest_radius,
                 const Executor& executor);
    void add_bodies(std::size_t count, const Real* motion, const Real* velocity, const Executor& executor);
    void add_cells();
    void solve();
    double drop() const;
    bool is_loaded(std::size_t row) const {
        return load_[4 * row] != 0 || load_[4 * row + 1] != 0 || stress_[4 * row] != 0;
    }

    int pause_ = kShortestPause, substeps_since_ = 0;
    double kept_ = 1;
    bool is_small_ = false;               // fewer than kFewestLoaded bodies push
    std::size_t fewest_ = kFewestLoaded;  // bodies that push, for a correction in this step

    Column<Real> load_, stress_, scale_;
    std::array<Extent, kParts> extents_;
    double mass_ = 0, energy_ = 0;  // kg, J around their centre of mass, of loaded bodies
    Vec2 low_;                      // m, first node
    double per_metre_ = 1;
    std::size_t width_ = 2, height_ = 2;  // nodes
    std::vector<Cell> cells_;             // of each part
    std::vector<Node> nodes_;
};

extern template class CoarseCorrection<float>;
extern template class CoarseCorrection<double>;

}  // namespace carom
