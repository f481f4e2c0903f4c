// Contacts that share bodies: sweeps over the colours of a chain, against the exact solution of all its
// contacts.
#include "isa/select_isa.hpp"
#include "state/columns/column.hpp"
#include "support/complementarity.hpp"
#include "support/disc_contact.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace test_solve_chains {

using namespace carom;
using namespace carom::test;

namespace {

constexpr std::size_t kDiscs = 9;

/// Discs in a zigzag, each in contact with the next one and some with a plane, thrown about. A chain has two
/// colours of pairs, and one of supports: each has a batch of its own here.
template <class Real>
struct ChainOfDiscs {
    std::vector<RigidDisc> discs{kDiscs};
    RigidDisc plane;
    std::vector<DiscContact> contacts;  // pairs, then supports
    std::size_t pairs = 0;
    Column<std::int32_t> a, b;
    Column<Real> normal_x, normal_y, mass, along, tangent, floor, surface, velocity;

    ChainOfDiscs(unsigned seed, double friction) {
        std::mt19937 random(seed);
        const auto draw = [&](double low, double high) -> long double {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random() % 10001) * 1e-4);
        };
        for (RigidDisc& disc : discs) {
            disc = RigidDisc::of_mass(1 / draw(0.5, 2), 0.5);
            disc.velocity = {draw(-1, 1), draw(-1, 1)};
        }
        const auto unit = [](long double angle) {
            return Vector{static_cast<Real>(std::cos(angle)), static_cast<Real>(std::sin(angle))};
        };
        for (std::size_t i = 0; i + 1 < kDiscs; ++i)
            contacts.push_back({&discs[i], &discs[i + 1], unit(draw(-0.8, 0.8)), friction});
        pairs = contacts.size();
        for (const std::size_t i : {0u, 4u, 8u})
            contacts.push_back({&discs[i], &plane, unit(-1.5707963L + draw(-0.3, 0.3)), friction});
        for (DiscContact& c : contacts) c.floor = draw(-0.1, 0);
        lay_out();
    }
    ChainOfDiscs(const ChainOfDiscs&) = delete;

    /// Place of a contact: even pairs, odd pairs, supports.
    std::size_t place(std::size_t contact) const {
        if (contact >= pairs) return 2 * kContactBlock + contact - pairs;
        return contact % 2 * kContactBlock + contact / 2;
    }

    void lay_out() {
        const auto dummy = static_cast<std::int32_t>(kDiscs);
        a.resize(3 * kContactBlock), b.resize(3 * kContactBlock);
        std::fill(a.begin(), a.end(), dummy), std::fill(b.begin(), b.end(), dummy);
        for (Column<Real>* column : {&normal_x, &normal_y, &mass, &along, &tangent, &floor, &surface})
            column->resize(3 * kContactBlock);
        velocity.resize(4 * (kDiscs + 1));
        for (std::size_t i = 0; i < kDiscs; ++i) {
            velocity[4 * i] = static_cast<Real>(discs[i].velocity.x);
            velocity[4 * i + 1] = static_cast<Real>(discs[i].velocity.y);
            velocity[4 * i + 3] = static_cast<Real>(discs[i].inverse_mass);
        }
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const std::size_t at = place(i);
            const DiscContact& c = contacts[i];
            a[at] = static_cast<std::int32_t>(c.a - discs.data());
            if (i < pairs) b[at] = static_cast<std::int32_t>(c.b - discs.data());
            normal_x[at] = static_cast<Real>(c.normal.x), normal_y[at] = static_cast<Real>(c.normal.y);
            mass[at] = static_cast<Real>(1 / (c.a->inverse_mass + c.b->inverse_mass));
            floor[at] = static_cast<Real>(c.floor);
        }
    }

    void sweep(const ContactKernels<Real>& kernels, double friction, int times) {
        SolveContacts<Real> k{};
        k.contacts.a = a.data(), k.contacts.b = b.data();
        k.contacts.normal_x = normal_x.data(), k.contacts.normal_y = normal_y.data();
        k.contacts.mass = mass.data(), k.contacts.normal_impulse = along.data();
        k.contacts.friction_impulse = tangent.data(), k.contacts.floor = floor.data();
        k.velocity = velocity.data(), k.uniform_friction = static_cast<Real>(friction);
        SolveContacts<Real> of_supports = k;
        of_supports.contacts.b = nullptr;
        of_supports.contacts.surface_normal = of_supports.contacts.surface_tangent = surface.data();
        for (int i = 0; i < times; ++i) {
            kernels.next_pairs(k, 0, 2 * kContactBlock);
            kernels.next_supports(of_supports, 2 * kContactBlock, 3 * kContactBlock);
        }
    }

    /// Takes what the kernels came to into the discs and contacts of the reference.
    void read_back() {
        for (std::size_t i = 0; i < kDiscs; ++i) {
            const Real* v = velocity.data() + 4 * i;
            discs[i].velocity = {v[0], v[1]}, discs[i].spin = v[2] / discs[i].radius;
        }
        for (std::size_t i = 0; i < contacts.size(); ++i)
            contacts[i].along = along[place(i)], contacts[i].tangent = tangent[place(i)];
    }

    /// Impulses that satisfy the normal law of all contacts at once, without friction.
    std::vector<long double> exact_impulses() const {
        Complementarity problem(contacts.size());
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            problem.b(i) = contacts[i].normal_velocity() - contacts[i].floor;
            for (std::size_t j = 0; j < contacts.size(); ++j) {
                const auto shared = [&](const RigidDisc* disc) {
                    const auto side = [disc](const DiscContact& c) {
                        return c.a == disc ? -1.0L : c.b == disc ? 1.0L : 0.0L;
                    };
                    return disc->inverse_mass * side(contacts[i]) * side(contacts[j]) *
                           dot(contacts[i].normal, contacts[j].normal);
                };
                problem.a(i, j) = shared(contacts[i].a) + shared(contacts[i].b);
            }
        }
        return problem.solve();
    }
};

}  // namespace

TEST_SUITE("kernels/solve chains") {
    TEST_CASE_TEMPLATE("sweeps converge to the impulses that satisfy all contacts of a chain", Real, float,
                       double) {
        constexpr long double kAllowed =  // an ill-conditioned chain takes a part of the digits
            1000 * std::numeric_limits<Real>::epsilon();
        for (unsigned seed = 1; seed <= 12; ++seed) {
            std::vector<long double> exact;
            for (const KernelTables* tables : runnable_kernel_tables()) {
                ChainOfDiscs<Real> chain(seed, 0);
                if (exact.empty()) exact = chain.exact_impulses();
                REQUIRE(exact.size() == chain.contacts.size());
                chain.sweep(tables->of<Real>().contacts[0], 0, 2000);
                long double worst = 0, largest = 0;
                for (std::size_t i = 0; i < exact.size(); ++i) {
                    worst = std::max(worst, std::fabs(chain.along[chain.place(i)] - exact[i]));
                    largest = std::max(largest, exact[i]);
                }
                CHECK(worst <= kAllowed);
                CHECK(largest > 0.1L);
            }
        }
    }

    TEST_CASE_TEMPLATE("sweeps with friction end where every contact of a chain sticks, slides or parts",
                       Real, float, double) {
        constexpr long double kAllowed =  // an ill-conditioned chain takes a part of the digits
            1000 * std::numeric_limits<Real>::epsilon();
        for (unsigned seed = 1; seed <= 12; ++seed)
            for (const KernelTables* tables : runnable_kernel_tables()) {
                const double friction = 0.0625 * (1 + seed % 4);
                ChainOfDiscs<Real> chain(seed, friction);
                Vector before, after;
                for (const RigidDisc& d : chain.discs) before = before + 1 / d.inverse_mass * d.velocity;
                chain.sweep(tables->of<Real>().contacts[1], friction, 2000);
                chain.read_back();
                long double worst = 0;
                for (const DiscContact& c : chain.contacts) worst = std::max(worst, c.violation());
                CHECK(worst <= kAllowed);
                // What the discs have more or less than before is what the plane gave them.
                for (const RigidDisc& d : chain.discs) after = after + 1 / d.inverse_mass * d.velocity;
                for (std::size_t i = chain.pairs; i < chain.contacts.size(); ++i) {
                    const DiscContact& c = chain.contacts[i];
                    before = before - (c.along * c.normal + c.tangent * turned(c.normal));
                }
                CHECK(std::fabs(after.x - before.x) <= 10 * kAllowed);
                CHECK(std::fabs(after.y - before.y) <= 10 * kAllowed);
            }
    }
}

}  // namespace test_solve_chains
