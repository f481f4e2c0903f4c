// The naive engine's step. Every formula keeps the order of operations of the teaching program it reproduces,
// so that the published figures come out to the printed digits.
#include <carom/pairwise.hpp>

#include "check_pairwise.hpp"
#include "decay.hpp"

#include <cmath>
#include <utility>

namespace carom {
namespace {

struct PairContact {
    double normal_x, normal_y;  // unit vector from a to b
    double overlap;             // m, > 0
};

std::optional<PairContact> find_contact(const PairwiseBody& a, const PairwiseBody& b) {
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double distance = std::sqrt(dx * dx + dy * dy);
    const double reach = a.radius + b.radius;
    if (!(distance < reach && distance > kPairwiseBlindDistance)) return std::nullopt;
    return PairContact{dx / distance, dy / distance, reach - distance};
}

double normal_speed(const PairwiseBody& body, const PairContact& contact) {
    return body.vx * contact.normal_x + body.vy * contact.normal_y;
}

/// What pushing apart adds to the sum of momentum * position over all bodies [J]. With the impulse times the
/// sum of the radii, where it is applied, this is exact: the pressure it gives is the one the walls feel.
double push_virial(const PairwiseBody& a, const PairwiseBody& b, const PairContact& contact) {
    return 0.5 * contact.overlap * (b.mass * normal_speed(b, contact) - a.mass * normal_speed(a, contact));
}

// Half and half whatever the masses: docs/seed-faults.md, fault 4.
void push_apart(PairwiseBody& a, PairwiseBody& b, const PairContact& contact) {
    const double shift_x = contact.normal_x * contact.overlap * 0.5;
    const double shift_y = contact.normal_y * contact.overlap * 0.5;
    a.x -= shift_x, a.y -= shift_y;
    b.x += shift_x, b.y += shift_y;
}

double inertia(const PairwiseBody& body) {
    return 0.5 * body.mass * body.radius * body.radius;
}

/// Returns the impulse on b along the normal [kg m/s], 0 if the bodies are not approaching.
double apply_impulse(PairwiseBody& a, PairwiseBody& b, const PairContact& contact, double restitution) {
    const double nx = contact.normal_x, ny = contact.normal_y;
    const double approach = (b.vx - a.vx) * nx + (b.vy - a.vy) * ny;
    if (approach >= 0) return 0;

    const double impulse = -(1.0 + restitution) * approach / (1.0 / a.mass + 1.0 / b.mass);
    a.vx -= impulse / a.mass * nx, a.vy -= impulse / a.mass * ny;
    b.vx += impulse / b.mass * nx, b.vy += impulse / b.mass * ny;

    // The arm is parallel to the impulse, so the torque is zero but for rounding: docs/seed-faults.md,
    // fault 5.
    const double arm_ax = a.radius * nx, arm_ay = a.radius * ny;
    const double arm_bx = -b.radius * nx, arm_by = -b.radius * ny;
    a.omega -= (arm_ax * impulse * ny - arm_ay * impulse * nx) / inertia(a);
    b.omega += (arm_bx * impulse * ny - arm_by * impulse * nx) / inertia(b);
    return impulse;
}

struct Axis {
    double& position;  // m, one component
    double& velocity;  // m/s
    double min, max;   // m, the two walls
    bool has_min, has_max;
};

/// One axis of the walls. A body outside the lower wall is not tested against the upper one.
void resolve_axis(PairwiseBody& body, const Axis& axis, const PairwiseWalls& walls, PairwiseCounts& counts) {
    const double before = axis.velocity;
    if (axis.has_min && axis.position - body.radius < axis.min) {
        axis.position = axis.min + body.radius;
        axis.velocity =
            std::abs(before) * walls.restitution;  // also when leaving: docs/seed-faults.md, fault 6
    } else if (axis.has_max && axis.position + body.radius > axis.max) {
        axis.position = axis.max - body.radius;
        axis.velocity = -std::abs(before) * walls.restitution;
    } else {
        return;
    }
    body.omega *= walls.spin_kept;
    ++counts.wall_contacts;
    counts.wall_impulse += body.mass * std::abs(axis.velocity - before);
}

}  // namespace

Pairwise::Pairwise(PairwiseScene scene) : scene_(std::move(scene)) {
    check_pairwise(scene_);
}

void Pairwise::step(double dt) {
    check_pairwise_dt(dt);
    if (dt == 0) return;
    accelerate(dt);
    resolve_pairs();
    resolve_walls();
    integrate_positions(dt);
    time_ += dt;
    ++counts_.steps;
}

void Pairwise::accelerate(double dt) {
    // inexact: the yardstick is compared to published digits and tolerances, never bit by bit between
    // machines
    const double keep = scene_.keep_per_step ? *scene_.keep_per_step : decay(scene_.linear_drag * dt);
    const double keep_spin = decay(scene_.angular_drag * dt);  // inexact: as above
    for (PairwiseBody& body : scene_.bodies) {
        body.vx = (body.vx + scene_.gravity_x * dt) * keep;
        body.vy = (body.vy + scene_.gravity_y * dt) * keep;
        body.omega *= keep_spin;
    }
}

void Pairwise::resolve_pairs() {
    std::vector<PairwiseBody>& bodies = scene_.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        for (std::size_t j = i + 1; j < bodies.size(); ++j) {
            const std::optional<PairContact> contact = find_contact(bodies[i], bodies[j]);
            if (!contact) continue;
            ++counts_.contacts;
            counts_.pair_virial += push_virial(bodies[i], bodies[j], *contact);
            push_apart(bodies[i], bodies[j], *contact);
            const double impulse = apply_impulse(bodies[i], bodies[j], *contact, scene_.restitution);
            if (impulse > 0) ++counts_.impulses;
            counts_.pair_virial += impulse * (bodies[i].radius + bodies[j].radius);
        }
    }
    counts_.pair_tests += bodies.size() * (bodies.size() - (bodies.empty() ? 0 : 1)) / 2;
}

void Pairwise::resolve_walls() {
    if (!scene_.walls) return;
    const PairwiseWalls& walls = *scene_.walls;
    for (PairwiseBody& body : scene_.bodies) {
        resolve_axis(body, {body.x, body.vx, walls.min_x, walls.max_x, walls.left, walls.right}, walls,
                     counts_);
        resolve_axis(body, {body.y, body.vy, walls.min_y, walls.max_y, walls.bottom, walls.top}, walls,
                     counts_);
    }
}

void Pairwise::integrate_positions(double dt) {
    for (PairwiseBody& body : scene_.bodies) {
        body.x += body.vx * dt;
        body.y += body.vy * dt;
        body.angle += body.omega * dt;
    }
}

double kinetic_energy(const PairwiseBody& body) {
    return 0.5 * body.mass * (body.vx * body.vx + body.vy * body.vy) +
           0.5 * inertia(body) * body.omega * body.omega;
}

double Pairwise::total_mass() const {
    double sum = 0;
    for (const PairwiseBody& body : scene_.bodies) sum += body.mass;
    return sum;
}

double Pairwise::kinetic_energy() const {
    double sum = 0;
    for (const PairwiseBody& body : scene_.bodies) sum += carom::kinetic_energy(body);
    return sum;
}

double Pairwise::rotational_energy() const {
    double sum = 0;
    for (const PairwiseBody& body : scene_.bodies) sum += 0.5 * inertia(body) * body.omega * body.omega;
    return sum;
}

double Pairwise::potential_energy() const {
    double sum = 0;
    for (const PairwiseBody& body : scene_.bodies)
        sum -= body.mass * (scene_.gravity_x * body.x + scene_.gravity_y * body.y);
    return sum;
}

double Pairwise::total_energy() const {
    return kinetic_energy() + potential_energy();
}

PairwiseVector Pairwise::momentum() const {
    PairwiseVector sum;
    for (const PairwiseBody& body : scene_.bodies) {
        sum.x += body.mass * body.vx;
        sum.y += body.mass * body.vy;
    }
    return sum;
}

double Pairwise::angular_momentum() const {
    double sum = 0;
    for (const PairwiseBody& body : scene_.bodies)
        sum += body.mass * (body.x * body.vy - body.y * body.vx) + inertia(body) * body.omega;
    return sum;
}

PairwiseVector Pairwise::centre_of_mass() const {
    if (scene_.bodies.empty()) return {};
    PairwiseVector sum;
    for (const PairwiseBody& body : scene_.bodies) {
        sum.x += body.mass * body.x;
        sum.y += body.mass * body.y;
    }
    const double mass = total_mass();
    return {sum.x / mass, sum.y / mass};
}

}  // namespace carom
