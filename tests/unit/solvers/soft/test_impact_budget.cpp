// How many impacts a body may have in a step.
#include "solvers/soft/impacts/impact_budget.hpp"

#include <doctest/doctest.h>

namespace test_impact_budget {

using namespace carom;

namespace {

int impacts_of(double restitution, double speed, std::size_t joints) {
    ImpactBudget budget;
    budget.begin_step(1);
    int impacts = 0;
    for (; budget.has_enough(0) && impacts < 1'000'000; ++impacts)
        budget.spend(0, restitution, impacts == 0 ? 1 : speed, joints);
    return impacts;
}

}  // namespace

TEST_SUITE("solvers/soft/impact_budget") {
    TEST_CASE("a body has fewer impacts the more energy they take") {
        CHECK(impacts_of(0, 1, 0) <= 20);
        CHECK(impacts_of(0.5, 1, 0) == impacts_of(0, 1, 0));
        CHECK(impacts_of(0.99, 1, 0) > 5 * impacts_of(0, 1, 0));
        CHECK(impacts_of(1, 1, 0) > 20 * impacts_of(0.99, 1, 0));
    }

    TEST_CASE("slow impacts of a collapse count more than fast ones") {
        CHECK(impacts_of(0.9, 0.01, 0) < impacts_of(0.9, 1, 0));
    }

    // Two elastic discs, one of them held, may strike each other without end between two others: their
    // impacts are bounded by the time that they take, which is that of a free body's and four times that a
    // joint.
    TEST_CASE("impacts that joints answer are bounded by the time that they take") {
        const int free = impacts_of(1, 1, 0);
        for (const std::size_t joints : {1u, 4u, 16u}) {
            CAPTURE(joints);
            const int held = impacts_of(1, 1, joints);
            CHECK(held * (1 + 4 * static_cast<int>(joints)) <= free + 4 * static_cast<int>(joints) + 1);
            CHECK(held > 100);  // a cradle has about ten
        }
        CHECK(impacts_of(0, 1, 16) >= impacts_of(0, 1, 0) - 3);
    }

    // Row 0 rattles against row 1, row 2 is far away. Looks: 2^17 and 512 a body, of which an impact
    // takes 16.
    TEST_CASE("what rattles loses its restitution once a step has had its impacts, and nothing else does") {
        constexpr int kBodies = 20, kAllowed = ((1 << 17) + 512 * kBodies) / 16, kMost = 20'000;
        for (const int others : {0, 2000}) {  // impacts of each of the rest: where all have many none rattles
            CAPTURE(others);
            ImpactBudget budget;
            budget.begin_step(kBodies);
            const auto strike = [&](int row) { budget.spend(row, 1, 1, 0), budget.count(row); };
            for (int row = 3; row < kBodies; ++row)
                for (int i = 0; i < others; ++i) strike(row);
            int impacts = 0;
            for (; budget.has_enough(0) && impacts < kMost; ++impacts) strike(0), budget.spend(1, 1, 1, 0);
            for (int i = 0; i < 100; ++i) strike(2);
            CHECK(impacts == (others == 0 ? kAllowed + 1 : 2049));
            CHECK(budget.has_enough(1));
            CHECK(budget.has_enough(2));
            CHECK(budget.has_enough(3));
            budget.begin_step(kBodies);
            strike(0);
            CHECK(budget.has_enough(0));
        }
    }

    TEST_CASE("without restitution an elastic body takes as much of its overdraft as an inelastic one") {
        const auto inelastic = [](double restitution) {
            ImpactBudget budget;
            budget.begin_step(1);
            while (budget.has_enough(0)) budget.spend(0, restitution, 1, 0);
            int impacts = 0;
            for (; !budget.is_exhausted(0, false); ++impacts) budget.spend(0, restitution, 1, 0);
            return impacts;
        };
        CHECK(inelastic(1) <= inelastic(0) + 1);
    }
}

}  // namespace test_impact_budget
