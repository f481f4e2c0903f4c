#pragma once

#include <carom/events.hpp>

#include <array>
#include <compare>
#include <cstddef>
#include <vector>

namespace carom {

/// A body in a sensor.
struct SensedPair {
    BodyId sensor, body;

    friend bool operator==(const SensedPair&, const SensedPair&) = default;
    friend auto operator<=>(const SensedPair& left, const SensedPair& right) {
        const auto key = [](const SensedPair& pair) {
            return std::array{pair.sensor.index, pair.body.index, pair.sensor.generation,
                              pair.body.generation};
        };
        return key(left) <=> key(right);
    }
};

/// The sensors of a world, what is in them, and what was told of it.
struct Sensing {
    bool is_on = true;   // events of sensors are wanted
    bool keeps = false;  // events stay until they are cleared
    std::vector<BodyId> sensors;
    std::vector<SensedPair> inside;  // sorted
    std::vector<SensorEvent> events;

    /// Whether a step has to look: a body may have to leave a sensor that is gone, too.
    bool is_called_for() const { return is_on && !(sensors.empty() && inside.empty()); }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.is_on, self.keeps, self.sensors, self.inside, self.events);
    }

    std::size_t bytes() const {
        return sensors.capacity() * sizeof(BodyId) + inside.capacity() * sizeof(SensedPair) +
               events.capacity() * sizeof(SensorEvent);
    }
};

}  // namespace carom
