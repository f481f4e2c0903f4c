#include "support/books.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace carom::test {
namespace {

double size_of(Vec2 v) {
    return std::abs(v.x) + std::abs(v.y);
}

/// The momenta a scene has to do with [kg m/s].
double momentum_scale(const Ledger& ledger) {
    const MomentumByCause& by = ledger.momentum_by_cause;
    return size_of(ledger.initial_momentum) + size_of(by.gravity) + size_of(by.drag) + ledger.wall_impulse +
           size_of(by.immovable) + size_of(by.outside);
}

void check_sums(const Ledger& ledger, double scale) {
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * scale;
    const EnergyByCause& by = ledger.energy_by_cause;
    const double gained =
        ledger.energy.kinetic + ledger.energy.rotational - ledger.initial.kinetic - ledger.initial.rotational;
    CHECK(std::abs(gained - by.sum()) <= rounding);
    CHECK(std::abs(ledger.energy.total() - ledger.initial.total() - (by.sum() - by.gravity)) <= rounding);
    CHECK(by.drag <= rounding);
    // forces of contacts at rest are iterated and end slow separations: they may do a trace of work
    CHECK(by.restitution <= 1e-6 * scale);
    CHECK(by.friction <= 1e-6 * scale);
    CHECK(by.joints == 0);
}

}  // namespace

double energy_scale(const Ledger& ledger) {
    const EnergyByCause& by = ledger.energy_by_cause;
    return std::abs(ledger.initial.kinetic) + std::abs(ledger.initial.rotational) + std::abs(by.gravity) +
           std::abs(by.drag) + std::abs(by.restitution) + std::abs(by.friction) + std::abs(by.correction) +
           std::abs(by.drive) + std::abs(by.outside);
}

template <class Real>
void check_books_close(const BasicWorld<Real>& world, double scale, double mass) {
    const Ledger ledger = world.ledger();
    check_sums(ledger, std::fmax(scale, energy_scale(ledger)));
    const double unexplained = ledger.energy_by_cause.unexplained;
    CAPTURE(unexplained);
    CAPTURE(scale);
    CHECK(std::abs(unexplained) <= kBooksClose<Real> * scale);

    const double momentum = std::fmax(std::sqrt(2 * mass * scale), momentum_scale(ledger));
    const Vec2 unexplained_momentum = ledger.momentum_by_cause.unexplained;
    CAPTURE(unexplained_momentum.x);
    CAPTURE(unexplained_momentum.y);
    CAPTURE(momentum);
    CHECK(size_of(unexplained_momentum) <= kBooksClose<Real> * momentum);
}

template <class Real>
void check_books_close(const BasicWorld<Real>& world, double mass) {
    check_books_close(world, energy_scale(world.ledger()), mass);
}

template void check_books_close(const BasicWorld<float>&, double, double);
template void check_books_close(const BasicWorld<double>&, double, double);
template void check_books_close(const BasicWorld<float>&, double);
template void check_books_close(const BasicWorld<double>&, double);

}  // namespace carom::test
