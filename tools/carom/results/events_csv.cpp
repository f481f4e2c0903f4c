#include "results/events_csv.hpp"

#include <cmath>
#include <initializer_list>

namespace carom::tool {
namespace {

/// A body by its place in the scene; the world is an empty cell.
std::string cell_of(BodyId body) {
    return body == BodyId{} ? std::string() : std::to_string(body.index);
}

void append_cells(std::string& row, std::initializer_list<double> values) {
    for (const double value : values) {
        row += ',';
        append_number(row, value);
    }
}

std::string row_of(const SensorEvent& event) {
    std::string row;
    append_number(row, event.time);
    row += event.begins ? ",sensor_begin," : ",sensor_end,";
    row += cell_of(event.sensor) + ',' + cell_of(event.body);
    append_cells(row, {event.position.x, event.position.y});
    return row + ",,,,,\n";
}

/// The direction is that of the force on b; a break has no speed.
std::string row_of(const JointBreak& each, double dt) {
    const double force = std::hypot(each.force.x, each.force.y), per_force = force > 0 ? 1 / force : 0;
    std::string row;
    append_number(row, each.time);
    row += ",break," + cell_of(each.a) + "," + cell_of(each.b);
    append_cells(row, {each.point.x, each.point.y, per_force * each.force.x, per_force * each.force.y});
    row += ',';
    append_cells(row, {force * dt});
    return row + "," + std::to_string(each.joint.index) + "\n";
}

}  // namespace

EventsCsv::EventsCsv(const std::filesystem::path& path) : file_(path) {
    file_.write("time,kind,a,b,x,y,nx,ny,speed,impulse,joint\n");
}

void EventsCsv::append(const Events& events, double dt) {
    for (const SensorEvent& event : events.sensor) file_.write(row_of(event));
    for (const JointBreak& each : events.breaks) file_.write(row_of(each, dt));
}

}  // namespace carom::tool
