#pragma once

#include <cstddef>
#include <utility>

#include "state/bodies.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// Inverse masses as the velocity records of solver `soft` have them, and whether masses call for more than
/// sweeps. Derived when rows, masses or flags have changed.
template <class Real>
class BodyMasses {
  public:
    /// Masses, flags or rows have changed.
    void forget() { are_known_ = false; }
    bool are_known() const { return are_known_; }
    /// Rows have changed, and what was derived from them has followed, but for the masses.
    void follow_rows() { has_followed_rows_ = are_known_, are_known_ = false; }
    /// Whether that is why they were derived anew; asked once.
    bool have_followed_rows() { return std::exchange(has_followed_rows_, false); }
    /// Derives them if they are not known. Cost: O(bodies) then, where masses vary.
    /// @param has_friction  whether contacts have any
    /// @param discs_may_turn  whether something may turn a disc: friction, joints, or contacts of shapes; if
    /// nothing does, none has a fixed angle
    /// @return whether they were derived anew
    bool derive(const Bodies<Real>& bodies, bool has_friction, bool discs_may_turn);

    /// 1/kg, by row: zero for what nothing moves, negative for a fixed angle. Null: all have the same.
    const Real* inverse() const { return vary_ ? inverse_.data() : nullptr; }
    const Column<Real>& inverse_column() const { return inverse_; }
    /// Whether some bodies do not turn.
    bool some_are_fixed() const { return some_are_fixed_; }
    /// Whether the heaviest body is so much heavier than the lightest one that sweeps do not converge soon
    /// enough: solvers/contact_sets/local_solve.hpp.
    bool are_uneven() const { return are_uneven_; }
    /// How many times heavier the heaviest body is than the lightest one; 1 where masses do not vary.
    double ratio() const { return ratio_; }
    /// Whether the heaviest body is more than a thousand times heavier than the lightest one, without
    /// friction more than three hundred times.
    bool are_very_uneven() const { return are_very_uneven_; }
    /// Whether bodies that differ so much are mixed, so that even that may not do.
    bool are_mixed() const { return are_mixed_; }

    std::size_t bytes() const { return inverse_.bytes(); }

  private:
    bool are_known_ = false, has_followed_rows_ = false, vary_ = false, some_are_fixed_ = false;
    bool are_uneven_ = false, are_very_uneven_ = false, are_mixed_ = false;
    double ratio_ = 1;
    Column<Real> inverse_;
};

extern template class BodyMasses<float>;
extern template class BodyMasses<double>;

}  // namespace carom
