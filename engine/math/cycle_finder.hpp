#pragma once

namespace carom {

/// Finds that an iteration which follows from its state alone is back at an earlier one (Brent 1980): what it
/// comes to later is known then, so whole turns of the cycle can be left out.
template <class State>
class CycleFinder {
  public:
    /// The iteration begins, or goes on by another rule: earlier states do not count.
    void begin() { of_earlier_ = -1; }
    /// To be called after each round, with the state that it ended with.
    /// @return the last round, up to `last`, that ends with this state as well; `round` while no cycle is
    /// known
    int same_at(const State& state, int round, int last) {
        if (of_earlier_ >= 0 && state == earlier_) {
            const int period = round - of_earlier_;
            begin();
            return last - (last - round) % period;
        }
        if (of_earlier_ < 0 || round - of_earlier_ == pause_) {
            pause_ = of_earlier_ < 0 ? 1 : 2 * pause_;
            of_earlier_ = round, earlier_ = state;
        }
        return round;
    }

  private:
    State earlier_;
    int of_earlier_ = -1;  // round; -1: there is none
    int pause_ = 1;        // rounds after which another state takes its place
};

}  // namespace carom
