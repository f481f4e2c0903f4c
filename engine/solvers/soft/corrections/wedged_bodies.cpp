#include "solvers/soft/corrections/wedged_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Cosine of the angle between the surfaces of a wedge, at least: a sweep leaves its square, here 0.09.
constexpr double kFacing = 0.3;
/// Supports are solved where sweeps leave a velocity off by more than this share of what gravity adds in a
/// substep, and of the body's own.
constexpr double kOfFall = 1e-3;
constexpr double kOfSpeed = 1e-5;
/// Turns of normals and friction at most. Where friction holds what is squeezed they come to no end, and what
/// the sweeps gave stays.
constexpr int kMostTurnsOfWedges = 64;
/// Turns beyond the second of all bodies in a substep, at most: a tenth of a millisecond, so that many discs
/// which friction holds under a plate do not take the step's time.
constexpr int kMostFurtherTurns = 1024;

template <class Real>
Vec2 normal_of(const ContactRows<Real>& supports, std::size_t i) {
    return {static_cast<double>(supports.normal_x[i]), static_cast<double>(supports.normal_y[i])};
}

double relative(const ContactImpulses<double>& added, const ContactTerms<double>& terms) {
    return std::fmax(std::fmax(std::fabs(added.normal), std::fabs(added.tangent)), std::fabs(added.rolling)) /
           terms.mass;
}

/// Each support on its own. @return m/s, the largest change
double sweep(DoubleBody& body, std::vector<LocalContact>& supports) {
    double largest = 0;
    for (LocalContact& c : supports) {
        DoubleSurface surface{c.surface_normal, c.surface_tangent, c.surface_rolling};
        const auto added = solve_contact<kEveryEffect>(body, surface, c.terms, c.impulses,
                                                       [](double wanted) { return wanted; });
        largest = std::fmax(largest, relative(added, c.terms));
    }
    return largest;
}

/// All normals at once. @return false if they cannot be solved
bool solve_normals(DoubleBody& body, std::vector<LocalContact>& supports, std::vector<SupportNormal>& normals,
                   double tolerance) {
    normals.clear();
    for (const LocalContact& c : supports)
        normals.push_back({{c.terms.nx, c.terms.ny}, c.surface_normal - c.terms.floor, c.impulses.normal});
    Vec2 velocity{body.record[0], body.record[1]};
    if (!solve_support_normals(velocity, body.inverse_mass(), normals, tolerance)) return false;
    body.record[0] = velocity.x, body.record[1] = velocity.y;
    for (std::size_t i = 0; i < supports.size(); ++i) supports[i].impulses.normal = normals[i].impulse;
    return true;
}

}  // namespace

/// Lists the supports of bodies that have more than one.
template <class Real>
void WedgedBodies<Real>::list_shared(const ContactRows<Real>& supports) {
    shared_.clear();
    const auto latest = [&](std::size_t i) -> std::int32_t& {
        return latest_[static_cast<std::size_t>(supports.a[i])];
    };
    supports.for_each([&](std::size_t i) {
        const auto now = static_cast<std::uint32_t>(i);
        if (latest(i) >= 0) {
            shared_.push_back({supports.a[i], static_cast<std::uint32_t>(latest(i))});
            shared_.push_back({supports.a[i], now});
        }
        latest(i) = static_cast<std::int32_t>(i);
    });
    supports.for_each([&](std::size_t i) { latest(i) = -1; });
    const auto as_tuple = [](const Support& s) { return std::tie(s.row, s.support); };
    std::sort(shared_.begin(), shared_.end(),
              [&](const Support& left, const Support& right) { return as_tuple(left) < as_tuple(right); });
    const auto end = std::unique(
        shared_.begin(), shared_.end(),
        [&](const Support& left, const Support& right) { return as_tuple(left) == as_tuple(right); });
    shared_.erase(end, shared_.end());
}

template <class Real>
void WedgedBodies<Real>::begin_step(const StepView<Real>& step, const Bodies<Real>& bodies) {
    const ContactRows<Real>& supports = step.supports;
    supports_.clear(), bodies_.clear();
    // Walls are parallel or at right angles. Static and kinematic bodies and edges have flags.
    if (!bodies.has_flags && bodies.asleep == 0) return;
    latest_.resize(std::max(latest_.size(), step.records.count()), -1);
    list_shared(supports);
    const auto face_each_other = [&](std::uint32_t one, std::uint32_t other) {
        const double cosine = dot(normal_of(supports, one), normal_of(supports, other));
        return cosine < -kFacing && 1 - cosine * cosine >= kLeastOfWedge;
    };
    for (auto first = shared_.begin(), last = first; first != shared_.end(); first = last) {
        last = std::find_if(first, shared_.end(), [&](const Support& s) { return s.row != first->row; });
        bool is_wedged = false;
        for (auto one = first; one != last; ++one)
            is_wedged |= std::any_of(one + 1, last, [&](const Support& other) {
                return face_each_other(one->support, other.support);
            });
        if (!is_wedged) continue;
        const auto begin = static_cast<std::uint32_t>(supports_.size());
        for (auto at = first; at != last; ++at) supports_.push_back(at->support);
        bodies_.push_back({first->row, begin, static_cast<std::uint32_t>(supports_.size())});
    }
}

/// Whether a body nears no support faster than it may, and leaves none that pushes.
template <class Real>
bool WedgedBodies<Real>::keeps_off(const Wedged& body, const ContactRows<Real>& supports, Vec2 velocity,
                                   double tolerance) const {
    return std::all_of(
        &supports_[body.first], &supports_[body.first] + (body.last - body.first), [&](std::uint32_t i) {
            const double excess = dot(velocity, normal_of(supports, i)) -
                                  static_cast<double>(supports.surface_normal[i]) +
                                  static_cast<double>(supports.floor[i]);
            return excess <= tolerance && (excess >= -tolerance || !(supports.normal_impulse[i] > 0));
        });
}

template <class Real>
void WedgedBodies<Real>::solve(const StepView<Real>& step, const SolveContacts<Real>& on_supports) {
    further_turns_ = kMostFurtherTurns;
    for (const Wedged& body : bodies_) solve(body, step, on_supports);
}

template <class Real>
void WedgedBodies<Real>::solve(const Wedged& wedged, const StepView<Real>& step,
                               const SolveContacts<Real>& on_supports) {
    DoubleBody body = body_at(step.records.velocity, wedged.row);
    const double speed = std::fmax(std::fabs(body.record[0]), std::fabs(body.record[1]));
    const double tolerance = kOfFall * step.terms.fall_speed() + kOfSpeed * speed;
    if (keeps_off(wedged, step.supports, {body.record[0], body.record[1]}, tolerance)) return;
    contacts_.clear();
    for (std::uint32_t i = wedged.first; i < wedged.last; ++i) {
        LocalContact contact{};
        contact.b = -1, contact.contact = supports_[i];
        contact.read(on_supports);
        const DoubleSurface surface{};
        contact.terms.mass = 1 / inverse_mass(body, surface);
        contact.terms.tangent_mass = tangent_mass<kEveryEffect>(body, surface, contact.terms.mass);
        contacts_.push_back(contact);
    }
    for (int turn = 1; true; ++turn) {
        if (turn > kMostTurnsOfWedges || (turn > 2 && further_turns_-- <= 0)) return;
        if (!solve_normals(body, contacts_, normals_, tolerance)) return;
        if (sweep(body, contacts_) <= tolerance) break;
    }

    for (std::size_t k = 0; k < 3; ++k)
        step.records.velocity[4 * static_cast<std::size_t>(wedged.row) + k] =
            static_cast<Real>(body.record[k]);
    for (const LocalContact& c : contacts_) {
        const ContactColumns<Real>& columns = on_supports.contacts;
        columns.normal_impulse[c.contact] = static_cast<Real>(c.impulses.normal);
        if (columns.friction_impulse)
            columns.friction_impulse[c.contact] = static_cast<Real>(c.impulses.tangent);
        if (columns.rolling_impulse)
            columns.rolling_impulse[c.contact] = static_cast<Real>(c.impulses.rolling);
    }
}

template <class Real>
std::size_t WedgedBodies<Real>::bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return of(latest_) + of(shared_) + of(supports_) + of(bodies_) + of(contacts_) + of(normals_);
}

template class WedgedBodies<float>;
template class WedgedBodies<double>;

}  // namespace carom
