#pragma once

#include <cmath>

namespace carom {

/// A limit of a joint: where its coordinate ends.
///
/// It is set between steps. If it was set for the step before, too, then it moves through the step, at the
/// rate of the slower of the two changes, and what it holds gets its velocity: so a rope is reeled in, and a
/// lift raised. The rest of a change is there when the step begins, and bodies are displaced: so one that is
/// set once, by any way, throws nothing.
struct JointLimit {
    double at = 0;    ///< m or rad, at the end of the step
    double rate = 0;  ///< m/s or rad/s, in this step

    /// It has been there always.
    void put(double value) { *this = {}, at = before_ = value; }
    /// @param until_end  s, to the end of the step
    double before_end(double until_end) const { return at - until_end * rate; }

    void begin_step(double dt) {
        const double change = (at - before_) / dt;
        rate = change * last_change_ > 0
                   ? std::copysign(std::fmin(std::fabs(change), std::fabs(last_change_)), change)
                   : 0;
    }
    /// @return whether it was set for this step
    bool end_step(double dt) {
        last_change_ = (at - before_) / dt;
        before_ = at, rate = 0;
        return last_change_ != 0;
    }

  private:
    double before_ = 0;       // m or rad, at the end of the step before
    double last_change_ = 0;  // m/s or rad/s, by which it was set elsewhere for the step before
};

}  // namespace carom
