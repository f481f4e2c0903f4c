#include "results/final_csv.hpp"

#include <string>

#include "results/text_file.hpp"

namespace carom::tool {

void write_final_csv(const std::filesystem::path& path, const Scene& scene, const Simulation& simulation) {
    TextFile file(path);
    file.write("id,name,x,y,angle,vx,vy,omega\n");
    std::string line;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
        const BodyState state = simulation.state(body);
        line = std::to_string(body) + ',';
        append_field(line, scene.bodies[body].name);
        for (const double value : {state.position.x, state.position.y, state.angle, state.velocity.x,
                                   state.velocity.y, state.angular_velocity}) {
            line += ',';
            append_number(line, value);
        }
        line += '\n';
        file.write(line);
    }
    file.close();
}

}  // namespace carom::tool
