#include "kernels/kernel_benchmark.hpp"
#include "state/columns/column.hpp"

#include <numeric>
#include <random>

// The kernels of the solver `soft`: contacts of one colour, so that each body is in one contact, with
// friction and rotation. Items are contacts, candidates or bodies.

namespace carom::bench {
namespace {

constexpr double kStep = 1.0 / 60, kSubstep = kStep / 4;  // s
constexpr std::size_t kRoughContacts = 1, kTurning = 1;   // which of the kernels' variants

template <class Real>
Column<Real> filled(std::size_t rows, double value) {
    Column<Real> column(rows);
    for (Real& each : column) each = static_cast<Real>(value);
    return column;
}

/// Pairs of discs on top of each other that press on each other and overlap a little, rows 2 c and 2 c + 1.
template <class Real>
struct PressedPairs {
    explicit PressedPairs(std::size_t count)
        : a(count),
          b(count),
          normal_x(count),
          normal_y(filled<Real>(count, 1)),
          separation(filled<Real>(count, -0.001)),
          mass(filled<Real>(count, 0.5)),
          normal_impulse(filled<Real>(count, 0.02)),
          friction_impulse(count),
          floor(count),
          velocity(8 * count),
          displacement(4 * count),
          needs_second_sweep(count / kContactBlock) {
        std::mt19937 random(19);
        std::uniform_real_distribution<double> speed(-0.1, 0.1);
        for (std::size_t c = 0; c < count; ++c) {
            a[c] = static_cast<std::int32_t>(2 * c);
            b[c] = static_cast<std::int32_t>(2 * c + 1);
        }
        for (std::size_t row = 0; row < 2 * count; ++row) {
            for (std::size_t i = 0; i < 3; ++i) velocity[4 * row + i] = static_cast<Real>(speed(random));
            velocity[4 * row + 3] = 1;  // inverse mass
        }
    }

    SolveContacts<Real> arguments() {
        return {.contacts = {.a = a.data(),
                             .b = b.data(),
                             .normal_x = normal_x.data(),
                             .normal_y = normal_y.data(),
                             .separation = separation.data(),
                             .mass = mass.data(),
                             .normal_impulse = normal_impulse.data(),
                             .friction_impulse = friction_impulse.data(),
                             .friction = nullptr,
                             .floor = floor.data(),
                             .surface_normal = nullptr,
                             .surface_tangent = nullptr,
                             .rolling_impulse = nullptr,
                             .rolling = nullptr,
                             .rolling_share = nullptr,
                             .surface_rolling = nullptr,
                             .smaller = nullptr},
                .velocity = velocity.data(),
                .displacement = displacement.data(),
                .uniform_friction = Real(0.5),
                .uniform_rolling = 0,
                .inverse_h = static_cast<Real>(1 / kSubstep),
                .h = static_cast<Real>(kSubstep),
                .elapsed = 0,
                .recovery = Real(0.1),
                .push = Real(0.0001),
                .slop = 0,
                .calm = 0,
                .over_relaxation = Real(1.7),
                .calm_over_relaxation = Real(1.4),
                .needs_second_sweep = needs_second_sweep.data()};
    }

    Column<std::int32_t> a, b;
    Column<Real> normal_x, normal_y, separation, mass, normal_impulse, friction_impulse, floor;
    Column<Real> velocity, displacement;
    Column<std::uint8_t> needs_second_sweep;
};

/// @param numbers     of an item, read and written
/// @param operations  of an item
template <class Real, class Pick>
void solve(benchmark::State& state, const KernelTable<Real>& table, double numbers, double operations,
           const Pick& pick) {
    const auto items = static_cast<std::size_t>(state.range(0));
    PressedPairs<Real> pairs(items);
    const SolveContacts<Real> arguments = pairs.arguments();
    const auto kernel = pick(table.contacts[kRoughContacts]);
    const measure::Work work{.bytes = 8 + numbers * sizeof(Real), .operations = operations};
    // rows; normal, separation, mass, two impulses, floor; two records of velocity and displacement
    const std::size_t held = 8 + (7 + 2 * 4 + 2 * 2) * sizeof(Real);
    time_kernel(state, {work, items, held * items}, [&] { kernel(arguments, 0, items); });
}

/// Contacts of which a chosen share is near enough to touch; each body is in two, as in find_impacts.
template <class Real>
void find_contacts(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    const double share = static_cast<double>(state.range(1)) / 100;
    PressedPairs<Real> out(items);
    Column<Real> motion(4 * (items + 1)), reach(filled<Real>(items, 1));
    Column<std::int32_t> a(items), b(items);
    Column<std::uint8_t> is_live(items / kContactBlock);
    std::mt19937 random(23);
    std::uniform_real_distribution<double> unit(0, 1);
    for (std::size_t row = 1; row < items + 1; ++row)
        motion[4 * row] =
            static_cast<Real>(static_cast<double>(motion[4 * (row - 1)]) * (row % 1024 == 0 ? 0 : 1) +
                              (unit(random) < share ? 0.999 : 1.2));
    std::iota(a.begin(), a.end(), 0);
    std::iota(b.begin(), b.end(), 1);
    const FindContacts<Real> arguments{.motion = motion.data(),
                                       .a = a.data(),
                                       .b = b.data(),
                                       .reach = reach.data(),
                                       .smaller = nullptr,
                                       .normal_impulse = out.normal_impulse.data(),
                                       .friction_impulse = out.friction_impulse.data(),
                                       .rolling_impulse = nullptr,
                                       .normal_x = out.normal_x.data(),
                                       .normal_y = out.normal_y.data(),
                                       .separation = out.separation.data(),
                                       .approach = nullptr,
                                       .dt = static_cast<Real>(kStep),
                                       .near = Real(0.005),
                                       .near_of_smaller = 0,
                                       .deep = Real(-1),
                                       .is_live = is_live.data()};
    const auto kernel = table.find_contacts;
    const double hits = static_cast<double>(kernel(arguments, 0, items)) / static_cast<double>(items);
    const measure::Work work{.bytes = 8 + 12 * sizeof(Real), .operations = 40};
    time_kernel(state, {work, items, static_cast<std::size_t>(work.bytes) * items, hits},
                [&] { benchmark::DoNotOptimize(kernel(arguments, 0, items)); });
}

/// Bodies through a step of the solver: columns that the three kernels over bodies share.
template <class Real>
struct SubstepColumns {
    explicit SubstepColumns(std::size_t rows)
        : motion(filled<Real>(4 * rows, 0.1)),
          velocity(4 * rows),
          start_x(rows),
          start_y(rows),
          start_rim(rows),
          displacement(2 * rows),
          turn(rows),
          spin(filled<Real>(rows, 0.1)),
          x(rows),
          y(rows),
          vx(rows),
          vy(rows),
          angle(rows),
          lost(rows + kRowPadding) {}

    BeginSubsteps<Real> begin(std::size_t rows) {
        return {.motion = motion.data(),
                .angular_velocity = spin.data(),
                .radius = nullptr,
                .inverse_mass = nullptr,
                .uniform_radius = Real(0.5),
                .uniform_inverse_mass = 1,
                .gain_x = 0,
                .gain_y = static_cast<Real>(-10 * kSubstep),
                .decay = 1,
                .spin_decay = 1,
                .count = rows,
                .velocity = velocity.data(),
                .start = {start_x.data(), start_y.data(), start_rim.data()},
                .displacement = displacement.data(),
                .turn = turn.data()};
    }
    AdvanceBodies<Real> advance() {  // without gravity: it is called over and over
        return {.velocity = velocity.data(),
                .start = {start_x.data(), start_y.data(), start_rim.data()},
                .displacement = displacement.data(),
                .turn = turn.data(),
                .h = static_cast<Real>(kSubstep),
                .gain_x = 0,
                .gain_y = 0,
                .decay = 1,
                .spin_decay = 1,
                .is_last = false,
                .joined = nullptr,
                .nothing = 0};
    }
    EndSubsteps<Real> end() {
        return {.velocity = velocity.data(),
                .displacement = displacement.data(),
                .turn = turn.data(),
                .radius = nullptr,
                .uniform_radius = Real(0.5),
                .position_x = x.data(),
                .position_y = y.data(),
                .velocity_x = vx.data(),
                .velocity_y = vy.data(),
                .angle = angle.data(),
                .angular_velocity = spin.data(),
                .largest_position = Real(1e8),
                .largest_speed = Real(1e7),
                .lost = lost.data()};
    }

    Column<Real> motion, velocity, start_x, start_y, start_rim, displacement, turn, spin, x, y, vx, vy, angle;
    Column<std::int32_t> lost;
};

template <class Real>
void over_bodies(benchmark::State& state, const KernelTable<Real>& table, char which) {
    const auto items = static_cast<std::size_t>(state.range(0));
    SubstepColumns<Real> columns(items);
    const BeginSubsteps<Real> begin = columns.begin(items);
    const AdvanceBodies<Real> advance = columns.advance();
    const EndSubsteps<Real> end = columns.end();
    table.begin_substeps[kTurning](begin, 0, items);
    const std::size_t rows = items;
    if (which == 'b') {
        const measure::Work work{.bytes = 15 * sizeof(Real), .operations = 7};
        time_kernel(state, {work, rows, 15 * sizeof(Real) * rows},
                    [&] { table.begin_substeps[kTurning](begin, 0, rows); });
    } else if (which == 'a') {
        const measure::Work work{.bytes = 20 * sizeof(Real), .operations = 38};
        time_kernel(state, {work, rows, 10 * sizeof(Real) * rows},
                    [&] { table.advance_bodies[kTurning](advance, 0, rows); });
    } else {
        const measure::Work work{.bytes = 17 * sizeof(Real), .operations = 13};
        time_kernel(state, {work, rows, 13 * sizeof(Real) * rows},
                    [&] { benchmark::DoNotOptimize(table.end_substeps[kTurning](end, 0, rows)); });
    }
}

const bool kAdded = [] {
    add_kernel("find_contacts", true, [](auto& state, const auto& table) { find_contacts(state, table); });
    add_kernel("warm_start_pairs", false, [](auto& state, const auto& table) {
        solve(state, table, 20, 24, [](const auto& kernels) { return kernels.warm_start_pairs; });
    });
    add_kernel("first_pairs", false, [](auto& state, const auto& table) {
        solve(state, table, 33, 64, [](const auto& kernels) { return kernels.first_pairs; });
    });
    add_kernel("next_pairs", false, [](auto& state, const auto& table) {
        solve(state, table, 24, 45, [](const auto& kernels) { return kernels.next_pairs; });
    });
    add_kernel("begin_substeps", false,
               [](auto& state, const auto& table) { over_bodies(state, table, 'b'); });
    add_kernel("advance_bodies", false,
               [](auto& state, const auto& table) { over_bodies(state, table, 'a'); });
    add_kernel("end_substeps", false, [](auto& state, const auto& table) { over_bodies(state, table, 'e'); });
    return true;
}();

}  // namespace
}  // namespace carom::bench
