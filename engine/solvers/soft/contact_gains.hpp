#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solvers/soft/solved_substep.hpp"

namespace carom {

/// Keeps contacts of discs from doing work, in crowds that bounce, are hit or lie deep in each other.
///
/// A substep begins with the impulses of the one before, which are too large where a crowd has come apart or
/// was struck, and sweeps do not take all of that back. Where all contacts together have done work at the end
/// of a substep, shares are taken from impulses until they do none: first from the largest, by the speed that
/// each gives, then from ever smaller ones, too, so that what bears a heap is left as far as blows suffice.
/// The next substep foresees what was solved. docs/decisions/0099-work-of-what-lies-on-each-other.md.
template <class Real>
class ContactGains {
  public:
    /// What a step that was interrupted has taken is not given back.
    void begin_step() { has_taken_ = false; }
    /// Whether impulses have done work, to be asked when all velocities of the substep are solved: of
    /// contacts, or of surfaces that move. Cost: 0.5 ns a body.
    static bool does_work(const SolvedSubstep<Real>& solved) { return measure(solved).is_more(); }
    /// Takes what contacts have done. Cost: likewise; 20 ns a contact and 20 ns one that is scaled.
    void take(const SolvedSubstep<Real>& solved);
    /// Whether the last call has taken something that is not given back.
    bool has_taken() const { return has_taken_; }
    /// Behind it, once the substep is booked: impulses are those that were solved, which the next substep
    /// begins with and foresees.
    void give_back(const StepView<Real>& contacts);
    /// Calls fn(row) for the bodies that were left with too little to hold them apart.
    template <class Fn>
    void for_each_cut(const StepView<Real>& contacts, const Bodies<Real>& bodies, const Fn& fn) const {
        const double h = contacts.terms.substep_dt;
        for (const std::int32_t row : rows_) {
            const auto r = static_cast<std::size_t>(row);
            const double x = h * taken_[r][0], y = h * taken_[r][1],
                         least = kLeftMoving * static_cast<double>(bodies.radius[r]);
            if (x * x + y * y > least * least) fn(row);
        }
    }

    std::size_t bytes() const;

  private:
    using Velocity = std::array<double, 3>;  // m/s: vx, vy, rim speed
    /// Bodies that taking impulses from them moves by more than this share of their radius in a substep come
    /// into others, as far as what impacts leave closing: impacts.cpp.
    static constexpr double kLeftMoving = 0.002;

    /// A contact that pushes.
    struct Giver {
        double of_surface;    // J, the part of its work that the other side's own motion has
        float speed;          // m/s, that its normal impulse gives to its effective mass
        std::uint32_t place;  // in the store of pairs; behind these in that of supports
    };
    /// A contact that is scaled.
    struct Scaled {
        std::uint32_t place;
        std::array<Real, 3> impulses;  // N s, that were solved: normal, friction, rolling
    };
    /// What the impulses of those have given, and what is left of it: sums over the bodies.
    struct Sums {
        double along = 0;   // J, what a share takes of the work, while it is small
        double square = 0;  // J, half of these velocities' product
    };

    struct Work {
        double done, least;  // J; more than the latter is neither round-off nor what sweeps leave
        bool is_more() const { return done > least; }
    };

    static Work measure(const SolvedSubstep<Real>& solved);
    double find_givers(const SolvedSubstep<Real>& solved);
    void begin(std::size_t rows);
    void add(const SolvedSubstep<Real>& solved, const Giver& giver);
    Sums sums_of(const SolvedSubstep<Real>& solved) const;
    void scale(const SolvedSubstep<Real>& solved);

    bool has_taken_ = false;
    std::vector<Giver> givers_;
    std::vector<Scaled> scaled_;            // the largest first, by speeds
    std::vector<std::size_t> ends_;         // of these, one a speed
    std::vector<double> shares_;            // that are left of them
    std::vector<Velocity> given_, taken_;   // [rows], by impulses of these; of all, what is taken
    std::vector<std::uint8_t> is_changed_;  // [rows]
    std::vector<std::int32_t> rows_;        // of these bodies
    double of_surfaces_ = 0;                // J, like Giver::of_surface, of those that are scaled
};

extern template class ContactGains<float>;
extern template class ContactGains<double>;

}  // namespace carom
