#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <utility>

namespace carom {

/// Why a step ended before its time, if it did. The embedding program is asked after every so much work, not
/// time, so that the same step asks at the same places.
class Interruption {
  public:
    // Work of what loops do, in units of about 10 ns.
    static constexpr std::size_t kImpact = 32;  ///< one impact, with a look at the neighbours
    static constexpr std::size_t kUpdate = 1;   ///< one contact in a sweep

    void set_question(std::function<bool()> should_stop) { should_stop_ = std::move(should_stop); }
    const std::function<bool()>& question() const { return should_stop_; }

    /// A step begins.
    void start() { work_left_ = kWorkBetweenQuestions, has_stopped_ = false, exceeded_.clear(); }

    /// To be called by loops that may be long, on the thread of the step, before or after a piece of work.
    /// @return whether the step is to end here
    bool is_due_after(std::size_t work) {
        if (work < work_left_) {
            work_left_ -= work;
            return has_stopped_;
        }
        work_left_ = kWorkBetweenQuestions;
        return has_stopped_ = has_stopped_ || ask();
    }

    /// Ends the step because it needs more work than a step may. @param statement  for the error, with the
    /// bodies
    void give_up(std::string statement) { has_stopped_ = true, exceeded_ = std::move(statement); }

    bool has_stopped() const { return has_stopped_; }
    /// What give_up was told; empty if the embedding program ended the step.
    const std::string& exceeded() const { return exceeded_; }
    /// Throws what should_stop has thrown, if it has.
    void rethrow() {
        if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    }

  private:
    static constexpr std::size_t kWorkBetweenQuestions = 1 << 16;  // some 1 ms

    bool ask() {
        if (!should_stop_) return false;
        try {
            return should_stop_();
        } catch (...) {  // threads stand by: it leaves the step when they are gone
            thrown_ = std::current_exception();
            return true;
        }
    }

    std::function<bool()> should_stop_;
    std::size_t work_left_ = kWorkBetweenQuestions;
    bool has_stopped_ = false;
    std::string exceeded_;
    std::exception_ptr thrown_;
};

}  // namespace carom
