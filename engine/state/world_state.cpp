#include "state/world_state.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include "math/vec2_math.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"

namespace carom {

Sums operator+(const Sums& a, const Sums& b) {
    return {{a.energy.kinetic + b.energy.kinetic, a.energy.rotational + b.energy.rotational,
             a.energy.potential + b.energy.potential},
            a.momentum + b.momentum,
            a.angular_momentum + b.angular_momentum};
}

Sums operator-(const Sums& a, const Sums& b) {
    return {{a.energy.kinetic - b.energy.kinetic, a.energy.rotational - b.energy.rotational,
             a.energy.potential - b.energy.potential},
            a.momentum - b.momentum,
            a.angular_momentum - b.angular_momentum};
}

template <class Real>
Sums WorldState<Real>::sums_of(std::size_t row) const {
    const Vec2 x{bodies.position_x[row], bodies.position_y[row]},
        v{bodies.velocity_x[row], bodies.velocity_y[row]};
    return sums_of(row, x, v, bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0);
}

template <class Real>
Sums WorldState<Real>::sums_of(std::size_t row, Vec2 x, Vec2 v, double spin) const {
    if (bodies.is_immovable(row)) return {};
    const double mass = bodies.mass[row], rim = bodies.rim(row);
    Sums sums{{0.5 * mass * length_squared(v), 0, -mass * dot(gravity, x)}, mass * v, mass * cross(x, v)};
    if (bodies.has_rotation) {
        const double inertia = 0.5 * mass * rim * rim;
        sums.energy.rotational = 0.5 * inertia * spin * spin;
        sums.angular_momentum += inertia * spin;
    }
    return sums;
}

template <class Real>
Sums WorldState<Real>::sums() const {
    Sums sums;
    for (std::size_t row = 0; row < bodies.rows(); ++row) sums = sums + sums_of(row);
    return sums;
}

template <class Real>
Shape WorldState<Real>::shape_of(std::size_t row) const {
    if (bodies.flags_of(row) & kEdges) return edges.shape_of(bodies.id[row]);
    if (bodies.has_shapes) return shapes.shape(bodies.shape[row]);
    return Disc{static_cast<double>(bodies.radius[row])};
}

/// Before the first body that is neither a disc nor edges: gives the others what shapes need.
template <class Real>
void WorldState<Real>::turn_shapes_on() {
    bodies.has_shapes = true;
    bodies.rims = bodies.inradii = bodies.radius;
    bodies.shape.resize(bodies.rows());
    for (std::size_t row = 0; row < bodies.rows(); ++row)
        bodies.shape[row] =
            bodies.flags_of(row) & kEdges ? -1 : shapes.add(Disc{static_cast<double>(bodies.radius[row])});
}

template <class Real>
void WorldState<Real>::set_shape(std::size_t row, const Body& body, BodyId id) {
    const std::size_t rows = bodies.rows();
    if (!has_area(body.shape)) {
        edges.append(id, body.shape, body.type != BodyType::static_body);
        bodies.radius.set_any(row, rows, Real(1));
        if (!bodies.has_shapes) return;
        bodies.shape[row] = -1;
        bodies.rims.set_any(row, rows, Real(1)), bodies.inradii.set_any(row, rows, Real(1));
        return;
    }
    if (!bodies.has_shapes) {
        bodies.radius.set(row, rows, static_cast<Real>(radius_of(body.shape)));
        return;
    }
    const std::int32_t number = shapes.add(body.shape, body.material);
    bodies.shape[row] = number;
    bodies.radius.set(row, rows, shapes[number].extent);
    bodies.rims.set(row, rows, static_cast<Real>(rim_of(body)));
    bodies.inradii.set(row, rows, shapes[number].inradius);
}

template <class Real>
BodyId WorldState<Real>::append(const Body& body) {
    if (has_area(body.shape) && !is_disc(body.shape) && !bodies.has_shapes) turn_shapes_on();
    const bool stands = body.type == BodyType::static_body && bodies.standing > 0;
    const std::size_t row = stands ? bodies.count : bodies.moving(), rows = bodies.rows() + 1;
    const auto place_of = [&](std::size_t of) {
        return std::lower_bound(immovable_rows.begin(), immovable_rows.end(), static_cast<std::int32_t>(of));
    };
    bodies.resize(rows);
    if (stands) ++bodies.standing;
    const auto make_room = [&](std::size_t from, std::size_t to) {
        if (from == to) return;
        bodies.for_each_column([&](auto, auto, auto& column) {
            column[to] = column[from];
            column[from] = {};
        });
        handles.set_row(bodies.id[to], static_cast<std::uint32_t>(to));
    };
    const std::size_t last = bodies.count - 1;  // of those awake
    make_room(last, rows - 1);                  // the first that sleeps
    make_room(row, last);                       // the first that stands
    if (row < last) {
        immovable_rows.erase(place_of(row));
        immovable_rows.push_back(static_cast<std::int32_t>(last));
    }
    const BodyId id = handles.add(static_cast<std::uint32_t>(row));
    const auto real = [](double value) { return static_cast<Real>(value); };
    const double mass = mass_of(body);
    const int kind = (is_disc(body.shape)    ? 0
                      : has_area(body.shape) ? kNotDisc
                                             : kEdges) |
                     (body.sensor ? kSensor : 0);
    if (body.sensor) sensing.sensors.push_back(id);
    bodies.position_x[row] = real(body.position.x), bodies.position_y[row] = real(body.position.y);
    bodies.velocity_x[row] = real(body.velocity.x), bodies.velocity_y[row] = real(body.velocity.y);
    bodies.id[row] = id;
    bodies.set_group(row, body.group);
    bodies.set_filter(row, body.category, body.mask);
    if (bodies.has_rotation)
        bodies.angle[row] = real(body.angle), bodies.angular_velocity[row] = real(body.angular_velocity);
    set_shape(row, body, id);
    bodies.restitution.set(row, rows, real(body.material.restitution));
    bodies.friction.set(row, rows, real(body.material.friction));
    bodies.rolling_resistance.set(row, rows, real(body.material.rolling_resistance));
    if (body.type == BodyType::dynamic_body) {
        bodies.mass.set(row, rows, real(mass));
        bodies.set_flags(row, static_cast<std::uint8_t>(kind | (body.fixed_rotation ? kFixedAngle : 0)));
        dynamic_mass += static_cast<double>(bodies.mass[row]);
    } else {
        bodies.mass.set_any(row, rows, Real(1));  // it counts as infinite
        const bool moves = body.type == BodyType::kinematic_body;
        bodies.set_flags(row, static_cast<std::uint8_t>(kind | kImmovable | (moves ? kKinematic : 0)));
        immovable_rows.insert(place_of(row), static_cast<std::int32_t>(row));
    }
    return id;
}

template <class Real>
EdgeStore::Removed WorldState<Real>::remove(std::size_t row) {
    const EdgeStore::Removed gone =
        bodies.flags_of(row) & kEdges ? edges.remove(bodies.id[row]) : EdgeStore::Removed{};
    if (bodies.has_shapes && bodies.shape[row] >= 0) shapes.remove(bodies.shape[row]);
    if (!joints.empty()) joints.remove_of(bodies.id[row]);
    if (bodies.flags_of(row) & kSensor) std::erase(sensing.sensors, bodies.id[row]);
    bring(Sums{} - sums_of(row));
    if (!bodies.is_immovable(row)) dynamic_mass -= static_cast<double>(bodies.mass[row]);
    handles.remove(bodies.id[row]);
    const std::size_t last_awake = bodies.count - 1, last = bodies.rows() - 1;
    const auto fill = [&](std::size_t to, std::size_t from) {
        if (to == from) return;
        bodies.for_each_column([&](auto, auto, auto& column) { column[to] = column[from]; });
        handles.set_row(bodies.id[to], static_cast<std::uint32_t>(to));
    };
    fill(row, last_awake), fill(last_awake, last);
    bodies.resize(last);
    if (bodies.standing > 0) --bodies.standing;
    if (immovable_rows.empty()) return gone;
    // Those awake are [0, last_awake) now, and what was the last of them stands in `row`.
    const auto place_of = [&](std::size_t wanted) {
        return std::lower_bound(immovable_rows.begin(), immovable_rows.end(),
                                static_cast<std::int32_t>(wanted));
    };
    const auto erase = [&](std::size_t wanted) {
        const auto place = place_of(wanted);
        const bool is_listed = place != immovable_rows.end() && *place == static_cast<std::int32_t>(wanted);
        if (is_listed) immovable_rows.erase(place);
        return is_listed;
    };
    erase(row);
    if (row != last_awake && erase(last_awake))
        immovable_rows.insert(place_of(row), static_cast<std::int32_t>(row));
    return gone;
}

template <class Real>
void WorldState<Real>::quarantine(std::size_t row, const Sums& taken) {
    if (!bodies.is_immovable(row)) dynamic_mass -= static_cast<double>(bodies.mass[row]);
    const double size = taken.energy.total() + length_squared(taken.momentum);
    bring(Sums{} - (size - size == 0 ? taken : sums_of(row)));  // NaN and infinity fail
    bodies.set_flags(
        row, static_cast<std::uint8_t>((bodies.flags_of(row) & ~kKinematic) | kImmovable | kDisabled));
    bodies.velocity_x[row] = 0, bodies.velocity_y[row] = 0;
    if (bodies.has_rotation) bodies.angular_velocity[row] = 0;
    ++quarantined_count;
    list_immovable_rows();
}

template <class Real>
void WorldState<Real>::list_immovable_rows() {
    immovable_rows.clear();
    if (!bodies.has_flags) return;
    for (std::size_t row = 0; row < bodies.count; ++row)
        if (bodies.is_immovable(row)) immovable_rows.push_back(static_cast<std::int32_t>(row));
}

template <class Real>
void WorldState<Real>::swap_rows(std::size_t a, std::size_t b) {
    if (a == b) return;
    bodies.for_each_column([&](auto, auto, auto& column) { std::swap(column[a], column[b]); });
    handles.set_row(bodies.id[a], static_cast<std::uint32_t>(a));
    handles.set_row(bodies.id[b], static_cast<std::uint32_t>(b));
}

template <class Real>
void WorldState<Real>::reorder(const std::int32_t* order) {
    const std::size_t count = bodies.count;
    bodies.for_each_column([&](auto, auto, auto& column) {
        using T = std::remove_reference_t<decltype(column[0])>;
        spare_.resize_for_overwrite(count * sizeof(T));
        std::byte* sorted = spare_.data();
        for (std::size_t row = 0; row < count; ++row)
            std::memcpy(sorted + row * sizeof(T), &column[static_cast<std::size_t>(order[row])], sizeof(T));
        std::memcpy(column.data(), sorted, count * sizeof(T));
    });
    for (std::size_t row = 0; row < count; ++row)
        handles.set_row(bodies.id[row], static_cast<std::uint32_t>(row));
    list_immovable_rows();
}

template <class Real>
std::size_t WorldState<Real>::bytes() const {
    std::size_t bytes = handles.bytes() + edges.bytes() + shapes.bytes() + joints.bytes() + spare_.bytes() +
                        immovable_rows.capacity() * sizeof(std::int32_t) + sensing.bytes();
    bodies.for_each_column([&](auto, auto, const auto& column) { bytes += column.bytes(); });
    return bytes;
}

template struct WorldState<float>;
template struct WorldState<double>;

}  // namespace carom
