#include <carom/carom.hpp>

#include "support/seed_run.hpp"

namespace carom::test {
namespace {

Scene as_scene(const PairwiseScene& from) {
    Scene scene;
    scene.gravity = {from.gravity_x, from.gravity_y};
    scene.drag = {from.linear_drag, from.angular_drag};
    if (from.walls)
        scene.walls = Walls{.min = {from.walls->min_x, from.walls->min_y},
                            .max = {from.walls->max_x, from.walls->max_y},
                            .material = {.restitution = from.walls->restitution}};
    for (const PairwiseBody& body : from.bodies) {
        Body added;
        added.shape = Disc{body.radius};
        added.position = {body.x, body.y};
        added.angle = body.angle;
        added.velocity = {body.vx, body.vy};
        added.angular_velocity = body.omega;
        added.mass = body.mass;
        added.material.restitution = from.restitution;
        scene.add(added);
    }
    return scene;
}

class EngineRun final : public SeedRun {
  public:
    explicit EngineRun(const PairwiseScene& scene) : start_(scene), world_(as_scene(scene)) {
        const auto ids = world_.bodies().id;
        ids_.resize(ids.size());
        for (const BodyId id : ids) ids_[id.index] = id;
    }
    void step(double dt) override { world_.step(dt); }
    std::vector<PairwiseBody> bodies() const override {
        std::vector<PairwiseBody> bodies = start_.bodies;
        for (std::size_t body = 0; body < bodies.size(); ++body) {
            const BodyState state = world_.state(ids_[body]);
            bodies[body].x = state.position.x, bodies[body].y = state.position.y;
            bodies[body].vx = state.velocity.x, bodies[body].vy = state.velocity.y;
            bodies[body].angle = state.angle, bodies[body].omega = state.angular_velocity;
        }
        return bodies;
    }
    double wall_impulse() const override { return world_.ledger().wall_impulse; }

  private:
    PairwiseScene start_;
    World64 world_;
    std::vector<BodyId> ids_;  // in body order
};

}  // namespace

std::unique_ptr<SeedRun> start_engine(const PairwiseScene& scene) {
    return std::make_unique<EngineRun>(scene);
}

}  // namespace carom::test
