#pragma once

#include <carom/world.hpp>

#include <array>
#include <vector>

namespace carom {

/// What a world does with joints between steps: BasicWorld has the same members, which say what is thrown.
template <class Real>
class WorldJoints {
  public:
    using Implementation = typename BasicWorld<Real>::Implementation;

    explicit WorldJoints(Implementation& own) : own_(own) {}

    JointId add(const Joint& joint);
    void remove(JointId joint);
    void set_motor(JointId joint, double speed, double most);
    void set_limits(JointId joint, double lower, double upper);
    void set_target(JointId joint, Vec2 target);

    std::size_t count() const;
    bool is_alive(JointId joint) const;
    Vec2 force(JointId joint) const;
    double torque(JointId joint) const;
    std::array<Vec2, 2> anchors(JointId joint) const;
    JointErrors errors() const;
    std::vector<JointId> broken() const;

  private:
    Implementation& own_;
};

extern template class WorldJoints<float>;
extern template class WorldJoints<double>;

}  // namespace carom
