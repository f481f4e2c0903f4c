#include <vector>

#include "torture/case.hpp"

namespace carom::torture {

std::span<const Case> all_cases() {
    static const std::vector<Case> cases{passive(), random_worlds(), drop(),     rest(),
                                         impacts(), hard(),          envelopes()};
    return cases;
}

}  // namespace carom::torture
