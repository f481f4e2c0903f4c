#include <doctest/doctest.h>

#include <carom/version.hpp>

namespace test_version {

TEST_CASE("the linked library has the version of the headers") {
    CHECK(carom::version() == carom::kVersion);
}

}  // namespace test_version
