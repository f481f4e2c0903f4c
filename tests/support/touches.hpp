#pragma once

#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "math/random.hpp"

namespace carom::test {

/// What is done to a world in every step of B39: three bodies are removed, added, thrown or put elsewhere. It
/// is the same for the same seed, whatever rows bodies have.
template <class Real>
class Touches {
  public:
    struct Rules {
        std::function<Body(Random&)> make;                        ///< a body that is added, but for its place
        std::function<bool(std::uint32_t index)> may_be_touched;  ///< by the index of a handle
        double width;                                             ///< m, of the pile
        double low, high;  ///< m, between which free places are looked for
        double apart;      ///< m, from the centres of all others
    };
    Touches(std::uint64_t seed, Rules rules) : random_(seed), rules_(std::move(rules)) {}

    void touch(BasicWorld<Real>& world) {
        for (int i = 0; i < 3; ++i) {
            const BodyId body = pick(world);
            switch (random_.below(4)) {
                case 0:
                    world.remove(body);
                    break;
                case 1: {
                    Body added = rules_.make(random_);
                    added.position = free_place(world);
                    world.add(added);
                    break;
                }
                case 2:
                    world.set_velocity(body, {random_.uniform(-3, 3), 5});
                    break;
                case 3:
                    world.set_position(body, free_place(world));
                    break;
            }
        }
    }

  private:
    Vec2 free_place(const BasicWorld<Real>& world) {
        for (;;) {
            const Vec2 place{random_.uniform(1, rules_.width - 1), random_.uniform(rules_.low, rules_.high)};
            const auto bodies = world.bodies();
            bool is_free = true;
            for (std::size_t i = 0; i < bodies.count; ++i)
                is_free &=
                    std::hypot(bodies.position_x[i] - place.x, bodies.position_y[i] - place.y) > rules_.apart;
            if (is_free) return place;
        }
    }
    BodyId pick(const BasicWorld<Real>& world) {
        std::vector<BodyId> ids;
        for (const BodyId id : world.bodies().id)
            if (rules_.may_be_touched(id.index)) ids.push_back(id);
        std::sort(ids.begin(), ids.end(), [](BodyId a, BodyId b) { return a.index < b.index; });
        return ids[random_.below(ids.size())];
    }

    Random random_;
    Rules rules_;
};

}  // namespace carom::test
