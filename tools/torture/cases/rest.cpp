#include "torture/case.hpp"
namespace carom::torture {
namespace {
std::vector<Task> tasks(const Options&) {
    return {};
}
}  // namespace
Case rest() {
    return {.id = "rest", .title = "piles and columns", .tasks = tasks};
}
}  // namespace carom::torture
