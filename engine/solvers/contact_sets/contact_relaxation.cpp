#include "solvers/contact_sets/contact_relaxation.hpp"

#include <algorithm>
#include <cmath>

#include "state/columns/index.hpp"

namespace carom {
namespace {

// docs/decisions/0032-piles-of-uneven-masses.md has what other values do.

/// Stiffness of a contact in masses of its heavier body: softer ones give way, stiffer ones take more sweeps.
constexpr double kStiffness = 1;
/// A contact gives way by what gravity adds to a velocity in a substep if its load changes by all of it,
constexpr double kGivesWay = 1;
/// and is stiffened, by this factor at least, if it gives way by more than this share of it.
constexpr double kGivesWayMost = 0.2, kStiffening = 10;
/// Coulomb's law calls for another round if a share of it changes by more than this.
constexpr double kShareOff = 0.1;
constexpr int kSweepsOfRound = 10;  // a round, at most
/// Steps of Newton's method for one body, whose contacts come and go with its velocity.
constexpr int kSteps = 4;
/// Mass of a rim that does not turn, in masses of its body.
constexpr double kRimMass = 1e20;
/// Largest load of a contact, in what stops all bodies that touch each other within a substep: arches and
/// wedges carry some times what they hold up.
constexpr double kMostLoad = 1000;

/// What the work of impulses may miss of what driven bodies have gained, in shares of their energy.
/// docs/decisions/0096-energy-in-random-worlds.md.
constexpr double kMostMissed = 0.1;

/// Adds k (x, y)ᵀ (x, y) to the first rows of a matrix.
template <std::size_t kNumbers>
void add_square(std::array<double, kNumbers>& a, double x, double y, double k) {
    constexpr std::size_t kSecond = kNumbers == 9 ? 3 : 2;  // row
    a[0] += k * x * x, a[kSecond] += k * x * y, a[kSecond + 1] += k * y * y;
}

/// x <- A⁻¹ x, with A = L D Lᵀ.
template <int kSize>
void solve_small(std::array<double, kSize * kSize>& a, std::array<double, kSize>& x) {
    std::array<double, kSize> inverse;  // of D
    for (std::size_t j = 0; j < kSize; ++j) {
        // What round-off has eaten does not move.
        const double pivot = a[kSize * j + j];
        inverse[j] = pivot > 0 ? 1 / pivot : 0;
        for (std::size_t i = j + 1; i < kSize; ++i) {
            const double l = a[kSize * i + j] * inverse[j];
            for (std::size_t k = j + 1; k <= i; ++k) a[kSize * i + k] -= l * a[kSize * k + j];
            x[i] -= l * x[j];
        }
    }
    for (std::size_t i = kSize; i-- > 0;) {
        for (std::size_t k = i + 1; k < kSize; ++k) x[i] -= a[kSize * k + i] * x[k];
        x[i] *= inverse[i];
    }
}

}  // namespace

template <int kSize>
void ContactRelaxation<kSize>::begin(std::span<const LocalContact> contacts, std::size_t bodies) {
    mass_.resize(bodies), start_.resize(bodies), free_.resize(bodies), velocity_.resize(bodies);
    first_.assign(bodies + 2, 0);
    for (const LocalContact& c : contacts) {
        ++first_[index(c.a) + 2];
        if (c.b >= 0) ++first_[index(c.b) + 2];
    }
    for (std::size_t body = 2; body < first_.size(); ++body) first_[body] += first_[body - 1];
    of_bodies_.resize(first_.back());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const LocalContact& c = contacts[i];
        of_bodies_[first_[index(c.a) + 1]++] = static_cast<std::uint32_t>(i);
        if (c.b >= 0) of_bodies_[first_[index(c.b) + 1]++] = static_cast<std::uint32_t>(i);
    }
}

/// Cuts what contacts carry to the most that they may.
template <int kSize>
void ContactRelaxation<kSize>::bound_loads() {
    touching_.reset(mass_.size());
    for (const Law& law : laws_)
        if (law.b >= 0) touching_.join(law.a, law.b);
    double fastest = fall_;
    for (const Velocity& velocity : start_)
        fastest = std::fmax(fastest, std::fabs(velocity[0]) + std::fabs(velocity[1]));
    for (const Law& law : laws_) fastest = std::fmax(fastest, std::fabs(law.surface[0]));
    most_.assign(mass_.size(), 0);
    const auto first_of = [&](std::size_t body) {
        return index(touching_.island_of(static_cast<std::int32_t>(body)));
    };
    for (std::size_t body = 0; body < mass_.size(); ++body)
        most_[first_of(body)] += kMostLoad * fastest * mass_[body][0];
    for (std::size_t body = 0; body < mass_.size(); ++body) most_[body] = most_[first_of(body)];
    for (Law& law : laws_) {
        const double most = most_[index(law.a)];
        law.stiffness = std::fmin(law.stiffness, most / (kGivesWay * fall_));
        if (!(law.carried[0] > most)) continue;
        const double share = most / law.carried[0];
        for (double& impulse : law.carried) impulse *= share;
    }
}

template <int kSize>
void ContactRelaxation<kSize>::set_body(std::size_t body, double inverse_mass, const Velocity& start,
                                        const Velocity& free, const Velocity& swept) {
    for (std::size_t k = 0; k < kSize; ++k) mass_[body][k] = (k < 2 ? 1 : 0.5) / std::fabs(inverse_mass);
    // What does not turn keeps its angle whatever acts on it.
    if constexpr (kIsRough)
        if (inverse_mass < 0) mass_[body][2] = kRimMass * mass_[body][0];
    start_[body] = start, free_[body] = free, velocity_[body] = swept;
}

template <int kSize>
void ContactRelaxation<kSize>::describe(std::span<const LocalContact> contacts, double fall) {
    fall_ = fall;
    laws_.resize(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const LocalContact& c = contacts[i];
        Law law{};
        law.a = c.a, law.b = c.b, law.floor = c.terms.floor;
        law.nx = c.terms.nx, law.ny = c.terms.ny, law.of_a = c.terms.of_a;
        law.surface[0] = c.b < 0 ? c.surface_normal : 0, law.carried[0] = c.impulses.normal;
        if constexpr (kIsRough) {
            law.friction = c.terms.friction, law.rolling = c.terms.rolling;
            if (c.b < 0) law.surface[1] = c.surface_tangent, law.surface[2] = c.surface_rolling;
            law.carried[1] = c.impulses.tangent, law.carried[2] = c.impulses.rolling;
        }
        double heavier = mass_[index(c.a)][0];
        if (c.b >= 0) heavier = std::fmax(heavier, mass_[index(c.b)][0]);
        law.stiffness = std::fmax(kStiffness * heavier, c.impulses.normal / (kGivesWay * fall));
        laws_[i] = law;
    }
    bound_loads();
}

/// What a velocity of one of its bodies is of those of a contact: of v_n, v_t and v_r as
/// effects/contact_law.hpp has them.
template <int kSize>
auto ContactRelaxation<kSize>::part_of_velocity(const Law& law, bool is_b, const Velocity& velocity) -> Rows {
    const double sign = is_b ? 1 : -1, nx = sign * law.nx, ny = sign * law.ny;
    const double along = velocity[0] * nx + velocity[1] * ny;
    if constexpr (kIsRough)
        return {along, velocity[1] * nx - velocity[0] * ny - velocity[2],
                (is_b ? 1 - law.of_a : -law.of_a) * velocity[2]};
    else
        return {along};
}

template <int kSize>
auto ContactRelaxation<kSize>::velocity_of(const Law& law) const -> Rows {
    Rows velocity = law.surface;
    const Rows by_a = part_of_velocity(law, false, velocity_[index(law.a)]);
    for (std::size_t r = 0; r < kRows; ++r) velocity[r] += by_a[r];
    if (law.b < 0) return velocity;
    const Rows by_b = part_of_velocity(law, true, velocity_[index(law.b)]);
    for (std::size_t r = 0; r < kRows; ++r) velocity[r] += by_b[r];
    return velocity;
}

template <int kSize>
double ContactRelaxation<kSize>::impulse_of(const Law& law, std::size_t row, double velocity) {
    if (row == 0) return std::max(0.0, law.carried[0] + law.stiffness * (law.floor - velocity));
    return law.share[row] * (law.carried[row] - law.stiffness * velocity);
}

template <int kSize>
auto ContactRelaxation<kSize>::impulses_of(const Law& law) const -> Rows {
    const Rows velocity = velocity_of(law);
    Rows impulses;
    for (std::size_t r = 0; r < kRows; ++r) impulses[r] = impulse_of(law, r, velocity[r]);
    return impulses;
}

/// Coulomb's law at the present velocities, by a secant: what slides is a damper that takes as much as the
/// law allows at this speed. @return whether any share has changed much
template <int kSize>
bool ContactRelaxation<kSize>::find_shares() {
    bool any = false;
    if constexpr (kIsRough)
        for (Law& law : laws_) {
            const Rows velocity = velocity_of(law);
            const double normal = impulse_of(law, 0, velocity[0]);
            const Rows limit{0, law.friction * normal, law.rolling * normal};
            for (std::size_t r = 1; r < kRows; ++r) {
                const double wanted = std::fabs(law.carried[r] - law.stiffness * velocity[r]);
                const double share = wanted > limit[r] ? limit[r] / wanted : 1;
                any |= std::fabs(share - law.share[r]) > kShareOff * std::fmax(share, law.share[r]);
                law.share[r] = share;
            }
        }
    return any;
}

/// The function that is to become least [J].
template <int kSize>
double ContactRelaxation<kSize>::value() const {
    double sum = 0;
    for (std::size_t body = 0; body < mass_.size(); ++body)
        for (std::size_t k = 0; k < kSize; ++k) {
            const double change = velocity_[body][k] - free_[body][k];
            sum += mass_[body][k] * change * change;
        }
    for (const Law& law : laws_) {
        const Rows impulses = impulses_of(law);
        sum += impulses[0] * impulses[0] / law.stiffness;
        for (std::size_t r = 1; r < kRows; ++r)
            if (law.share[r] > 0) sum += impulses[r] * impulses[r] / (law.share[r] * law.stiffness);
    }
    return 0.5 * sum;
}

/// What the contacts add to the energy of the bodies beyond the slack [J], but for what moving supports
/// drive.
template <int kSize>
double ContactRelaxation<kSize>::gain() const {
    double gain = 0;
    for (std::size_t body = 0; body < mass_.size(); ++body) {
        gain -= slack_ * mass_[body][0] * fall_ * fall_;
        for (std::size_t k = 0; k < kSize; ++k) {
            const double from = free_[body][k], to = velocity_[body][k];
            gain += 0.5 * mass_[body][k] * (to - from) * (to + from);
        }
    }
    for (std::size_t i = 0; i < laws_.size(); ++i)
        for (std::size_t r = 0; r < kRows; ++r) gain += impulses_[i][r] * laws_[i].surface[r];
    return gain;
}

/// Brings a body to where the function is least for it alone. @return whether that changed its velocity
template <int kSize>
bool ContactRelaxation<kSize>::relax(std::size_t body) {
    const std::size_t first = first_[body], count = first_[body + 1] - first;
    const auto law_of = [&](std::size_t e) -> const Law& { return laws_[of_bodies_[first + e]]; };
    if (by_others_.size() < count) by_others_.resize(count);
    for (std::size_t e = 0; e < count; ++e) {
        const Law& law = law_of(e);
        const bool is_b = index(law.a) != body;
        by_others_[e] = law.surface;
        const std::int32_t other = is_b ? law.a : law.b;
        if (other < 0) continue;
        const Rows part = part_of_velocity(law, !is_b, velocity_[index(other)]);
        for (std::size_t r = 0; r < kRows; ++r) by_others_[e][r] += part[r];
    }
    bool has_moved = false;
    for (int step = 0; step < kSteps; ++step) {
        Velocity gradient;
        Matrix second{};
        for (std::size_t k = 0; k < kSize; ++k) {
            gradient[k] = mass_[body][k] * (velocity_[body][k] - free_[body][k]);
            second[(kSize + 1) * k] = mass_[body][k];
        }
        for (std::size_t e = 0; e < count; ++e) {
            const Law& law = law_of(e);
            const bool is_b = index(law.a) != body;
            const Rows part = part_of_velocity(law, is_b, velocity_[body]);
            const double sign = is_b ? 1 : -1, nx = sign * law.nx, ny = sign * law.ny;
            const double normal = impulse_of(law, 0, by_others_[e][0] + part[0]);
            if (normal > 0) {
                gradient[0] -= nx * normal, gradient[1] -= ny * normal;
                add_square(second, nx, ny, law.stiffness);
            }
            if constexpr (kIsRough) {
                // Along the tangent (-ny, nx, -1), and round the rim alone.
                const double tangent = impulse_of(law, 1, by_others_[e][1] + part[1]);
                const double stiffness = law.share[1] * law.stiffness;
                gradient[0] += ny * tangent, gradient[1] -= nx * tangent, gradient[2] += tangent;
                add_square(second, -ny, nx, stiffness);
                second[6] += stiffness * ny, second[7] -= stiffness * nx, second[8] += stiffness;
                const double share = is_b ? 1 - law.of_a : -law.of_a;
                const double rolling = impulse_of(law, 2, by_others_[e][2] + part[2]);
                gradient[2] -= share * rolling;
                second[8] += law.share[2] * law.stiffness * share * share;
            }
        }
        double largest = 0;
        for (std::size_t k = 0; k < kSize; ++k)
            largest = std::max(largest, std::fabs(gradient[k]) / mass_[body][k]);
        if (!(largest > accurate_)) break;
        has_moved = true;
        solve_small<kSize>(second, gradient);
        for (std::size_t k = 0; k < kSize; ++k) velocity_[body][k] -= gradient[k];
    }
    return has_moved;
}

/// Sweeps over the bodies whose neighbours have moved until none has, or as often as is of use.
template <int kSize>
void ContactRelaxation<kSize>::sweep() {
    is_due_.assign(mass_.size(), 1);
    for (int sweep = 0; sweep < kSweepsOfRound; ++sweep) {
        bool any = false;
        for (std::size_t body = 0; body < mass_.size(); ++body) {
            if (!is_due_[body]) continue;
            is_due_[body] = 0;
            if (!relax(body)) continue;
            any = true;
            for (std::size_t e = first_[body]; e < first_[body + 1]; ++e) {
                const Law& law = laws_[of_bodies_[e]];
                const std::int32_t other = index(law.a) == body ? law.b : law.a;
                if (other >= 0) is_due_[index(other)] = 1;
            }
        }
        if (!any) break;
    }
    impulses_.resize(laws_.size());
    for (std::size_t i = 0; i < laws_.size(); ++i) impulses_[i] = impulses_of(laws_[i]);
}

/// @return whether any contact gave way too far
template <int kSize>
bool ContactRelaxation<kSize>::stiffen() {
    bool any = false;
    for (Law& law : laws_) {
        const double velocity = velocity_of(law)[0], impulse = impulse_of(law, 0, velocity);
        if (!(impulse > 0) || law.floor - velocity <= kGivesWayMost * fall_) continue;
        const double most = most_[index(law.a)] / (kGivesWay * fall_);
        if (!(law.stiffness < most)) continue;
        law.stiffness =
            std::fmin(std::fmax(kStiffening * law.stiffness, impulse / (kGivesWay * fall_)), most);
        any = true;
    }
    return any;
}

/// Begins with velocities of before and contacts that carry nothing.
template <int kSize>
void ContactRelaxation<kSize>::start_without_loads() {
    for (Law& law : laws_) law.carried = {};
    velocity_ = start_;
    find_shares();
}

/// Scales what contacts do down to where it leaves the bodies the least energy.
template <int kSize>
void ContactRelaxation<kSize>::take_back() {
    double along = 0, squared = 0;
    for (std::size_t body = 0; body < mass_.size(); ++body)
        for (std::size_t k = 0; k < kSize; ++k) {
            const double change = velocity_[body][k] - free_[body][k];
            along += mass_[body][k] * change * free_[body][k], squared += mass_[body][k] * change * change;
        }
    const double share = squared > 0 ? std::fmax(0.0, std::fmin(-along / squared, 1.0)) : 0;
    for (std::size_t body = 0; body < mass_.size(); ++body)
        for (std::size_t k = 0; k < kSize; ++k)
            velocity_[body][k] = free_[body][k] + share * (velocity_[body][k] - free_[body][k]);
    for (Rows& impulses : impulses_)
        for (double& impulse : impulses) impulse *= share;
}

/// A descent that is cut short, as in a squeeze, leaves impulses that fit no velocities, and by these what
/// surfaces that move have driven is wrong. Where the work of impulses misses what bodies that touch each
/// other and such surfaces have gained by more than all that these have, and the slack, they are scaled to
/// where they fit best. Loads of what rests do no work; those of piles that nothing drives are kept.
template <int kSize>
void ContactRelaxation<kSize>::fit_impulses() {
    const auto fit_of = [&](std::size_t body) -> Fit& {
        return fits_[index(touching_.island_of(static_cast<std::int32_t>(body)))];
    };
    bool any = false;
    given_.assign(mass_.size(), {}), fits_.assign(mass_.size(), {});
    for (std::size_t i = 0; i < laws_.size(); ++i) {
        const Law& law = laws_[i];
        give(law, false, impulses_[i], given_[index(law.a)]);
        if (law.b >= 0) give(law, true, impulses_[i], given_[index(law.b)]);
        const bool moves =
            std::any_of(law.surface.begin(), law.surface.end(), [](double v) { return v != 0; });
        if (moves) fit_of(index(law.a)).is_driven = true, any = true;
    }
    if (!any) return;
    for (std::size_t body = 0; body < mass_.size(); ++body) {
        Fit& fit = fit_of(body);
        fit.energy += slack_ * mass_[body][0] * fall_ * fall_;
        for (std::size_t k = 0; k < kSize; ++k) {
            const double given = given_[body][k], mass = mass_[body][k], from = free_[body][k],
                         to = velocity_[body][k];
            fit.along += (to - from) * given, fit.square += given * given / mass;
            fit.missed += 0.5 * (mass * (to - from) - given) * (from + to);
            fit.energy += 0.5 * mass * std::fmax(from * from, to * to);
        }
    }
    for (std::size_t i = 0; i < laws_.size(); ++i) {
        const Fit& fit = fit_of(index(laws_[i].a));
        if (!fit.is_driven || !(std::fabs(fit.missed) > kMostMissed * fit.energy)) continue;
        const double share = std::clamp(fit.along / fit.square, 0.0, 1.0);
        for (double& impulse : impulses_[i]) impulse *= share;
    }
}

/// Adds what impulses of a contact give to one of its bodies [N s].
template <int kSize>
void ContactRelaxation<kSize>::give(const Law& law, bool is_b, const Rows& impulses, Velocity& given) {
    const double sign = is_b ? 1 : -1, nx = sign * law.nx, ny = sign * law.ny;
    given[0] += nx * impulses[0], given[1] += ny * impulses[0];
    if constexpr (kIsRough) {
        given[0] -= ny * impulses[1], given[1] += nx * impulses[1];
        given[2] -= impulses[1] - (is_b ? 1 - law.of_a : -law.of_a) * impulses[2];
    }
}

template <int kSize>
void ContactRelaxation<kSize>::solve(std::span<LocalContact> contacts, double fall,
                                     const RelaxationEffort& effort) {
    accurate_ = effort.accuracy * fall, slack_ = effort.slack;
    describe(contacts, fall);
    // What the sweeps over impulses made of the velocities may be worse than those of before.
    find_shares();
    const double by_sweeps = value();
    swept_ = velocity_, velocity_ = start_;
    if (!(value() < by_sweeps)) velocity_ = swept_;
    find_shares();
    for (int round = 0; round < effort.rounds; ++round) {
        sweep();
        if (gain() > 0) {
            start_without_loads();
            sweep();
            if (gain() > 0) take_back();
            break;
        }
        if (round + 1 == effort.rounds) break;
        const bool slides = find_shares(), gives_way = stiffen();
        if (!slides && !gives_way) break;
        for (std::size_t i = 0; i < laws_.size(); ++i) laws_[i].carried = impulses_[i];
    }
    fit_impulses();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        contacts[i].impulses.normal = impulses_[i][0];
        if constexpr (kIsRough)
            contacts[i].impulses.tangent = impulses_[i][1], contacts[i].impulses.rolling = impulses_[i][2];
    }
}

template <int kSize>
std::size_t ContactRelaxation<kSize>::bytes() const {
    return laws_.capacity() * sizeof(Law) + is_due_.capacity() +
           (first_.capacity() + of_bodies_.capacity()) * sizeof(std::uint32_t) + touching_.bytes() +
           most_.capacity() * sizeof(double) + fits_.capacity() * sizeof(Fit) +
           by_others_.capacity() * sizeof(Rows) +
           (mass_.capacity() + start_.capacity() + free_.capacity() + velocity_.capacity() +
            swept_.capacity() + given_.capacity()) *
               sizeof(Velocity) +
           impulses_.capacity() * sizeof(Rows);
}

template class ContactRelaxation<2>;
template class ContactRelaxation<3>;

}  // namespace carom
