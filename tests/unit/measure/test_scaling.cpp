#include "measure/scaling.hpp"

#include <doctest/doctest.h>
#include <carom/pairwise.hpp>
#include <carom/world.hpp>

#include <cmath>

#include "measure/all_pairs.hpp"
#include "measure/ceilings.hpp"
#include "measure/gas.hpp"
#include "measure/limits.hpp"
#include "measure/machine.hpp"
#include "measure/text.hpp"

namespace test_scaling {

using namespace carom::measure;

namespace {

/// Times of a made-up machine: naive 10 ns a pair, the grid 100 ns a body, in five rounds of slightly
/// different length.
std::vector<ScalingRow> made_up_rows() {
    std::vector<ScalingRow> rows;
    for (const double bodies : {10.0, 30.0, 100.0, 1000.0, 3000.0, 10000.0})
        for (const char* method : {"naive", "grid scalar"}) {
            ScalingRow row{.method = method, .bodies = static_cast<std::int64_t>(bodies)};
            const double seconds = row.method == "naive" ? 5e-9 * bodies * bodies : 100e-9 * bodies;
            for (int round = -2; round <= 2; ++round) row.seconds.push_back(seconds * (1 + 0.01 * round));
            rows.push_back(row);
        }
    return rows;
}

}  // namespace

TEST_SUITE("measure/scaling") {
    TEST_CASE("sizes go by halves of a decade and end at the largest asked for") {
        CHECK(scaling_sizes(1000) == std::vector<std::int64_t>{10, 30, 100, 300, 1000});
        CHECK(scaling_sizes(500) == std::vector<std::int64_t>{10, 30, 100, 300, 500});
        CHECK(scaling_sizes(10) == std::vector<std::int64_t>{10});
    }

    TEST_CASE("the result file has times a body, exponents and the crossover of what was measured") {
        const Json json = scaling_json(made_up_rows());
        CHECK(json["kind"] == "scaling");
        CHECK(json["rows"][0]["ns_per_body"]["median"].get<double>() == doctest::Approx(50));
        CHECK(json["rows"][1]["ns_per_body"]["median"].get<double>() == doctest::Approx(100));
        CHECK(json["complexity"][0]["method"] == "naive");
        CHECK(json["complexity"][0]["exponent"].get<double>() == doctest::Approx(2));
        CHECK(json["complexity"][1]["exponent"].get<double>() == doctest::Approx(1));
        const Json& crossover = json["crossovers"][0];
        CHECK(crossover["to"] == "grid scalar");
        CHECK(crossover["bodies"]["median"].get<double>() == doctest::Approx(20));
        CHECK(crossover["ratio_at"] == 10000);
        CHECK(crossover["ratio"]["median"].get<double>() == doctest::Approx(500));
        CHECK(scaling_text(json).find("grid scalar is faster than naive from 20 bodies on") !=
              std::string::npos);
    }

    TEST_CASE("all pairs with SIMD meets what the naive loop meets, and keeps the gas's energy") {
        const carom::Scene scene = flown_gas_scene(500);
        AllPairs fast(scene);
        carom::Pairwise naive(pairwise_gas(scene));
        const double before = fast.kinetic_energy();
        for (int i = 0; i < 20; ++i) fast.step(kStep), naive.step(kStep);
        CHECK(fast.kinetic_energy() == doctest::Approx(before).epsilon(1e-4));
        const auto contacts = static_cast<double>(naive.counts().contacts);
        REQUIRE(contacts > 300);
        CHECK(static_cast<double>(fast.contacts()) == doctest::Approx(contacts).epsilon(0.1));
    }

    TEST_CASE(
        "every method starts from the same state: the flown gas has its energy and none of its lattice") {
        const carom::Scene start = gas_scene(400), flown = flown_gas_scene(400);
        const auto energy = [](const carom::Scene& scene) {
            return carom::World(scene).ledger().energy.kinetic;
        };
        CHECK(energy(flown) == doctest::Approx(energy(start)).epsilon(1e-5));
        CHECK(std::abs(flown.bodies[0].position.x - start.bodies[0].position.x) > 0.01);
    }

    TEST_CASE("one small sweep has a row for every method, at every size") {
        ScalingOptions options;
        options.max_bodies = 30;
        options.contest = {.rounds = 2, .seconds_of_a_turn = 1e-5, .fewest_steps = 1};
        const std::vector<ScalingRow> rows = run_scaling(options);
        const std::size_t methods = rows.size() / 2;
        REQUIRE(methods >= 3);
        CHECK(rows.size() == 2 * methods);
        for (const ScalingRow& row : rows) {
            CAPTURE(row.method);
            CHECK(row.seconds.size() == 2);
            CHECK(row.seconds[0] > 0);
            CHECK(row.bytes_per_body >= 16);
        }
    }
}

TEST_SUITE("measure/ceilings") {
    TEST_CASE("the roof is the nearer of bandwidth and peak") {
        const RoofShare memory = roof_share({.bytes = 10, .operations = 1}, 1e9, 20e9, 100e9);
        CHECK(memory.share == doctest::Approx(0.5));
        CHECK(memory.is_memory);
        const RoofShare arithmetic = roof_share({.bytes = 1, .operations = 25}, 1e9, 20e9, 100e9);
        CHECK(arithmetic.share == doctest::Approx(0.25));
        CHECK_FALSE(arithmetic.is_memory);
    }

    TEST_CASE("a working set belongs to the smallest level that holds it") {
        const Ceilings ceilings{.copy = {{"L1", 16384, 1}, {"L2", 524288, 1}, {"memory", 1 << 27, 1}},
                                .peak = {}};
        CHECK(ceilings.copy_of(1000).level == "L1");
        CHECK(ceilings.copy_of(100000).level == "L2");
        CHECK(ceilings.copy_of(std::size_t{1} << 30).level == "memory");
    }

    TEST_CASE(
        "measured ceilings are those of a machine: caches are no slower than memory, vectors than scalars") {
        const Ceilings ceilings = measure_ceilings(0.005);
        CHECK(ceilings.copy.front().bytes_per_second > 0.8 * ceilings.copy.back().bytes_per_second);
        for (const ArithmeticPeak& peak : ceilings.peak) {
            CAPTURE(peak.isa);
            CHECK(peak.single_per_second > 1e8);
            CHECK(peak.single_per_second > 0.7 * ceilings.peak.front().single_per_second);
        }
    }

    TEST_CASE("what limits a stage is said in words") {
        const auto starts = [](const std::string& text, const char* with) { return text.starts_with(with); };
        CHECK(starts(limit_of({.bodies = 5, .seconds_per_call = 1e-7}), "too few bodies"));
        CHECK(starts(limit_of({.bodies = 1e5, .seconds_per_call = 1e-7}), "too little to do"));
        StageFacts facts{.bodies = 1e5,
                         .seconds_per_call = 1e-3,
                         .roof_share = 0.6,
                         .roof_is_memory = true,
                         .level = "L2",
                         .times_scalar = 1.0};
        CHECK(limit_of(facts) == "memory: 60 % of what L2 can move");
        facts.roof_is_memory = false;
        CHECK(limit_of(facts) == "arithmetic: 60 % of what the units can do");
        facts.roof_share = 0.05;
        CHECK(starts(limit_of(facts), "branching"));
        facts.times_scalar = 4;
        CHECK(starts(limit_of(facts), "arithmetic in part: vectors make it 4.0 times faster"));
    }
}

TEST_SUITE("measure/json") {
    TEST_CASE("a result file's text reads back as what it was, an element of its rows on each line") {
        const Json result = scaling_json(made_up_rows());
        const std::string text = result_text(result);
        CHECK(Json::parse(text) == result);
        CHECK(text.find("\n  {\"method\":\"grid scalar\",\"bodies\":30") != std::string::npos);
        CHECK(Json::parse(result_text(Json::object())) == Json::object());
        CHECK(Json::parse(result_text({{"rows", Json::array()}, {"a\"b", 1}})) ==
              Json{{"rows", Json::array()}, {"a\"b", 1}});
    }
}

TEST_SUITE("measure/machine") {
    TEST_CASE("a machine's label is the name of a folder") {
        const Json properties{{"processor", "Some CPU (R) @ 2.50GHz"},
                              {"cores", 2},
                              {"isa", {"scalar", "avx2"}},
                              {"l3_bytes", 33554432}};
        CHECK(machine_label(properties) == "some-cpu-r-2-50ghz-2-cores-avx2-32-mib-l3");
    }

    TEST_CASE("digits are grouped by three") {
        CHECK(grouped(7) == "7");
        CHECK(grouped(1000) == "1,000");
        CHECK(grouped(1234567) == "1,234,567");
        CHECK(grouped(-123456) == "-123,456");
    }
}

}  // namespace test_scaling
