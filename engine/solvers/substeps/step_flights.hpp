#pragma once

namespace carom {

/// The flights of equal length that a step is cut into: one, unless bodies come so far in a step that pairs
/// which may touch in it, not bodies, would be the work. docs/decisions/0105-flights-of-a-step.md.
///
/// Their number is a power of two, and is that of the step before at first. Flights that are halved within a
/// step leave those before as they were.
class StepFlights {
  public:
    static constexpr int kMost = 64;

    /// @param dt  s
    void begin_step(double dt) { dt_ = dt, parts_done_ = 0; }
    /// To be called between steps alone.
    void lengthen() { count_ /= 2; }
    /// @return whether the present flight, and those to come, are half as long now
    bool shorten() {
        if (count_ == kMost) return false;
        count_ *= 2;
        return true;
    }
    void end_flight() { parts_done_ += kMost / count_; }

    /// Flights a step.
    int count() const { return count_; }
    /// s, of a flight
    double length() const { return dt_ / count_; }
    /// s, of the step
    double length_of_step() const { return dt_; }
    /// s, of the step behind the present flight
    double left() const { return dt_ * (static_cast<double>(kMost - parts_done_ - kMost / count_) / kMost); }
    bool is_first() const { return parts_done_ == 0; }
    bool is_last() const { return parts_done_ + kMost / count_ == kMost; }
    /// s since the start of the step
    double elapsed() const { return dt_ * (static_cast<double>(parts_done_) / kMost); }
    bool are_done() const { return parts_done_ == kMost; }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.count_);
    }

  private:
    int count_ = 1;
    double dt_ = 0;       // s, of the step
    int parts_done_ = 0;  // of the step's kMost
};

}  // namespace carom
