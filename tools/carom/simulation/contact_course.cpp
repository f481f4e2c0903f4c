#include "contact_course.hpp"

#include <algorithm>

namespace carom::tool {
namespace {

constexpr std::int64_t kMostMoments = 200, kMomentsOfLargeScenes = 20;
constexpr std::size_t kLargeScene = 1000;  // bodies: above, a pass over pairs costs as much as a step may

}  // namespace

ContactCourse::ContactCourse(std::int64_t steps, std::size_t bodies)
    : every_(
          std::max<std::int64_t>(1, steps / (bodies > kLargeScene ? kMomentsOfLargeScenes : kMostMoments))) {}

void ContactCourse::look(const Simulation& simulation, std::int64_t step) {
    if (step % every_ == 0)
        moments_.push_back({.time = simulation.time(), .overlaps = simulation.overlaps()});
}

}  // namespace carom::tool
