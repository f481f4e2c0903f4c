#include "scene/validation/limits.hpp"
#include "scene/validation/validation.hpp"

namespace carom {
namespace {

constexpr Item kSceneItem{"the scene has", "", -1, ""};
constexpr Item kDragItem{"the scene has", "/drag", -1, ""};
constexpr Item kStepItem{"the step has", "/step", -1, ""};
constexpr Item kRecordItem{"the record has", "/record", -1, ""};
constexpr Item kAccuracyItem{"the accuracy has", "/accuracy", -1, ""};

constexpr bool is_built(Solver solver) {
    return solver == Solver::automatic || solver == Solver::pairwise || solver == Solver::impulse ||
           solver == Solver::event || solver == Solver::soft || solver == Solver::rattle;
}

}  // namespace

std::optional<Problem> find_accuracy_problem(const Accuracy& accuracy) {
    if (!is_built(accuracy.solver))
        return problem(
            ErrorCode::not_built_yet, kAccuracyItem, "/solver", "solver ", quoted(name_of(accuracy.solver)),
            ", which is not built yet. Use \"auto\", \"impulse\", \"soft\", \"event\", \"rattle\", or "
            "\"pairwise\" for small scenes.");
    if (accuracy.substeps)
        if (auto found = check(kAccuracyItem, "/substeps", *accuracy.substeps, kSubsteps)) return found;
    if (accuracy.iterations) return check(kAccuracyItem, "/iterations", *accuracy.iterations, kIterations);
    return std::nullopt;
}

namespace {

std::optional<Problem> find_walls_problem(const Walls& walls) {
    static constexpr Item kWallsItem{"the walls have", "/walls", -1, ""};
    static constexpr Quantity kMinX{"min x", "m", -kLargestPosition, kLargestPosition, kUseMetres};
    static constexpr Quantity kMinY{"min y", "m", -kLargestPosition, kLargestPosition, kUseMetres};
    static constexpr Quantity kMaxX{"max x", "m", -kLargestPosition, kLargestPosition, kUseMetres};
    static constexpr Quantity kMaxY{"max y", "m", -kLargestPosition, kLargestPosition, kUseMetres};
    if (auto found = check(kWallsItem, "/min/0", walls.min.x, kMinX)) return found;
    if (auto found = check(kWallsItem, "/min/1", walls.min.y, kMinY)) return found;
    if (auto found = check(kWallsItem, "/max/0", walls.max.x, kMaxX)) return found;
    if (auto found = check(kWallsItem, "/max/1", walls.max.y, kMaxY)) return found;
    if (!(walls.max.x > walls.min.x && walls.max.y > walls.min.y))
        return problem(ErrorCode::inconsistent, kWallsItem, "/max", "max ", walls.max, " m and min ",
                       walls.min, " m; expected max > min in x and in y. Swap the two corners.");
    return find_material_problem(kWallsItem, "/material", walls.material);
}

std::optional<Problem> find_run_problem(const Scene& scene) {
    if (auto found = check(kStepItem, "/dt", scene.step.dt, kStep)) return found;
    if (auto found = check(kStepItem, "/count", static_cast<double>(scene.step.count), kStepCount))
        return found;
    if (auto found = check(kRecordItem, "/every", static_cast<double>(scene.record.every), kRecordEvery))
        return found;
    return check(kRecordItem, "/trail", static_cast<double>(scene.record.trail), kRecordTrail);
}

}  // namespace

std::optional<Problem> find_settings_problem(const Scene& scene) {
    if (auto found = check(kSceneItem, "/gravity/0", scene.gravity.x, kGravityX)) return found;
    if (auto found = check(kSceneItem, "/gravity/1", scene.gravity.y, kGravityY)) return found;
    if (auto found = check(kDragItem, "/linear", scene.drag.linear, kLinearDrag)) return found;
    if (auto found = check(kDragItem, "/angular", scene.drag.angular, kAngularDrag)) return found;
    if (scene.walls)
        if (auto found = find_walls_problem(*scene.walls)) return found;
    if (auto found = find_run_problem(scene)) return found;
    return find_accuracy_problem(scene.accuracy);
}

void validate_dt(double dt, std::string_view where) {
    const Item item{"the step has", "/step", -1, ""};
    raise_if(where, check(item, "/dt", dt, kStepOrZero));
    if (dt != 0) raise_if(where, check(item, "/dt", dt, kStep));
}

void validate_accuracy(const Accuracy& accuracy, std::string_view where) {
    raise_if(where, find_accuracy_problem(accuracy));
}

}  // namespace carom
