#include "narrowphase/coincident.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <limits>

namespace test_coincident {

using namespace carom;

TEST_SUITE("narrowphase/coincident") {
    TEST_CASE(
        "a normal of coincident centres has length one to the last bit, and its opposite for the other "
        "body") {
        constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
        for (std::uint32_t a : {0u, 1u, 2u, 3u, 7u, 100u, 12345u, kMost - 1})
            for (std::uint32_t b : {4u, 5u, 8u, 1000u, 54321u, kMost}) {
                const Vec2 n = normal_of_coincident(a, b), back = normal_of_coincident(b, a);
                CHECK(n.x * n.x + n.y * n.y == 1);
                CHECK(n.x == -back.x);
                CHECK(n.y == -back.y);
            }
    }

    TEST_CASE(
        "eight bodies of consecutive numbers on one are pushed left, right, up and down "
        "alike") {
        int seen = 0;
        for (std::uint32_t b = 1; b <= 8; ++b) {
            const Vec2 n = normal_of_coincident(0, b);
            const bool right = n.x > 0.5, left = n.x<-0.5, up = n.y> 0.5, down = n.y < -0.5;
            seen |= right | left << 1 | up << 2 | down << 3;
        }
        CHECK(seen == 15);
    }
}

}  // namespace test_coincident
