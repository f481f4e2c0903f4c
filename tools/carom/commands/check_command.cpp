#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "commands.hpp"
#include "scene_file/printable.hpp"
#include "scene_file/scene_reader.hpp"
#include "terminal/exit_codes.hpp"

namespace carom::tool {
namespace {

int check(const std::string& path) {
    const Scene scene = read_scene(path);
    std::size_t dynamic = 0;
    for (const Body& body : scene.bodies) dynamic += body.type == BodyType::dynamic_body ? 1 : 0;
    std::printf("ok: %s: %zu bodies (%zu dynamic), %s, %lld steps of %g s\n", path.c_str(),
                scene.bodies.size(), dynamic, scene.walls ? "walls" : "no walls",
                static_cast<long long>(scene.step.count), scene.step.dt);
    return kDone;
}

}  // namespace

void add_check_command(CLI::App& program, Action& action) {
    CLI::App* const command =
        program.add_subcommand("check", "Reads and validates a scene, and does nothing else");
    auto path = std::make_shared<std::string>();
    command->add_option("scene", *path, "Scene file")->required()->type_name("SCENE.json");
    command->callback([path, &action] { action = [path] { return check(*path); }; });
}

}  // namespace carom::tool
