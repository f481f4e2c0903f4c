// Uses worlds as an embedding program does and exits with 0 if a ball fell as far as gravity says and two
// scenes ended with the bits that every build gives. Built optimised and, as a subfolder, by the same
// compiler without optimisation and without OpenMP.
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include <carom/carom.hpp>

namespace {

/// Discs of several sizes that fall into a box; with friction the solver is `soft`, without it `impulse`.
carom::Scene falling_discs(double friction, double restitution) {
    carom::Scene scene;
    scene.gravity = {0.5, -10};
    scene.walls = carom::Walls{
        .min = {0, 0}, .max = {12, 40}, .material = {.friction = friction, .restitution = restitution}};
    for (int i = 0; i < 80; ++i)
        scene.add({.shape = carom::Disc{0.3 + 0.02 * (i % 7)},
                   .position = {1.1 + 1.2 * (i % 9), 1 + 1.1 * (i / 9) + 0.05 * (i % 4)},
                   .velocity = {0.3 * (i % 5) - 0.6, 0},
                   .material = {.friction = friction, .restitution = restitution}});
    return scene;
}

template <class World>
bool ends_with(const char* name, const carom::Scene& scene, std::uint64_t expected) {
    World world(scene);
    for (int i = 0; i < 90; ++i) world.step(1.0 / 60);
    const std::uint64_t hash = world.state_hash();
    if (hash == expected) return true;
    std::fprintf(stderr,
                 "%s: hash of the state is 0x%016" PRIx64 ", expected 0x%016" PRIx64
                 "; if results were meant to change, write the new one into %s\n",
                 name, hash, expected, __FILE__);
    return false;
}

bool ball_falls() {
    carom::Scene scene;
    scene.gravity = {0, -10};
    const carom::BodyId ball = scene.add({.shape = carom::Disc{0.5}, .position = {2, 6}, .velocity = {3, 0}});

    carom::World64 world(scene);
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);

    const carom::Vec2 position = world.state(ball).position;
    std::printf("carom %s: after %g s the ball is at (%g, %g) m\n", carom::version().data(), world.time(),
                position.x, position.y);
    return std::abs(position.x - 5) < 1e-9 && std::abs(position.y - 1) < 1e-9;
}

}  // namespace

int main() {
    if (carom::version() != carom::kVersion || !ball_falls()) return 1;
    const carom::Scene bouncing = falling_discs(0, 0.8), rough = falling_discs(0.5, 0.2);
    // Every line, whatever the others say: all new hashes are then known at once.
    const bool same[] = {ends_with<carom::World>("bouncing, float", bouncing, 0x41432bff4c9aaca7),
                         ends_with<carom::World64>("bouncing, double", bouncing, 0xe2b120cb524a202c),
                         ends_with<carom::World>("rough, float", rough, 0x183e01b95e84b5e3),
                         ends_with<carom::World64>("rough, double", rough, 0x5ba3eef55af877cb)};
    return same[0] && same[1] && same[2] && same[3] ? 0 : 1;
}
