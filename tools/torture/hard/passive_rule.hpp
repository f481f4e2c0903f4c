#pragma once

#include <carom/scene.hpp>

#include <cmath>
#include <optional>

#include "torture/energy_rule.hpp"
#include "torture/hard/hard_case.hpp"

namespace carom::torture {

/// The most that energy was above its first value, over the magnitude of that.
class EnergyRise {
  public:
    explicit EnergyRise(const HardRun& run) : EnergyRise(run, std::fabs(run.energy())) {}
    /// @param scale  J: what the rise is a share of
    EnergyRise(const HardRun& run, double scale) : start_(run.energy()), scale_(scale) {}

    void look(const HardRun& run) {
        const double more = run.energy() - start_;
        rise_.take(more == 0 ? 0 : more / scale_);
    }
    Measure measure() const { return {"energy rise", rise_.value(), kLargestRise}; }

  private:
    double start_, scale_;
    Largest rise_;
};

/// What holds of every body of a scene that nothing drives: it is no faster than falling makes it, and inside
/// the walls.
class PassiveRule {
  public:
    static constexpr double kLargestSpeed = 1.05;  // over that of the fastest, fallen through the scene

    explicit PassiveRule(const Scene& scene) : walls_(scene.walls) {
        double low = 1e300, high = -1e300, fastest = 0;
        for (const Body& body : scene.bodies) {
            low = std::fmin(low, body.position.y), high = std::fmax(high, body.position.y);
            fastest =
                std::fmax(fastest, body.velocity.x * body.velocity.x + body.velocity.y * body.velocity.y);
        }
        if (walls_) low = walls_->min.y;
        const double gravity = std::hypot(scene.gravity.x, scene.gravity.y);
        speed_of_fall_ = std::sqrt(fastest + 2 * gravity * (high - low)) + 1e-6;
    }

    /// @return whether a body keeps it
    bool look(Vec2 x, Vec2 v) {
        const double speed = std::hypot(v.x, v.y) / speed_of_fall_;
        speed_.take(speed);
        const bool is_in = is_inside(x);
        outside_ += is_in ? 0 : 1;
        return is_in && speed <= kLargestSpeed;
    }
    /// After every step.
    void look(const HardRun& run) {
        for (std::size_t i = 0; i < run.count(); ++i) {
            const BodyState state = run.state(i);
            look(state.position, state.velocity);
        }
    }
    Measures measures(const HardRun& run) const {
        return {{"speed/fall", speed_.value(), kLargestSpeed},
                {"outside", static_cast<double>(outside_), 0},
                {"quarantined", static_cast<double>(run.quarantined()), 0}};
    }

  private:
    bool is_inside(Vec2 x) const {
        if (!std::isfinite(x.x) || !std::isfinite(x.y)) return false;
        if (!walls_) return true;
        return (!walls_->left || x.x > walls_->min.x) && (!walls_->right || x.x < walls_->max.x) &&
               (!walls_->bottom || x.y > walls_->min.y) && (!walls_->top || x.y < walls_->max.y);
    }

    std::optional<Walls> walls_;
    double speed_of_fall_ = 0;
    Largest speed_;
    int outside_ = 0;
};

/// Both rules of a scene that nothing drives.
class Passive {
  public:
    explicit Passive(const HardRun& run) : rise_(run), rule_(run.scene()) {}
    /// After every step.
    void look(const HardRun& run) { rise_.look(run), rule_.look(run); }
    void add_to(Measures& measures, const HardRun& run) const {
        measures.push_back(rise_.measure());
        for (Measure& measure : rule_.measures(run)) measures.push_back(std::move(measure));
    }

  private:
    EnergyRise rise_;
    PassiveRule rule_;
};

}  // namespace carom::torture
