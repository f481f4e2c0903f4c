#pragma once

#include <carom/scene.hpp>

#include <cstdint>

#include "state/body_flags.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// A property that all bodies share, or that each has its own: the column exists only in the second case.
template <class Real>
class Property {
  public:
    bool is_uniform() const { return !spread_; }
    Real uniform_value() const { return value_; }
    Real operator[](std::size_t row) const { return spread_ ? column_[row] : value_; }
    /// The column, or null if one value serves all.
    const Real* data() const { return spread_ ? column_.data() : nullptr; }
    Column<Real>& column() { return column_; }
    const Column<Real>& column() const { return column_; }

    /// Sets row `row` of `count`; spreads into a column when a value differs from the others'.
    void set(std::size_t row, std::size_t count, Real value) {
        if (!spread_ && (count <= 1 || is_any_ || value == value_)) {
            value_ = value, is_any_ = false;
            return;
        }
        if (!spread_) {
            column_.resize(count);
            for (Real& each : column_) each = value_;
            spread_ = true;
        }
        column_[row] = value;
    }

    /// For a row whose value means nothing: takes the others' value, or `any` while there is none.
    void set_any(std::size_t row, std::size_t count, Real any) {
        if (spread_) {
            column_[row] = column_[row == 0 ? count - 1 : 0];
        } else if (count <= 1 || is_any_) {
            value_ = any, is_any_ = true;
        }
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.value_, self.is_any_, self.spread_, self.column_);
    }

  private:
    Real value_ = 0;
    bool is_any_ = false;  // no row has given value_ a meaning
    bool spread_ = false;
    Column<Real> column_;
};

/// Every body of a world; row i of all columns is body i. Padding rows are zero and harmless. Columns that no
/// effect needs do not exist.
template <class Real>
struct Bodies {
    std::size_t count = 0;                 ///< rows that a step works on
    std::size_t asleep = 0;                ///< rows behind them: bodies that sleep
    std::size_t standing = 0;              ///< the last of `count`: static bodies that steps pass over
    Column<Real> position_x, position_y;   // m
    Column<Real> velocity_x, velocity_y;   // m/s
    Column<Real> angle, angular_velocity;  // rad, rad/s; only with rotation
    Column<std::uint8_t> flags;            // BodyFlag bits; only if some row has one
    Column<BodyId> id;                     // handle of each row
    Column<std::int32_t> group;            // below zero: do not touch; only if some have one
    Column<std::uint32_t> filter;          // category and mask (filter_of); only if some are not the default
    Column<float> still;                   // s, for how long slow enough to sleep; only with sleeping
    Column<std::int32_t> island;           // of rows that sleep; only with sleeping
    Property<Real> mass;                   // kg
    Property<Real> radius;                 // m, of a disc; of other shapes that of the disc around them
    Property<Real> restitution;            // no unit
    Property<Real> friction;               // Coulomb coefficient
    Property<Real> rolling_resistance;     // coefficient
    // Only with shapes; in a world of discs the radius is all three. Bodies of edges have no shape, -1.
    Column<std::int32_t> shape;  // number in WorldState::shapes
    Property<Real> rims;         // m, of the disc of the same mass and moment of inertia
    Property<Real> inradii;      // m, from the centre of mass to the nearest point of the surface
    bool has_rotation = false;
    bool has_sleep = false;
    bool has_flags = false;
    bool has_shapes = false;  ///< some body is, or was, neither a disc nor edges
    bool has_groups = false;
    bool has_categories = false;
    std::int32_t common_group = 0;  // below zero: all bodies there ever were are in it, and none may touch

    std::uint8_t flags_of(std::size_t row) const { return has_flags ? flags[row] : std::uint8_t{0}; }
    bool is_immovable(std::size_t row) const { return (flags_of(row) & (kImmovable | kDisabled)) != 0; }

    /// Whether a row is a disc: not another convex shape, not edges.
    bool is_disc(std::size_t row) const { return (flags_of(row) & (kEdges | kNotDisc)) == 0; }
    /// Whether a row is a disc that others push.
    bool is_moving_disc(std::size_t row) const {
        return (flags_of(row) & (kEdges | kNotDisc | kSensor | kImmovable | kDisabled)) == 0;
    }
    /// Whether two rows meet as discs.
    bool are_discs(std::int32_t a, std::int32_t b) const {
        return !has_shapes || (is_disc(static_cast<std::size_t>(a)) && is_disc(static_cast<std::size_t>(b)));
    }
    /// m: u = rim angular velocity is the rim speed of records, mass rim² / 2 the moment of inertia.
    const Property<Real>& rim() const { return has_shapes ? rims : radius; }
    Real rim(std::size_t row) const { return rim()[row]; }
    /// m: half of what a body is thick, where `radius` is how far it reaches.
    const Property<Real>& inradius() const { return has_shapes ? inradii : radius; }
    Real inradius(std::size_t row) const { return inradius()[row]; }

    /// 1/kg; zero for what nothing moves.
    double inverse_mass(std::size_t row) const {
        return is_immovable(row) ? 0 : 1 / static_cast<double>(mass[row]);
    }

    /// Calls fn(name, unit, column) for every column that exists.
    template <class Fn>
    void for_each_column(const Fn& fn) {
        list_columns(*this, fn);
    }
    template <class Fn>
    void for_each_column(const Fn& fn) const {
        list_columns(*this, fn);
    }

    /// Whatever may move is in the rows below this number; others may be there, too.
    std::size_t moving() const { return count - standing; }
    /// Whether a row is a static body.
    bool stands(std::size_t row) const {
        return (flags_of(row) & (kImmovable | kKinematic | kDisabled)) == kImmovable;
    }

    /// All bodies, awake or not.
    std::size_t rows() const { return count + asleep; }

    /// Changes the number of rows, those that sleep included; new rows and padding are zero.
    void resize(std::size_t rows) {
        for_each_column([rows](auto, auto, auto& column) { column.resize(rows); });
        count = rows - asleep;
    }

    void set_flags(std::size_t row, std::uint8_t value) {
        if (!has_flags) {
            if (value == 0) return;
            flags.resize(rows());
            has_flags = true;
        }
        flags[row] = value;
    }

    void set_group(std::size_t row, std::int32_t value) {
        common_group = rows() == 1 ? value : common_group == value ? value : 0;
        if (!has_groups) {
            if (value == 0) return;
            group.resize(rows());
            has_groups = true;
        }
        group[row] = value;
    }

    void set_filter(std::size_t row, std::uint16_t category, std::uint16_t mask) {
        const std::uint32_t value = filter_of(category, mask);
        if (!has_categories) {
            if (value == kDefaultFilter) return;
            filter.resize(rows());
            for (std::uint32_t& each : filter) each = kDefaultFilter;
            has_categories = true;
        }
        filter[row] = value;
    }
    std::uint16_t category(std::size_t row) const {
        return static_cast<std::uint16_t>((has_categories ? filter[row] : kDefaultFilter) >> kMaskBits);
    }
    std::uint16_t mask(std::size_t row) const {
        return static_cast<std::uint16_t>((has_categories ? filter[row] : kDefaultFilter) & kDefaultMask);
    }

    /// Whether there are rows for which may_touch may say no.
    bool has_filters() const { return has_groups || has_categories; }
    /// Whether others may touch either of two bodies or neither.
    bool are_filtered_alike(std::size_t a, std::size_t b) const {
        return (!has_groups || group[a] == group[b]) && (!has_categories || filter[a] == filter[b]);
    }
    /// Whether groups, categories and masks let two bodies touch.
    bool may_touch(std::size_t a, std::size_t b) const {
        if (has_groups && group[a] != 0 && group[a] == group[b]) return group[a] > 0;
        if (!has_categories) return true;
        return (filter[a] >> kMaskBits & filter[b]) != 0 && (filter[b] >> kMaskBits & filter[a]) != 0;
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.count, self.asleep, self.standing, self.has_rotation, self.has_sleep, self.has_flags,
                self.has_shapes);
        archive(self.mass, self.radius, self.restitution, self.friction, self.rolling_resistance);
        archive(self.position_x, self.position_y, self.velocity_x, self.velocity_y, self.id);
        archive(self.angle, self.angular_velocity, self.flags, self.still, self.island);
        archive(self.shape, self.rims, self.inradii);
        archive(self.has_groups, self.common_group, self.group, self.has_categories, self.filter);
    }

  private:
    static constexpr int kMaskBits = 16;
    static constexpr std::uint32_t filter_of(std::uint16_t category, std::uint16_t mask) {
        return static_cast<std::uint32_t>(category) << kMaskBits | mask;
    }
    static constexpr std::uint32_t kDefaultFilter = filter_of(kDefaultCategory, kDefaultMask);

    /// The one list of columns.
    template <class Self, class Fn>
    static void list_columns(Self& b, const Fn& fn) {
        fn("position_x", "m", b.position_x), fn("position_y", "m", b.position_y);
        fn("velocity_x", "m/s", b.velocity_x), fn("velocity_y", "m/s", b.velocity_y);
        fn("id", "handle", b.id);
        if (b.has_rotation) fn("angle", "rad", b.angle), fn("angular_velocity", "rad/s", b.angular_velocity);
        if (!b.mass.is_uniform()) fn("mass", "kg", b.mass.column());
        if (!b.radius.is_uniform()) fn("radius", "m", b.radius.column());
        if (!b.restitution.is_uniform()) fn("restitution", "1", b.restitution.column());
        if (!b.friction.is_uniform()) fn("friction", "1", b.friction.column());
        if (!b.rolling_resistance.is_uniform()) fn("rolling_resistance", "1", b.rolling_resistance.column());
        if (b.has_shapes) {
            fn("shape", "number", b.shape);
            if (!b.rims.is_uniform()) fn("rim", "m", b.rims.column());
            if (!b.inradii.is_uniform()) fn("inradius", "m", b.inradii.column());
        }
        if (b.has_flags) fn("flags", "bits", b.flags);
        if (b.has_groups) fn("group", "1", b.group);
        if (b.has_categories) fn("filter", "bits", b.filter);
        if (b.has_sleep) fn("still", "s", b.still), fn("island", "1", b.island);
    }
};

}  // namespace carom
