#include <doctest/doctest.h>

#include <carom/version.hpp>

TEST_CASE("the linked library has the version of the headers") {
    CHECK(carom::version() == carom::kVersion);
}
