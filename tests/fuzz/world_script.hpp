#pragma once

#include <carom/carom.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "byte_source.hpp"
#include "call_arguments.hpp"
#include "requirement.hpp"

namespace carom::fuzz {

/// What a host throws out of its parallel-for or its `should_stop`.
struct HostFailure : std::runtime_error {
    HostFailure() : std::runtime_error("the host fails") {}
};

/// A world, and calls on it that bytes choose. Whatever they are: a call does what it says, or throws `Error`
/// and leaves the world as it was, and what is in the world stays finite and consistent.
template <class Real>
class WorldScript {
  public:
    explicit WorldScript(ByteSource bytes) : bytes_(bytes) {}

    void run() {
        Scene scene = scene_from(bytes_);
        fill(scene);
        WorldOptions options = options_from_bytes();
        try {
            world_.emplace(scene, options);
        } catch (const Error& error) {
            check_message(error);
            return;
        }
        for (const BodyId id : world_->bodies().id) bodies_.push_back(id);
        for (std::size_t i = 0; i < scene.joints.size(); ++i)
            joints_.push_back(JointId::of(static_cast<std::uint32_t>(i)));
        alive_ = bodies_.size();
        check_world();
        for (int calls = 0; calls < kMostCalls && !bytes_.is_empty(); ++calls) guarded_call();
    }

  private:
    using World = BasicWorld<Real>;

    static constexpr int kMostCalls = 80;
    static constexpr std::size_t kMostBodies = 40;
    static constexpr int kMostSteps = 60;      // in all
    static constexpr int kMostQuestions = 40;  // of should_stop a step, about a millisecond each
    static constexpr std::size_t kLongestMessage = 2000;

    /// What a call that throws must leave as it is.
    struct Summary {
        std::uint64_t hash;
        std::size_t bodies, joints;
        double time;
        std::string solver;
        std::vector<std::string> on;
        bool operator==(const Summary&) const = default;
    };

    Summary summary() const {
        const Plan plan = world_->plan();
        Summary all{world_->state_hash(), world_->body_count(), world_->joint_count(),
                    world_->time(),       plan.solver,          {}};
        for (const EffectReport& effect : plan.effects)
            if (effect.on) all.on.push_back(effect.name);
        return all;
    }

    static void check_message(const Error& error) {
        const std::string_view message = error.what();
        require(!message.empty() && message.size() <= kLongestMessage, "messages are short");
        for (const char c : message) require(static_cast<unsigned char>(c) >= 0x20, "messages are one line");
    }

    void fill(Scene& scene) {
        const std::size_t items = bytes_.below(10);
        for (std::size_t i = 0; i < items; ++i) {
            const std::size_t kind = bytes_.below(8);
            if (kind < 5) {
                scene_bodies_.push_back(scene.add(body_from(bytes_)));
            } else if (kind < 7) {
                scene_joints_.push_back(scene.add(joint_from(bytes_, scene_bodies_, scene_joints_)));
            } else {
                try {
                    generate_from(bytes_, scene, scene_joints_);
                } catch (const Error& error) {
                    check_message(error);
                }
            }
        }
        // What cannot be is left out, so that most scripts come to have a world.
        if (bytes_.once_in(16)) return;
        Scene alone = scene;
        alone.joints.clear();
        std::erase_if(scene.bodies, [&](const Body& body) {
            alone.bodies = {body};
            return alone.find_problem().has_value();
        });
        if (scene.find_problem()) scene.joints.clear();
    }

    WorldOptions options_from_bytes() {
        WorldOptions options;
        options.threads = 1;
        const std::uint8_t parts = bytes_.byte();
        options.keep_events = (parts & 1) != 0;
        if ((parts & 6) == 6) options.effects = effects_from(bytes_);
        if ((parts & 24) == 24) options.solver = solver_from(bytes_);
        if (parts & 32) {
            host_fails_at_ = bytes_.byte();
            options.parallel_for = [this](std::size_t count, const std::function<void(std::size_t)>& task) {
                const bool fails = ++loops_ % 8 == host_fails_at_ % 8;
                for (std::size_t i = 0; i < (fails ? count / 2 : count); ++i) task(i);
                if (fails) throw HostFailure();
            };
        }
        const bool throws = (parts & 192) == 192;
        options.should_stop = [this, throws] {
            if (++questions_ < kMostQuestions) return false;
            if (throws) throw HostFailure();
            return true;
        };
        return options;
    }

    /// A handle of this world, of a body that was removed, or of none.
    BodyId body() {
        if (bodies_.empty()) return {};
        const std::uint8_t choice = bytes_.byte();
        if (choice >= 250) return {choice, choice % 3u};
        return bodies_[choice % bodies_.size()];
    }
    JointId joint() {
        if (joints_.empty()) return {};
        const std::uint8_t choice = bytes_.byte();
        if (choice >= 250) return JointId::of(choice, choice % 3u);
        return joints_[choice % joints_.size()];
    }

    void guarded_call() {
        const Summary before = summary();
        questions_ = 0;
        may_end_early_ = false;
        try {
            call();
        } catch (const Error& error) {
            check_message(error);
            if (!may_end_early_) require(summary() == before, "after an Error the world is as it was");
        } catch (const HostFailure&) {
        }
        check_world();
    }

    void call() {
        switch (bytes_.below(26)) {
            case 0:
            case 1:
            case 2:
            case 3:
            case 4:
                return step();
            case 5:
            case 6:
            case 7: {
                const Body body = body_from(bytes_);
                if (alive_ >= kMostBodies) return;
                bodies_.push_back(world_->add(body));
                ++alive_;
                return;
            }
            case 8:
            case 9:
                joints_.push_back(world_->add(joint_from(bytes_, bodies_, joints_)));
                return;
            case 10:
                world_->remove(body());
                --alive_;
                return;
            case 11:
                return world_->remove(joint());
            case 12: {
                const BodyId moved = body();
                return world_->set_position(moved, bytes_.point(1));
            }
            case 13: {
                const BodyId moved = body();
                return world_->set_velocity(moved, bytes_.point(1));
            }
            case 14: {
                const BodyId moved = body();
                return world_->set_angular_velocity(moved, bytes_.number(2));
            }
            case 15: {
                const BodyId changed = body();
                return world_->set_filter(changed, filter_from(bytes_));
            }
            case 16:
                return world_->set_solver(solver_from(bytes_));
            case 17: {
                const JointId driven = joint();
                const double speed = bytes_.number(1);
                return world_->set_motor(driven, speed, bytes_.number(2));
            }
            case 18: {
                const JointId limited = joint();
                const double lower = bytes_.number(0.3);
                return world_->set_limits(limited, lower, bytes_.number(0.5));
            }
            case 19: {
                const JointId drawn = joint();
                return world_->set_target(drawn, bytes_.point(1));
            }
            case 20:
                saved_.resize(world_->state_bytes());
                world_->save_state(saved_);
                saved_alive_ = alive_, saved_bodies_ = bodies_, saved_joints_ = joints_;
                return;
            case 21:
                if (saved_.empty()) return;
                world_->restore_state(saved_);
                alive_ = saved_alive_, bodies_ = saved_bodies_, joints_ = saved_joints_;
                return;
            case 22:
                return compare_with_copy();
            case 23:
                return ask_of_body();
            case 24:
                return ask_of_joint();
            default:
                return ask_of_world();
        }
    }

    double dt_from_bytes() {
        const std::uint8_t choice = bytes_.byte();
        if (choice < 160) return 1.0 / 60;
        if (choice < 200) return 1.0 / (choice - 159);
        return bytes_.number(0.05);
    }

    void step() {
        const double dt = dt_from_bytes();
        const int count = bytes_.once_in(4) ? 8 : 1;
        for (int i = 0; i < count && steps_ < kMostSteps; ++i) {
            ++steps_;
            questions_ = 0;
            const double before = world_->time();
            may_end_early_ = dt >= kSmallestStep && dt <= kLargestStep;
            world_->step(dt);
            require(world_->time() >= before, "time goes on");
        }
    }

    /// A copy takes the same way.
    void compare_with_copy() {
        World copy(*world_);
        require(copy.state_hash() == world_->state_hash(), "a copy has the same state");
        if (steps_ >= kMostSteps) return;
        ++steps_;
        may_end_early_ = true;
        const double dt = dt_from_bytes();
        const int loops = loops_;
        bool ended = false;  // early, or not taken
        const auto try_step = [&](World& world) {
            questions_ = 0, loops_ = loops;
            try {
                world.step(dt);
            } catch (const Error&) {
                ended = true;
            } catch (const HostFailure&) {
            }
        };
        try_step(*world_), try_step(copy);
        require(ended || copy.state_hash() == world_->state_hash(), "a copy takes the same way");
    }

    void ask_of_body() {
        const BodyId asked = body();
        const std::size_t row = world_->row(asked);
        require(row < world_->body_count() && world_->bodies().id[row] == asked, "a row is that of its body");
        static_cast<void>(world_->state(asked));
        static_cast<void>(world_->shape(asked));
        static_cast<void>(world_->is_asleep(asked));
        static_cast<void>(world_->filter(asked));
        for (const BodyId inside : world_->sensed(asked))
            require(inside != asked, "a sensor does not sense itself");
    }

    void ask_of_joint() {
        const JointId asked = joint();
        const Vec2 force = world_->joint_force(asked);
        require(std::isfinite(force.x) && std::isfinite(force.y), "forces of joints are finite");
        require(std::isfinite(world_->joint_torque(asked)), "torques of joints are finite");
        for (const Vec2 anchor : world_->joint_anchors(asked))
            require(std::isfinite(anchor.x) && std::isfinite(anchor.y), "anchors are finite");
        require(world_->is_alive(asked), "a joint that answers is alive");
    }

    void ask_of_world() {
        if (bytes_.flag()) world_->clear_events();
        const Events events = world_->events();
        for (const SensorEvent& event : events.sensor)
            require(event.time <= world_->time(), "events are of the past");
        for (const JointBreak& event : events.breaks)
            require(!world_->is_alive(event.joint), "a broken joint is gone");
        static_cast<void>(world_->broken_joints());
        static_cast<void>(world_->joint_errors());
        static_cast<void>(world_->profile());
        require(world_->quarantined().size() <= world_->body_count(), "quarantined bodies are bodies");
        const OverlapReport overlaps = world_->overlaps();
        require(overlaps.touching <= overlaps.candidates && overlaps.mean <= overlaps.max * 1.0001,
                "overlaps are consistent");
    }

    void check_world() const {
        const BodyView<Real> view = world_->bodies();
        require(view.count == alive_ && world_->body_count() == alive_, "bodies are those that were added");
        for (std::size_t i = 0; i < view.count; ++i) {
            require(std::fabs(view.position_x[i]) <= kLargestPosition * 1.0001 &&
                        std::fabs(view.position_y[i]) <= kLargestPosition * 1.0001,
                    "positions are within their limits");
            require(std::fabs(view.velocity_x[i]) <= kLargestSpeed * 1.0001 &&
                        std::fabs(view.velocity_y[i]) <= kLargestSpeed * 1.0001,
                    "velocities are within their limits");
            if (!view.angle.empty())
                require(std::isfinite(view.angle[i]) && std::isfinite(view.angular_velocity[i]),
                        "angles are finite");
            require(world_->row(view.id[i]) == i, "rows and handles agree");
        }
        std::size_t joints = 0;
        for (const JointId id : joints_) joints += world_->is_alive(id) ? 1 : 0;
        require(joints == world_->joint_count(), "joints are those that were added");
        const Ledger ledger = world_->ledger();
        require(std::isfinite(ledger.energy.kinetic) && std::isfinite(ledger.energy.rotational) &&
                    std::isfinite(ledger.energy.potential),
                "energies are finite");
    }

    ByteSource bytes_;
    std::optional<World> world_;
    std::vector<BodyId> scene_bodies_;
    std::vector<JointId> scene_joints_;
    std::vector<BodyId> bodies_, saved_bodies_;  // ever added
    std::vector<JointId> joints_, saved_joints_;
    std::size_t alive_ = 0, saved_alive_ = 0;
    std::vector<std::byte> saved_;
    int steps_ = 0, questions_ = 0, loops_ = 0, host_fails_at_ = 0;
    bool may_end_early_ = false;
};

}  // namespace carom::fuzz
