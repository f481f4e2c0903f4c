#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <sstream>

namespace carom::test {

/// Prints a measured figure when CAROM_TEST_FIGURES is set in the environment; tests are silent otherwise.
template <class... Parts>
void report(const Parts&... parts) {
    if (std::getenv("CAROM_TEST_FIGURES") == nullptr) return;
    std::ostringstream text;
    (text << ... << parts);
    MESSAGE(text.str());
}

}  // namespace carom::test
