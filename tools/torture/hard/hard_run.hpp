#pragma once

#include <carom/scene.hpp>
#include <carom/world.hpp>

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace carom::torture {

inline constexpr double kUsualStep = 1.0 / 60;  // s

/// A world as a hard case steps it and looks at it, whoever has made it: a test or `carom torture`. Bodies
/// are counted as in the scene.
class HardRun {
  public:
    virtual ~HardRun() = default;

    /// @return false, without a step, once the time that the run may take is up
    virtual bool step(double dt = kUsualStep) = 0;
    virtual const Scene& scene() const = 0;
    virtual BodyState state(std::size_t body) const = 0;
    virtual double energy() const = 0;       ///< J
    virtual double unexplained() const = 0;  ///< J, by the ledger; 0 without one
    virtual double driven() const = 0;       ///< J, what drives have given, by the ledger; 0 without one
    virtual double overlap() const = 0;      ///< the largest, in radii of the smaller body
    virtual double joint_gap() const = 0;    ///< m, the largest
    virtual std::size_t quarantined() const = 0;
    virtual std::size_t asleep() const = 0;
    virtual void set_velocity(std::size_t body, Vec2 velocity) = 0;  ///< m/s
    /// Another scene under the same solver, in the same precision.
    virtual std::unique_ptr<HardRun> another(const Scene& scene) const = 0;

    /// @return false if the time is up
    bool steps(int number, double dt = kUsualStep) {
        for (int i = 0; i < number; ++i)
            if (!step(dt)) return false;
        return true;
    }
    Vec2 place(std::size_t body) const { return state(body).position; }
    double speed(std::size_t body) const {
        const Vec2 v = state(body).velocity;
        return std::hypot(v.x, v.y);
    }
    std::size_t count() const { return scene().bodies.size(); }
    std::size_t last() const { return count() - 1; }
    bool is_dynamic(std::size_t body) const { return scene().bodies[body].type == BodyType::dynamic_body; }
    /// m/s, of the dynamic bodies.
    double rms_speed() const {
        double squares = 0, bodies = 0;
        for (std::size_t i = 0; i < count(); ++i)
            if (is_dynamic(i)) squares += speed(i) * speed(i), bodies += 1;
        return bodies > 0 ? std::sqrt(squares / bodies) : 0;
    }
};

/// The largest of some numbers. One that is none stays, so that no mark is passed.
class Largest {
  public:
    void take(double number) {
        if (!std::isnan(value_) && !(number <= value_)) value_ = number;
    }
    double value() const { return value_; }

  private:
    double value_ = 0;
};

/// How far bodies are from where they were.
class Shifts {
  public:
    explicit Shifts(const HardRun& run) {
        for (std::size_t i = 0; i < run.count(); ++i) start_.push_back(run.place(i));
    }
    Vec2 start(std::size_t body) const { return start_[body]; }
    double farthest(const HardRun& run) const {  // m
        Largest farthest;
        for (std::size_t i = 0; i < start_.size(); ++i)
            farthest.take(std::hypot(run.place(i).x - start_[i].x, run.place(i).y - start_[i].y));
        return farthest.value();
    }
    double sink(const HardRun& run, std::size_t body) const { return start_[body].y - run.place(body).y; }

  private:
    std::vector<Vec2> start_;
};

}  // namespace carom::torture
