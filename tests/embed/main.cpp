// Uses a world as an embedding program does and exits with 0 if a ball fell as far as gravity says.
#include <cmath>
#include <cstdio>

#include <carom/carom.hpp>

int main() {
    if (carom::version() != carom::kVersion) return 1;

    carom::Scene scene;
    scene.gravity = {0, -10};
    const carom::BodyId ball = scene.add({.shape = carom::Disc{0.5}, .position = {2, 6}, .velocity = {3, 0}});

    carom::World64 world(scene);
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);

    const carom::Vec2 position = world.state(ball).position;
    std::printf("carom %s: after %g s the ball is at (%g, %g) m\n", carom::version().data(), world.time(),
                position.x, position.y);
    const bool fell = std::abs(position.x - 5) < 1e-9 && std::abs(position.y - 1) < 1e-9;
    return fell ? 0 : 1;
}
