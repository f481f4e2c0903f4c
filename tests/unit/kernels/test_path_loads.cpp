// What coarse correction does to contacts along paths, against what the definition of each sum says of it.
#include "isa/select_isa.hpp"
#include "kernels/manifolds/manifold_arguments.hpp"
#include "kernels/paths/path_arguments.hpp"
#include "math/random.hpp"
#include "state/columns/column.hpp"
#include "support/equal_bits.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

namespace test_path_loads {

using namespace carom;
using carom::test::have_equal_bits;

namespace {

constexpr std::size_t kLength = 5, kRows = kPathLanes * (kLength + 1);

/// 16 paths of five contacts each; every third ends on what nothing moves. All contacts push.
template <class Real>
struct LoadedPaths {
    Column<PathLink<Real>> links;
    std::array<std::size_t, 2> first_link{0, kLength};
    Column<std::int32_t> heads;
    Column<Real> velocity, motion, load, stress, scale;

    LoadedPaths() {
        Random random(7);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random.next() % 10001) * 1e-4);
        };
        links.resize(kLength), heads.resize(kPathLanes), velocity.resize(4 * kRows);
        motion.resize(4 * kRows), load.resize(4 * kRows), stress.resize(4 * kRows), scale.resize(kRows);
        for (std::size_t row = 0; row < kRows; ++row) {
            for (std::size_t k = 0; k < 3; ++k) velocity[4 * row + k] = draw(-1, 1);
            velocity[4 * row + 3] = draw(0.5, 2);
            motion[4 * row] = draw(-9, 9), motion[4 * row + 1] = draw(-9, 9), scale[row] = draw(-0.5, 1);
        }
        for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
            heads[lane] = static_cast<std::int32_t>(lane * (kLength + 1));
            for (std::size_t i = 0; i < kLength; ++i) {
                PathLink<Real>& link = links[i];
                link.body[lane] = heads[lane] + static_cast<std::int32_t>(i) + 1;
                const double angle = static_cast<double>(draw(-3, 3));
                link.normal_x[lane] = static_cast<Real>(std::cos(angle));
                link.normal_y[lane] = static_cast<Real>(std::sin(angle));
                for (auto* lever : {&link.near1, &link.near2, &link.near_t, &link.far1, &link.far2,
                                    &link.far_t, &link.tangent})
                    (*lever)[lane] = draw(-1, 1);
                link.normal1[lane] = draw(0, 2), link.normal2[lane] = draw(0, 2);
                link.floor1[lane] = draw(-0.1, 0), link.floor2[lane] = draw(-0.1, 0);
            }
            if (lane % 3 == 0) {
                const auto last = static_cast<std::size_t>(links[kLength - 1].body[lane]);
                for (std::size_t k = 0; k < 4; ++k) velocity[4 * last + k] = 0;
                scale[last] = 0;
            }
        }
    }

    SolvePaths<Real> arguments(bool is_beside = false) {
        SolvePaths<Real> k{};
        k.links = links.data(), k.first_link = first_link.data(), k.heads = heads.data();
        k.velocity = velocity.data();
        k.coarse = {.load = load.data(),
                    .stress = stress.data(),
                    .scale = scale.data(),
                    .motion = motion.data(),
                    .last_row = static_cast<std::int32_t>(kRows) - 1,
                    .kept = Real(0.25),
                    .is_beside = is_beside};
        return k;
    }
    double kinetic_energy() const {
        double sum = 0;
        for (std::size_t row = 0; row < kRows; ++row) {
            const Real* v = &velocity[4 * row];
            const double w = v[3];  // rim masses are half of the masses
            if (w > 0) sum += 0.5 / w * (v[0] * v[0] + v[1] * v[1] + 0.5 * v[2] * v[2]);
        }
        return sum;
    }
    /// kg m/s, of what moves, along x and y.
    std::array<double, 2> momentum() const {
        std::array<double, 2> sum{};
        for (std::size_t row = 0; row < kRows; ++row)
            for (std::size_t k = 0; k < 2; ++k)
                if (velocity[4 * row + 3] > 0)
                    sum[k] += static_cast<double>(velocity[4 * row + k]) / velocity[4 * row + 3];
        return sum;
    }
    void set_scale(Real s) {
        for (std::size_t row = 0; row < kRows; ++row) scale[row] = velocity[4 * row + 3] > 0 ? s : Real(0);
    }
};

}  // namespace

TEST_SUITE("kernels/paths/path_loads") {
    TEST_CASE_TEMPLATE("loads are what scaling them changes momentum and energy by", Real, float, double) {
        const auto& kernels = runnable_kernel_tables().front()->of<Real>().convex->paths;
        const double tolerance = sizeof(Real) == 4 ? 1e-4 : 1e-10;
        LoadedPaths<Real> paths;
        kernels.sum_loads(paths.arguments(), 0, 1);
        std::vector<double> load(paths.load.begin(), paths.load.end());
        double rate = 0, free_energy = 0;
        for (std::size_t row = 0; row < kRows; ++row)
            if (paths.velocity[4 * row + 3] > 0) rate += load[4 * row + 2];
        // Without floors the rate is that of kinetic energy: what they allow of it is taken off.
        for (std::size_t i = 0; i < kLength; ++i)
            for (std::size_t lane = 0; lane < kPathLanes; ++lane)
                free_energy +=
                    static_cast<double>(paths.links[i].normal1[lane] * paths.links[i].floor1[lane] +
                                        paths.links[i].normal2[lane] * paths.links[i].floor2[lane]);
        const Column<Real> before = paths.velocity;
        constexpr double kSmall = 1e-3;
        paths.set_scale(static_cast<Real>(kSmall));
        kernels.scale_loads(paths.arguments(), 0, 1);
        for (std::size_t row = 0; row < kRows; ++row)
            for (std::size_t k = 0; k < 2; ++k) {
                const double w = before[4 * row + 3];
                const double change = static_cast<double>(paths.velocity[4 * row + k]) - before[4 * row + k];
                CHECK(std::fabs(change - kSmall * w * load[4 * row + k]) < kSmall * tolerance * 10);
            }
        // To second order: the difference of both ways round.
        const double more = paths.kinetic_energy();
        LoadedPaths<Real> other;
        other.set_scale(static_cast<Real>(-kSmall));
        kernels.scale_loads(other.arguments(), 0, 1);
        const double slope = (more - other.kinetic_energy()) / (2 * kSmall);
        CHECK(std::fabs(slope - (rate + free_energy)) <
              (sizeof(Real) == 4 ? 2e-2 : 1e-8) * (1 + std::fabs(slope)));
    }

    TEST_CASE_TEMPLATE("stress is what loads change by where s has a gradient", Real, float, double) {
        const auto& kernels = runnable_kernel_tables().front()->of<Real>().convex->paths;
        LoadedPaths<Real> paths;
        kernels.sum_loads(paths.arguments(), 0, 1);
        const Column<Real> before = paths.velocity;
        constexpr double kSlopeX = 1e-3, kSlopeY = -2e-3;
        const auto s_at = [&](std::size_t row) {
            return kSlopeX * static_cast<double>(paths.motion[4 * row]) +
                   kSlopeY * static_cast<double>(paths.motion[4 * row + 1]);
        };
        for (std::size_t row = 0; row < kRows; ++row)
            paths.scale[row] = before[4 * row + 3] > 0 ? static_cast<Real>(s_at(row)) : Real(0);
        kernels.scale_loads(paths.arguments(), 0, 1);
        for (std::size_t row = 0; row < kRows; ++row) {
            const double w = before[4 * row + 3];
            for (std::size_t k = 0; k < 2; ++k) {
                const double expected =
                    w * (s_at(row) * static_cast<double>(paths.load[4 * row + k]) +
                         kSlopeX * static_cast<double>(paths.stress[4 * row + 2 * k]) +
                         kSlopeY * static_cast<double>(paths.stress[4 * row + 2 * k + 1]));
                const double change = static_cast<double>(paths.velocity[4 * row + k]) - before[4 * row + k];
                CHECK(std::fabs(change - expected) < (sizeof(Real) == 4 ? 2e-6 : 1e-12));
            }
        }
    }

    TEST_CASE_TEMPLATE("scaling keeps momentum, pushes and the share of friction; a part of it lasts", Real,
                       float, double) {
        const auto& kernels = runnable_kernel_tables().front()->of<Real>().convex->paths;
        LoadedPaths<Real> paths;
        for (std::size_t lane = 0; lane < kPathLanes; ++lane) {  // no path ends on what nothing moves
            Real* last = &paths.velocity[4 * static_cast<std::size_t>(paths.links[kLength - 1].body[lane])];
            last[3] = 1;
        }
        const Column<PathLink<Real>> links = paths.links;
        const auto before = paths.momentum();
        kernels.scale_loads(paths.arguments(), 0, 1);
        const auto after = paths.momentum();
        for (std::size_t k = 0; k < 2; ++k) CHECK(std::fabs(after[k] - before[k]) < 1e-4);
        const Column<PathLink<Real>> scaled = paths.links;
        kernels.retain_loads(paths.arguments(), 0, 1);
        for (std::size_t i = 0; i < kLength; ++i)
            for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
                const double was = links[i].normal1[lane], is = scaled[i].normal1[lane];
                CHECK(scaled[i].normal2[lane] >= 0);
                CHECK(is >= 0);
                const double share = static_cast<double>(links[i].tangent[lane]) / was;
                CHECK(std::fabs(static_cast<double>(scaled[i].tangent[lane]) / is - share) <
                      1e-4 * (1 + std::fabs(share)));
                CHECK(std::fabs(static_cast<double>(paths.links[i].normal1[lane]) -
                                (was + 0.25 * (is - was))) < 1e-5);
            }
    }

    TEST_CASE_TEMPLATE("every instruction set gives the same bits, beside the paths as along them", Real,
                       float, double) {
        LoadedPaths<Real> first;
        bool is_first = true;
        for (const KernelTables* table : runnable_kernel_tables())
            for (const bool is_beside : {false, true}) {
                const auto& kernels = table->of<Real>().convex->paths;
                LoadedPaths<Real> paths;
                const SolvePaths<Real> k = paths.arguments(is_beside);
                kernels.sum_loads(k, 0, 1), kernels.scale_loads(k, 0, 1), kernels.retain_loads(k, 0, 1);
                if (is_first) first = paths, is_first = false;
                CHECK(have_equal_bits(paths.velocity, first.velocity));
                CHECK(have_equal_bits(paths.load, first.load));
                CHECK(have_equal_bits(paths.stress, first.stress));
                CHECK(have_equal_bits(paths.links, first.links));
            }
    }
}

}  // namespace test_path_loads
