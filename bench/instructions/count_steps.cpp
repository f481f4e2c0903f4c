#include <carom/build_info.hpp>
#include <carom/world.hpp>

#include <valgrind/callgrind.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "scene_file/scene_reader.hpp"

// Steps a scene with callgrind counting in the steps alone: what reading, building and the first steps take
// is left out. tools/count_instructions runs it.
//     carom_count_steps SCENE.json STEPS ISA
//     carom_count_steps --compiler

namespace {

constexpr int kStepsBefore = 5;

int count(const char* path, int steps, const char* isa) {
    const carom::Scene scene = carom::tool::read_scene(path);
    carom::WorldOptions options;
    options.isa = isa;
    options.threads = 1;
    carom::World world(scene, options);
    for (int i = 0; i < kStepsBefore; ++i) world.step(scene.step.dt);
    CALLGRIND_START_INSTRUMENTATION;
    for (int i = 0; i < steps; ++i) world.step(scene.step.dt);
    CALLGRIND_STOP_INSTRUMENTATION;
    std::printf("%016" PRIx64 "\n", world.state_hash());
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc == 2 && std::string(argv[1]) == "--compiler")
            return std::puts(carom::build_info().compiler.c_str()) < 0 ? 1 : 0;
        if (argc == 4) return count(argv[1], std::atoi(argv[2]), argv[3]);
        std::fputs("usage: carom_count_steps SCENE.json STEPS ISA | --compiler\n", stderr);
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "carom_count_steps: %s\n", error.what());
        return 2;
    }
}
