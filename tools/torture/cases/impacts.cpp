#include "torture/case.hpp"
namespace carom::torture {
namespace {
std::vector<Task> tasks(const Options&) {
    return {};
}
}  // namespace
Case impacts() {
    return {.id = "impacts", .title = "impacts", .tasks = tasks};
}
}  // namespace carom::torture
