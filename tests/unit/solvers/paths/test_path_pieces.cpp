#include "solvers/paths/cut/path_pieces.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "isa/select_isa.hpp"
#include "math/random.hpp"
#include "narrowphase/convex.hpp"
#include "support/drawn_link.hpp"
#include "support/equal_bits.hpp"

namespace test_path_pieces {

using namespace carom;
using carom::test::have_equal_bits;

namespace {

/// A net of bodies that move at random, with contacts of neighbours in courses and across them that press at
/// random, cut into paths; one in 16 stands beside these.
template <class Real>
struct SharedNet {
    static constexpr std::int32_t kAcross = 24, kUp = 20, kBodies = kAcross * kUp;
    std::vector<ContactLink> contacts;
    PathCut cut;
    std::vector<typename PathPieces<Real>::Ends> ends;
    Column<PathLink<Real>> links;
    Column<std::int32_t> heads;
    Column<Real> velocity, displacement, turn, restless;
    Column<std::uint32_t> closing;
    std::int32_t still = kBodies;

    explicit SharedNet(std::uint64_t seed) {
        Random random(seed);
        const auto draw = [&](double low, double high) {
            return static_cast<Real>(low + (high - low) * static_cast<double>(random.next() % 10001) * 1e-4);
        };
        for (std::int32_t y = 0; y < kUp; ++y)
            for (std::int32_t x = 0; x < kAcross; ++x) {
                const std::int32_t body = y * kAcross + x;
                if (x + 1 < kAcross) contacts.push_back({body, body + 1, 0.5F, 0, -0.5F, 0, true});
                if (y + 1 < kUp) contacts.push_back({body, body + kAcross, 0, 0.5F, 0, -0.5F, true});
            }
        for (ContactLink& contact : contacts) contact.is_watched = random.next() % 16 == 0;
        cut.cut(contacts, kBodies, 12, Executor());
        velocity.resize(4 * (kBodies + 1)), displacement.resize(2 * (kBodies + 1)), turn.resize(kBodies + 1);
        for (std::size_t i = 0; i < 4 * kBodies; ++i)
            velocity[i] = i % 4 == 3 ? draw(0.5, 2) : draw(0.1, 1) * (random.next() % 2 == 0 ? 1 : -1);
        closing.resize(cut.bundles()), restless.resize(kPathLanes * cut.bundles());
        heads.resize(kPathLanes * cut.bundles()), links.resize(cut.links());
        for (std::size_t i = 0; i < heads.size(); ++i) heads[i] = still;
        for (std::size_t i = 0; i < links.size(); ++i) blank(links[i]);
        for (std::size_t n = 0; n < contacts.size(); ++n) {
            const PathCut::Place place = cut.places()[n];
            PathLink<Real>& link = links[place.link];
            const std::size_t lane = place.lane;
            ends.push_back({contacts[n].a, contacts[n].b});
            if (place.is_reversed) std::swap(ends[n][0], ends[n][1]);
            link.body[lane] = ends[n][1];
            if (cut.first_contacts()[kPathLanes * place.bundle + lane] == static_cast<std::int32_t>(n))
                heads[kPathLanes * place.bundle + lane] = ends[n][0];
            const auto angle = static_cast<double>(draw(0, 6));
            const Real friction = draw(0, 1);
            carom::test::draw_contact(link, lane, angle, friction, draw);
        }
        for (const PathCut::Jump& jump : cut.jumps())
            links[jump.link].body[jump.lane] = ends[static_cast<std::size_t>(jump.contact)][0];
    }

    void blank(PathLink<Real>& link) const {
        link = {};
        for (std::size_t lane = 0; lane < kPathLanes; ++lane) {
            link.body[lane] = still;
            link.separation1[lane] = link.separation2[lane] = static_cast<Real>(kNoPoint);
        }
    }
    /// Takes a contact away; the path goes on to where it led.
    void take(std::size_t n) {
        const PathCut::Place place = cut.places()[n];
        PathLink<Real> none;
        blank(none);
        for_each_column(none, links[place.link], [&](const auto* of, auto* here) {
            if (static_cast<const void*>(here) != links[place.link].body) here[place.lane] = of[place.lane];
        });
    }
    SolvePaths<Real> arguments() {
        SolvePaths<Real> k{};
        k.links = links.data(), k.first_link = cut.first_link().data(), k.heads = heads.data();
        k.velocity = velocity.data(), k.displacement = displacement.data(), k.turn = turn.data();
        k.restless = restless.data(), k.is_slender = cut.is_slender().data(), k.closing = closing.data();
        k.h = Real(0.004), k.inverse_h = 250, k.velocity_tolerance = Real(1e-5);
        return k;
    }
    /// One sweep over all contacts, as PathSolver has it.
    void sweep_all(const PathKernels<Real>& kernels, int most) {
        const SolvePaths<Real> k = arguments();
        const auto sweep_beside = [&](bool has_floors) {
            for (int i = 0; i < most; ++i) {
                (has_floors || i > 0 ? kernels.watch_again : kernels.watch)(k, cut.first_watched(),
                                                                            cut.bundles());
                if (kernels.settle(k, cut.first_watched(), cut.bundles()).closing == 0) return;
            }
        };
        sweep_beside(false);
        for (std::size_t colour = 0; colour < cut.colours(); ++colour)
            kernels.sweep(k, cut.first_bundle()[colour], cut.first_bundle()[colour + 1]);
        sweep_beside(true);
    }
    /// Contacts of some bodies, and two before and behind them along their paths.
    std::set<std::size_t> contacts_around(const std::set<std::int32_t>& bodies) const {
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> at;  // by link and lane
        for (std::size_t n = 0; n < contacts.size(); ++n)
            at[{cut.places()[n].link, cut.places()[n].lane}] = n;
        std::set<std::size_t> around;
        for (std::size_t n = 0; n < contacts.size(); ++n) {
            if (!bodies.contains(contacts[n].a) && !bodies.contains(contacts[n].b)) continue;
            around.insert(n);
            const PathCut::Place place = cut.places()[n];
            for (const int way : {-1, 1}) {
                std::size_t link = place.link;
                for (int i = 0; i < 2; ++i) {
                    link += static_cast<std::size_t>(way);
                    const auto beside = at.find({link, place.lane});
                    if (beside == at.end() || cut.places()[beside->second].bundle != place.bundle) break;
                    around.insert(beside->second);
                }
            }
        }
        return around;
    }
};

}  // namespace

TEST_SUITE("solvers/paths/path_pieces") {
    TEST_CASE_TEMPLATE("a sweep around some bodies is the sweep of a world without the other contacts", Real,
                       float, double) {
        const PathKernels<Real>& kernels = runnable_kernel_tables().front()->of<Real>().convex->paths;
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            CAPTURE(seed);
            SharedNet<Real> net(seed);
            Random random(seed);
            PathPieces<Real> pieces;
            pieces.list_contacts(net.cut, net.ends, SharedNet<Real>::kBodies + 1);
            pieces.remember(net.velocity);
            std::set<std::int32_t> restless;
            for (int i = 0; i < 12; ++i)
                restless.insert(static_cast<std::int32_t>(random.next() % SharedNet<Real>::kBodies));
            for (const std::int32_t body : restless)
                net.velocity[4 * static_cast<std::size_t>(body) + random.next() % 3] += Real(0.5);
            SharedNet<Real> only = net;
            const std::set<std::size_t> around = net.contacts_around(restless);
            REQUIRE(around.size() > 2 * restless.size());
            REQUIRE(around.size() < net.contacts.size() / 2);
            for (std::size_t n = 0; n < net.contacts.size(); ++n)
                if (!around.contains(n)) only.take(n);
            only.sweep_all(kernels, 2);

            const SharedNet<Real> before = net;
            REQUIRE(pieces.gather(net.cut, net.velocity, SharedNet<Real>::kBodies, Real(0.1), net.links,
                                  net.heads, net.still));
            pieces.sweep(net.arguments(), kernels, 2, net.links);
            CHECK(have_equal_bits(net.velocity, only.velocity));
            bool are_equal = true;
            for (std::size_t n = 0; n < net.contacts.size(); ++n) {
                const PathCut::Place place = net.cut.places()[n];
                const PathLink<Real>& has = net.links[place.link];
                const PathLink<Real>& wants = (around.contains(n) ? only : before).links[place.link];
                are_equal = are_equal && has.normal1[place.lane] == wants.normal1[place.lane] &&
                            has.normal2[place.lane] == wants.normal2[place.lane] &&
                            has.tangent[place.lane] == wants.tangent[place.lane];
            }
            CHECK(are_equal);
            // Velocities have been remembered since, and no sweep changes any by so much.
            CHECK(pieces.gather(net.cut, net.velocity, SharedNet<Real>::kBodies, Real(1e9), net.links,
                                net.heads, net.still));
            const Column<Real> swept = net.velocity;
            pieces.sweep(net.arguments(), kernels, 2, net.links);
            CHECK(have_equal_bits(net.velocity, swept));
        }
    }

    TEST_CASE("where most bodies are restless there are no pieces") {
        SharedNet<float> net(1);
        PathPieces<float> pieces;
        pieces.list_contacts(net.cut, net.ends, SharedNet<float>::kBodies + 1);
        pieces.remember(net.velocity);
        for (std::size_t body = 0; body < SharedNet<float>::kBodies; body += 2) net.velocity[4 * body] += 1;
        CHECK_FALSE(pieces.gather(net.cut, net.velocity, SharedNet<float>::kBodies, 0.1F, net.links,
                                  net.heads, net.still));
    }
}

}  // namespace test_path_pieces
