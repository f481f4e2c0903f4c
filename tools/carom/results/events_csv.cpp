#include "results/events_csv.hpp"

namespace carom::tool {

EventsCsv::EventsCsv(const std::filesystem::path& path) : file_(path) {
    file_.write("time,kind,a,b,x,y,nx,ny,speed,impulse\n");
}

void EventsCsv::append(const Events& events) {
    for (const SensorEvent& event : events.sensor) {
        line_.clear();
        append_number(line_, event.time);
        line_ += event.begins ? ",sensor_begin," : ",sensor_end,";
        line_ += std::to_string(event.sensor.index) + ',' + std::to_string(event.body.index);
        for (const double value : {event.position.x, event.position.y}) {
            line_ += ',';
            append_number(line_, value);
        }
        line_ += ",,,,\n";
        file_.write(line_);
    }
}

}  // namespace carom::tool
