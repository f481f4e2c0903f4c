#pragma once

#include <carom/world.hpp>

namespace carom::test {

/// What the ledger may leave unexplained, as a part of the energy scale.
template <class Real>
inline constexpr double kBooksClose = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;

/// The energy a scene has to do with [J]: what it started with, and what each cause gave or took.
double energy_scale(const Ledger& ledger);

/// Checks that a world's ledger closes, in energy against `scale` [J], in momentum against the momentum
/// sqrt(2 mass scale) that such an energy can carry and against all the impulses that were given; and that
/// the entries are what they say: they add up to the changes, and have the sign of their cause.
template <class Real>
void check_books_close(const BasicWorld<Real>& world, double scale, double mass);

/// The same against the ledger's own scale.
template <class Real>
void check_books_close(const BasicWorld<Real>& world, double mass = 1);

extern template void check_books_close(const BasicWorld<float>&, double, double);
extern template void check_books_close(const BasicWorld<double>&, double, double);
extern template void check_books_close(const BasicWorld<float>&, double);
extern template void check_books_close(const BasicWorld<double>&, double);

}  // namespace carom::test
