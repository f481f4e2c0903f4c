#include "torture/cases/impacts/parts.hpp"

namespace carom::torture {

Case impacts() {
    return {.id = "impacts",
            .title = "several impacts in a step, gases that cool, bodies that are squeezed",
            .tasks = [](const Options& asked) {
                std::vector<Task> all;
                add_impacts_in_line(all, asked);
                add_gases(all, asked);
                add_squeezes(all, asked);
                return all;
            }};
}

}  // namespace carom::torture
