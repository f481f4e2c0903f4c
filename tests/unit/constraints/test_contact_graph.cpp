#include "constraints/contact_graph.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "isa/select_isa.hpp"

namespace test_contact_graph {

using namespace carom;

namespace {

using PairOfRows = std::pair<std::int32_t, std::int32_t>;

/// Discs that touch their neighbours on a jittered lattice, rows in lines; one large disc reaches many of
/// them.
Bodies<float> crowd(std::size_t columns, std::size_t lines, double large_radius) {
    Bodies<float> bodies;
    const std::size_t count = columns * lines;
    bodies.resize(count);
    std::mt19937 random(7);
    const auto jitter = [&] { return 0.2f * static_cast<float>(random()) / 4294967296.0f; };
    for (std::size_t row = 0; row < count; ++row) {
        bodies.position_x[row] = static_cast<float>(row % columns) + jitter();
        bodies.position_y[row] = static_cast<float>(row / columns) + jitter();
        bodies.radius.set(row, count, 0.5f);
        bodies.mass.set(row, count, 1);
    }
    if (large_radius > 0) bodies.radius.set(count / 2, count, static_cast<float>(large_radius));
    return bodies;
}

struct Graph {
    Bodies<float> bodies;
    Candidates<float> candidates{MarginRule::own};
    ContactGraph<float> graph;
    Executor executor;

    explicit Graph(Bodies<float> of, int threads = 1) : bodies(std::move(of)), executor(threads) {
        candidates.prepare(bodies.count);
    }
    void renew() {
        candidates.update(bodies, flight_clock_at(1.0 / 60, 0), {}, {}, 0, select_kernels("auto").of<float>(),
                          executor);
        graph.renew(candidates, EdgeCandidates<float>{}, bodies, nullptr, executor);
    }
    std::set<PairOfRows> candidate_pairs() const {
        std::set<PairOfRows> pairs;
        for (std::size_t p = 0; p < candidates.pair_count(); ++p)
            pairs.insert(std::minmax(candidates.pair_a()[p], candidates.pair_b()[p]));
        return pairs;
    }
};

/// Rows of the groups of pairs in `groups`.
std::set<std::int32_t> rows_of(const ContactGraph<float>& graph, const std::vector<std::size_t>& groups) {
    std::set<std::int32_t> rows;
    for (const std::size_t group : groups)
        graph.pairs.for_each(group, group + 1, [&](std::size_t i) {
            rows.insert({graph.pairs.a[i], graph.pairs.b[i]});
        });
    return rows;
}

bool share_a_row(const std::set<std::int32_t>& first, const std::set<std::int32_t>& second) {
    return std::any_of(first.begin(), first.end(), [&](std::int32_t row) { return second.count(row) > 0; });
}

float impulse_of(PairOfRows pair) {
    return static_cast<float>(1 + pair.first % 1000) + 0.001f * static_cast<float>(pair.second % 1000);
}

}  // namespace

TEST_SUITE("constraints/contact graph") {
    TEST_CASE("every candidate pair is one contact, and no colour has a body twice") {
        Graph world(crowd(120, 100, 12));
        world.renew();
        const ContactGraph<float>& graph = world.graph;
        CHECK(graph.groups.chunks >= 8);
        std::set<PairOfRows> seen;
        for (std::size_t c = 0; c < graph.pairs.colours(); ++c) {
            const bool is_overflow = graph.pairs.has_overflow && c + 1 == graph.pairs.colours();
            std::set<std::int32_t> rows;
            CHECK(graph.pairs.begin[c] % kRowPadding == 0);
            for (std::size_t n = 0; n < graph.pairs.count[c]; ++n) {
                const std::size_t i = graph.pairs.begin[c] + n * graph.pairs.stride(c);
                const std::int32_t a = graph.pairs.a[i], b = graph.pairs.b[i];
                REQUIRE(a < b);
                REQUIRE(seen.insert({a, b}).second);
                const bool is_new = rows.insert(a).second & rows.insert(b).second;
                REQUIRE((is_new || is_overflow));
            }
        }
        CHECK(seen == world.candidate_pairs());
        CHECK(graph.pairs.has_overflow);  // the large disc has more neighbours than there are colours,
        CHECK(graph.pairs.stride(graph.pairs.colours() - 1) == kRowPadding);  // which get a batch each
    }

    TEST_CASE("tasks of a part of a sweep share no body") {
        Graph world(crowd(120, 100, 0));
        world.renew();
        const TaskGroups& groups = world.graph.groups;
        REQUIRE(groups.chunks >= 8);
        std::vector<std::set<std::int32_t>> part_1, part_2;
        for (std::size_t chunk = 0; chunk + 1 < groups.chunks; chunk += 2)
            part_1.push_back(rows_of(world.graph, {TaskGroups::inside(chunk), TaskGroups::across(chunk),
                                                   TaskGroups::inside(chunk + 1)}));
        for (std::size_t chunk = 1; chunk + 1 < groups.chunks; chunk += 2)
            part_2.push_back(rows_of(world.graph, {TaskGroups::across(chunk)}));
        for (const auto* part : {&part_1, &part_2})
            for (std::size_t i = 0; i < part->size(); ++i) {
                CHECK_FALSE((*part)[i].empty());
                for (std::size_t j = 0; j < i; ++j) CHECK_FALSE(share_a_row((*part)[i], (*part)[j]));
            }
        CHECK(rows_of(world.graph, {groups.far()}).empty());
    }

    TEST_CASE("contacts keep their impulses when pairs are found anew, rows sorted and bodies removed") {
        Graph world(crowd(120, 100, 12));
        world.renew();
        // Bodies are told apart by their places.
        ContactGraph<float>& graph = world.graph;
        Bodies<float>& bodies = world.bodies;
        using Key = std::pair<std::pair<float, float>, std::pair<float, float>>;
        const auto key = [&](std::size_t i) {
            const auto place = [&](std::int32_t row) {
                return std::pair{bodies.position_x[static_cast<std::size_t>(row)],
                                 bodies.position_y[static_cast<std::size_t>(row)]};
            };
            return Key(std::minmax(place(graph.pairs.a[i]), place(graph.pairs.b[i])));
        };
        std::map<Key, float> expected;
        graph.pairs.for_each([&](std::size_t i) {
            graph.pairs.normal_impulse[i] = impulse_of({graph.pairs.a[i], graph.pairs.b[i]});
            expected[key(i)] = graph.pairs.normal_impulse[i];
        });
        const auto all_are_kept = [&](std::size_t removed) {
            std::size_t wrong = 0, count = 0;
            graph.pairs.for_each([&](std::size_t i) {
                const auto found = expected.find(key(i));
                wrong += found == expected.end() || found->second != graph.pairs.normal_impulse[i];
                ++count;
            });
            CHECK(wrong == 0);
            CHECK(count + removed >= expected.size());
            CHECK(count > 16'000);
        };
        world.candidates.invalidate();
        world.renew();
        all_are_kept(0);

        const std::size_t count = bodies.count;
        std::vector<std::int32_t> order(count);
        for (std::size_t row = 0; row < count; ++row)
            order[row] = static_cast<std::int32_t>(row * 7919 % count);  // coprime: a permutation
        bodies.for_each_column([&](auto, auto, auto& column) {
            auto old = column;
            for (std::size_t row = 0; row < count; ++row)
                column[row] = old[static_cast<std::size_t>(order[row])];
        });
        graph.trail.follow_sorted(order.data(), count);
        world.candidates.invalidate();
        world.renew();
        all_are_kept(0);

        const std::size_t gone = 17;
        bodies.for_each_column([&](auto, auto, auto& column) { column[gone] = column[count - 1]; });
        bodies.resize(count - 1);
        graph.trail.follow_removed(gone, count - 1);
        world.candidates.prepare(bodies.count);
        world.candidates.invalidate();
        world.renew();
        all_are_kept(600);  // of the removed body, at most
    }

    TEST_CASE("contacts that came with new margins keep their impulses when others come") {
        Graph of(crowd(30, 30, 0));
        of.graph.keeps_rolling = true;
        of.bodies.velocity_x[0] = of.bodies.velocity_y[0] = 6;  // m/s, through all others
        of.renew();
        std::int64_t renewed = of.candidates.rebuild_count();
        std::map<PairOfRows, float> given;
        std::size_t late = 0, kept = 0;
        for (int step = 0; step < 200; ++step) {
            of.bodies.position_x[0] += 0.1f, of.bodies.position_y[0] += 0.1f;
            of.candidates.move_places(of.bodies, 1.0 / 60, of.executor);
            const float way = std::hypot(of.bodies.position_x[0] + 0.1f - of.candidates.built_x()[0],
                                         of.bodies.position_y[0] + 0.1f - of.candidates.built_y()[0]);
            std::vector<std::int32_t> displaced;
            if (way >= of.candidates.reach()[0] - of.bodies.radius[0]) displaced.push_back(0);
            of.candidates.update(of.bodies, flight_clock_at(1.0 / 60, 0), {}, displaced, 9,
                                 select_kernels("auto").of<float>(), of.executor);
            if (of.candidates.rebuild_count() != renewed) {
                renewed = of.candidates.rebuild_count(), given.clear();
                of.graph.renew(of.candidates, EdgeCandidates<float>{}, of.bodies, nullptr, of.executor);
                continue;
            }
            late += of.candidates.new_pairs().size();
            of.graph.add(of.candidates, EdgeCandidates<float>{}, of.bodies, nullptr);
            ContactRows<float>& pairs = of.graph.pairs;
            pairs.for_each([&](std::size_t i) {
                const PairOfRows pair = std::minmax(pairs.a[i], pairs.b[i]);
                if (const auto before = given.find(pair); before != given.end()) {
                    REQUIRE(pairs.normal_impulse[i] == before->second);
                    REQUIRE(pairs.friction_impulse[i] == 2 * before->second);
                    REQUIRE(pairs.rolling_impulse[i] == 3 * before->second);
                    ++kept;
                }
                const auto impulse = static_cast<float>(1 + given.size());
                const float now = given.try_emplace(pair, impulse).first->second;
                pairs.normal_impulse[i] = now, pairs.friction_impulse[i] = 2 * now;
                pairs.rolling_impulse[i] = 3 * now;
            });
        }
        CHECK(late > 10);
        CHECK(kept > 1000);
    }

    TEST_CASE("threads do not change the graph") {
        Graph one(crowd(150, 120, 5), 1), three(crowd(150, 120, 5), 3);
        one.renew(), three.renew();
        for (const auto* world : {&one, &three})
            CHECK(world->graph.pairs.colours() == one.graph.pairs.colours());
        CHECK(std::equal(one.graph.pairs.a.begin(), one.graph.pairs.a.end(), three.graph.pairs.a.begin(),
                         three.graph.pairs.a.end()));
        CHECK(std::equal(one.graph.pairs.b.begin(), one.graph.pairs.b.end(), three.graph.pairs.b.begin(),
                         three.graph.pairs.b.end()));
    }
}

}  // namespace test_contact_graph
