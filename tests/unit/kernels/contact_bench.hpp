#pragma once

#include "isa/kernel_table.hpp"
#include "state/columns/column.hpp"
#include "support/disc_contact.hpp"

#include <cstdint>
#include <random>
#include <vector>

namespace carom::test {

/// What contacts a bench has, and how they are told to the kernels.
struct BenchKind {
    std::size_t variant = 0;  // of KernelTable::contacts
    bool is_support = false;
    bool is_uniform = false;  // one radius, one friction, one rolling resistance: no columns for these

    bool is_rough() const { return variant >= 1; }
    bool rolls() const { return variant >= 3; }
    bool some_are_fixed() const { return variant == 2 || variant == 4; }
};

/// Contacts that share no body, in the middle of longer columns: a block of sentinels before and behind them,
/// and behind the last contact padding as the solver has it, contacts of a row without mass. Beside each
/// stands its reference.
template <class Real>
struct ContactBench {
    static constexpr std::size_t kFirst = kContactBlock;
    static constexpr Real kSentinel = Real(-77);
    static constexpr long double kH = 0.004L, kElapsed = 0.008L;  // s

    BenchKind kind;
    std::size_t count, last;       // of the columns that kernels may use
    std::size_t end;               // what kernels are called with: the last block may be half a one
    std::vector<RigidDisc> discs;  // 2 i and 2 i + 1 are those of contact i
    std::vector<DiscContact> expected;
    std::vector<long double> separation;  // m, at the start of the step
    std::vector<std::int32_t> row_of;     // of each disc
    std::int32_t dummy;                   // row that padding names
    Column<std::int32_t> a, b;
    Column<Real> normal_x, normal_y, start_separation, mass, along, tangent, friction, floor, surface_normal,
        surface_tangent, roll, rolling, share, surface_rolling;
    Column<Real> velocity, displacement;
    Column<std::uint8_t> needs_second_sweep;
    Real uniform_friction = Real(0.4), uniform_rolling = Real(0.2);

    ContactBench(BenchKind of, std::size_t contacts, unsigned seed)
        : kind(of),
          count(contacts),
          last(kFirst + padded(contacts)),
          end(kFirst + (contacts + kHalfBlock - 1) / kHalfBlock * kHalfBlock),
          random_(seed) {
        const std::size_t length = last + kContactBlock;
        for (Column<std::int32_t>* column : {&a, &b}) fill(*column, length, dummy_row());
        dummy = dummy_row();
        for (Column<Real>* column : columns()) {
            fill(*column, length, kSentinel);
            for (std::size_t c = kFirst + count; c < last; ++c) (*column)[c] = 0;
        }
        fill(needs_second_sweep, length / kContactBlock, std::uint8_t{0});
        const std::size_t rows = static_cast<std::size_t>(dummy) + 1;
        velocity.resize(4 * rows), displacement.resize(2 * rows);
        for (std::size_t disc = 0; disc < 2 * count; ++disc)
            row_of.push_back(static_cast<std::int32_t>(disc));
        std::shuffle(row_of.begin(), row_of.end(), random_);
        discs.resize(2 * count), expected.resize(count), separation.resize(count);
        for (std::size_t i = 0; i < count; ++i) draw(i);
    }
    ContactBench(const ContactBench&) = delete;  // the reference has pointers

    SolveContacts<Real> arguments() {
        SolveContacts<Real> k{};
        k.contacts.a = a.data(), k.contacts.b = kind.is_support ? nullptr : b.data();
        k.contacts.normal_x = normal_x.data(), k.contacts.normal_y = normal_y.data();
        k.contacts.separation = start_separation.data(), k.contacts.mass = mass.data();
        k.contacts.normal_impulse = along.data(), k.contacts.floor = floor.data();
        if (kind.is_rough()) {
            k.contacts.friction_impulse = tangent.data();
            if (!kind.is_uniform) k.contacts.friction = friction.data();
        }
        if (kind.is_support) {
            k.contacts.surface_normal = surface_normal.data();
            k.contacts.surface_tangent = surface_tangent.data();
        }
        if (kind.rolls()) {
            k.contacts.rolling_impulse = roll.data();
            if (!kind.is_uniform) k.contacts.rolling = rolling.data();
            if (!kind.is_uniform || kind.is_support) k.contacts.rolling_share = share.data();
            if (kind.is_support) k.contacts.surface_rolling = surface_rolling.data();
        }
        k.velocity = velocity.data(), k.displacement = displacement.data();
        k.uniform_friction = uniform_friction, k.uniform_rolling = uniform_rolling;
        k.h = static_cast<Real>(kH), k.inverse_h = static_cast<Real>(1 / kH);
        k.elapsed = static_cast<Real>(kElapsed);
        k.recovery = Real(0.4), k.push = Real(0.003);
        k.calm = Real(-1), k.over_relaxation = Real(1), k.calm_over_relaxation = Real(1);
        k.needs_second_sweep = needs_second_sweep.data();
        return k;
    }

    const Real* record(std::size_t disc) const {
        return velocity.data() + 4 * static_cast<std::size_t>(row_of[disc]);
    }
    /// Largest difference of a moving disc's velocities from the reference [m/s].
    long double velocity_error(std::size_t disc) const {
        const RigidDisc& d = discs[disc];
        const Real* v = record(disc);
        return std::max({std::fabs(v[0] - d.velocity.x), std::fabs(v[1] - d.velocity.y),
                         std::fabs(v[2] - d.spin * d.radius)});
    }
    bool moves(std::size_t disc) const { return !kind.is_support || disc % 2 == 0; }
    /// Separation at the time of the sweep [m].
    long double separation_now(std::size_t i) const {
        const DiscContact& c = expected[i];
        const Vector by_surface = kind.is_support
                                      ? static_cast<long double>(static_cast<Real>(kElapsed)) * c.b->velocity
                                      : c.b->moved;
        return separation[i] + dot(by_surface - c.a->moved, c.normal);
    }
    /// What is outside of [kFirst, last), and the row without mass, must not be written.
    bool is_rest_untouched() const {
        for (const Column<Real>* column : const_cast<ContactBench*>(this)->columns())
            for (std::size_t c = 0; c < column->size(); ++c)
                if ((c < kFirst || c >= last) && (*column)[c] != kSentinel) return false;
        for (std::size_t k = 0; k < 4; ++k)
            if (velocity[4 * static_cast<std::size_t>(dummy) + k] != 0) return false;
        for (std::size_t k = 0; k < 2; ++k)
            if (displacement[2 * static_cast<std::size_t>(dummy) + k] != 0) return false;
        return needs_second_sweep[0] == 0 && needs_second_sweep[last / kContactBlock] == 0;
    }

  private:
    template <class T>
    static void fill(Column<T>& column, std::size_t size, T value) {
        column.resize(size);
        std::fill(column.begin(), column.end(), value);
    }
    std::int32_t dummy_row() const { return static_cast<std::int32_t>(2 * count + 3); }
    std::vector<Column<Real>*> columns() {
        return {&normal_x,        &normal_y,       &start_separation, &mass, &along,   &tangent,
                &friction,        &floor,          &surface_normal,   &roll, &rolling, &share,
                &surface_rolling, &surface_tangent};
    }
    /// Uniform in [low, high], a number that Real has.
    long double draw(double low, double high) {
        const double u = static_cast<double>(random_() % 1000001) * 1e-6;
        return static_cast<Real>(low + u * (high - low));
    }

    void draw_disc(std::size_t disc, bool moves) {
        const long double radius = kind.is_uniform ? static_cast<Real>(0.5) : draw(0.3, 1);
        const bool turns = !kind.some_are_fixed() || random_() % 3 != 0;
        const long double inverse_mass = draw(0.2, 3), rim = draw(-1, 1);
        RigidDisc& d = discs[disc];
        d = RigidDisc::of_mass(1 / inverse_mass, radius, turns);
        d.velocity = {draw(-1, 1), draw(-1, 1)};
        d.spin = kind.is_rough() && (turns || !moves) ? rim / radius : 0;
        if (!moves) {
            d.inverse_mass = d.inverse_inertia = 0;
            return;
        }
        d.moved = {draw(-0.01, 0.01), draw(-0.01, 0.01)};
        Real* v = velocity.data() + 4 * static_cast<std::size_t>(row_of[disc]);
        v[0] = static_cast<Real>(d.velocity.x), v[1] = static_cast<Real>(d.velocity.y);
        v[2] = static_cast<Real>(d.spin * radius);
        v[3] = static_cast<Real>(turns ? inverse_mass : -inverse_mass);
        Real* x = displacement.data() + 2 * static_cast<std::size_t>(row_of[disc]);
        x[0] = static_cast<Real>(d.moved.x), x[1] = static_cast<Real>(d.moved.y);
    }

    void draw(std::size_t i) {
        draw_disc(2 * i, true), draw_disc(2 * i + 1, !kind.is_support);
        DiscContact& c = expected[i];
        c.a = &discs[2 * i], c.b = &discs[2 * i + 1];
        const long double angle = draw(-3.14, 3.14);
        // The reference has the normal as the kernel has it, which is a unit vector but for round-off.
        c.normal = {static_cast<Real>(std::cos(angle)), static_cast<Real>(std::sin(angle))};
        c.friction = !kind.is_rough() ? 0 : kind.is_uniform ? uniform_friction : draw(0, 0.8);
        c.rolling = !kind.rolls() ? 0 : kind.is_uniform ? uniform_rolling : draw(0, 0.5);
        if (random_() % 4 != 0) c.along = draw(0, 0.5);
        c.tangent = static_cast<Real>(c.friction * c.along * draw(-1, 1));
        c.roll = static_cast<Real>(c.rolling * c.along * draw(-1, 1));
        separation[i] = draw(-0.02, 0.02);
        const std::size_t at = kFirst + i;
        const auto set = [at](Column<Real>& column, long double value) {
            column[at] = static_cast<Real>(value);
        };
        a[at] = row_of[2 * i], b[at] = row_of[2 * i + 1];
        set(normal_x, c.normal.x), set(normal_y, c.normal.y), set(start_separation, separation[i]);
        set(mass, 1 / (c.a->inverse_mass + c.b->inverse_mass));
        set(along, c.along), set(tangent, c.tangent), set(roll, c.roll);
        set(friction, c.friction), set(rolling, c.rolling);
        set(share, c.b->radius / (c.a->radius + c.b->radius));
        c.floor = draw(-0.3, 0);
        set(floor, c.floor);
        if (!kind.is_support) return;
        set(surface_normal, dot(c.b->velocity, c.normal));
        set(surface_tangent, dot(c.b->velocity_at(c.arm_b()), turned(c.normal)));
        set(surface_rolling, c.reduced_radius() * c.b->spin);
    }

    std::mt19937 random_;
};

}  // namespace carom::test
