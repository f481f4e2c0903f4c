// B11 of docs/hard-cases.md: worlds far from their origin.
#include "support/hard_case.hpp"

namespace test_far_from_origin {

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/far from the origin") {
    TEST_CASE("B11: what stands or lies far from the origin does as at the origin") {
        const torture::HardCases all = torture::far_from_the_origin(extent());
        check_cases<double>(all);
        torture::HardCases with_mark;  // of single precision, which has one at 1e4 m alone
        for (const torture::HardCase& each : all)
            if (each.name.find(" 10000 m") != std::string::npos) with_mark.push_back(each);
        CHECK(with_mark.size() == 2);
        check_cases<float>(with_mark);
    }
}

}  // namespace test_far_from_origin
