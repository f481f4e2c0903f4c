// Bytes that are handed to World::restore_state: what save_state wrote is taken and goes on as the world that
// was saved; anything else is refused, and the world is as it was.

#include <carom/carom.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "byte_source.hpp"
#include "requirement.hpp"

namespace {

using namespace carom;
using fuzz::require;

constexpr double kStep = 1.0 / 60;  // s
constexpr std::size_t kLongestMessage = 1000;

/// A world of each solver, with what only its states have: contacts, sleepers, joints, sensors, compounds.
Scene scene_of(int number) {
    Scene scene;
    scene.walls = Walls{.min = {-3, -3}, .max = {3, 3}};
    if (number == 0) {
        for (int i = 0; i < 4; ++i)
            scene.add({.position = {-2.0 + i, 0.3 * i},
                       .velocity = {1.0, 0.2 * i},
                       .material = {.restitution = 1}});
        scene.accuracy.solver = Solver::impulse;
        return scene;
    }
    if (number == 1) {
        for (int i = 0; i < 4; ++i)
            scene.add({.position = {-2.0 + i, 0.3 * i},
                       .velocity = {1.0, 0.2 * i},
                       .material = {.restitution = 1}});
        scene.accuracy.solver = Solver::event;
        return scene;
    }
    scene.gravity = {0, -10};
    scene.effects.ledger = true;
    scene.effects.sleep = number == 3;
    scene.add({.position = {0, -2.5}, .material = {.friction = 0.5}});
    const BodyId box =
        scene.add({.shape = Box{0.5, 0.5}, .position = {1.5, -2.7}, .material = {.friction = 0.4}});
    const BodyId pair =
        scene.add({.shape = Compound{{{Box{0.6, 0.2}, {}, 0, {}}, {Disc{0.2}, {0.4, 0.1}, 0, {}}}},
                   .position = {-1.5, -2}});
    scene.add({.type = BodyType::static_body,
               .shape = Chain{{{-1, 0}, {0, -0.2}, {1, 0}}, false},
               .position = {0, -1}});
    scene.add({.type = BodyType::static_body, .shape = Disc{0.4}, .position = {1.5, -2.5}, .sensor = true});
    scene.add(Joint{.a = box, .b = pair, .kind = DistanceJoint{.frequency = 2}});
    return scene;
}

struct Saved {
    std::vector<std::byte> bytes;
    std::uint64_t hash, hash_after;  // of the world that was saved, and a step later
};

template <class Real>
Saved saved_state(int number) {
    BasicWorld<Real> world(scene_of(number), {.threads = 1});
    for (int i = 0; i < 90; ++i) world.step(kStep);
    Saved saved{std::vector<std::byte>(world.state_bytes()), world.state_hash(), 0};
    world.save_state(saved.bytes);
    world.step(kStep);
    saved.hash_after = world.state_hash();
    return saved;
}

/// Changes bytes of a state as the fuzzer says: single ones, runs, its length.
void damage(std::vector<std::byte>& state, fuzz::ByteSource& bytes) {
    while (!bytes.is_empty() && !state.empty()) {
        const std::size_t kind = bytes.below(8);
        // Headers are a hundredth of a state: they are aimed at.
        const std::size_t at = kind < 3 ? bytes.byte() % std::min<std::size_t>(64, state.size())
                                        : (bytes.word() * 977) % state.size();
        switch (kind) {
            case 7:
                state.resize(at);
                break;
            case 6:
                state.insert(state.begin() + static_cast<std::ptrdiff_t>(at), bytes.byte(),
                             std::byte{bytes.byte()});
                break;
            case 5:
                for (std::size_t i = at; i < std::min(state.size(), at + 8); ++i)
                    state[i] = std::byte{bytes.byte()};
                break;
            default:
                state[at] ^= std::byte{bytes.byte()};
        }
    }
}

/// @return whether the state was taken
template <class Real>
bool try_to_restore(BasicWorld<Real>& world, const std::vector<std::byte>& state) {
    const std::uint64_t hash = world.state_hash();
    const double time = world.time();
    const std::string solver = world.plan().solver;
    try {
        world.restore_state(state);
        return true;
    } catch (const Error& error) {
        const std::string_view message = error.what();
        require(message.starts_with("World::restore_state: ") && message.size() <= kLongestMessage,
                "messages say where");
        require(error.code() == ErrorCode::malformed || error.code() == ErrorCode::inconsistent,
                "codes are those said");
    }
    require(world.state_hash() == hash && world.time() == time && world.plan().solver == solver,
            "a refused state changes nothing");
    return false;
}

template <class Real>
void run(fuzz::ByteSource bytes) {
    static const std::vector<Saved> all{saved_state<Real>(0), saved_state<Real>(1), saved_state<Real>(2),
                                        saved_state<Real>(3)};
    static const Saved of_other_precision =
        saved_state<std::conditional_t<std::is_same_v<Real, float>, double, float>>(2);
    static BasicWorld<Real> world(scene_of(2), {.threads = 1});
    const std::size_t choice = bytes.below(6);
    if (choice == 5) {  // any bytes
        std::vector<std::byte> state;
        while (!bytes.is_empty()) state.push_back(std::byte{bytes.byte()});
        require(!try_to_restore(world, state), "bytes of no world are refused");
        return;
    }
    const Saved& saved = choice == 4 ? of_other_precision : all[choice];
    std::vector<std::byte> state = saved.bytes;
    damage(state, bytes);
    const bool is_whole = state.size() >= saved.bytes.size() &&
                          std::equal(saved.bytes.begin(), saved.bytes.end(), state.begin());
    const bool is_taken = try_to_restore(world, state);
    require(is_taken == (is_whole && choice != 4), "whole states are taken, others refused");
    if (!is_taken) return;
    require(world.state_hash() == saved.hash, "a restored world is the one that was saved");
    world.step(kStep);
    require(world.state_hash() == saved.hash_after, "a restored world goes on as the one that was saved");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::ByteSource bytes({data, size});
    if (bytes.flag())
        run<double>(bytes);
    else
        run<float>(bytes);
    return 0;
}
