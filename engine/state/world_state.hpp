#pragma once

#include <carom/ledger.hpp>
#include <carom/scene.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "shapes/edges.hpp"
#include "state/bodies.hpp"
#include "state/books.hpp"
#include "state/energy_watch.hpp"
#include "state/handles.hpp"
#include "state/joints.hpp"
#include "state/sensing.hpp"
#include "state/shapes.hpp"

namespace carom {

/// Which optional laws a world runs: what its scene calls for, and what was forced on.
struct Effects {
    bool gravity = false;
    bool drag = false;
    bool angular_drag = false;
    bool walls = false;
    bool restitution = false;
    bool rotation = false;
    bool friction = false;
    bool rolling_resistance = false;
    bool ledger = false;
    bool sleeping = false;
    bool joints = false;
};

/// Sums over the dynamic bodies, in double precision.
struct Sums {
    Energy energy;
    Vec2 momentum;                ///< kg m/s
    double angular_momentum = 0;  ///< kg m²/s
};

Sums operator+(const Sums& a, const Sums& b);
Sums operator-(const Sums& a, const Sums& b);

/// The columns, the laws and the books. A snapshot would have to hold more: solvers keep impulses, margins
/// and sleeping contacts from step to step, each in an object of its own.
template <class Real>
struct WorldState {
    Bodies<Real> bodies;
    Handles handles;
    EdgeStore edges;          ///< of segments and chains
    ShapeStore<Real> shapes;  ///< of the other bodies; empty where these are all discs
    JointStore joints;
    Sensing sensing;
    Vec2 gravity;  ///< m/s²
    Drag drag;
    std::optional<Walls> walls;
    Effects effects;
    double time = 0;          ///< s
    std::uint64_t falls = 0;  ///< flights so far: says how speeds are rounded in the next one
    Books books;
    Sums initial;                              ///< of the scene's bodies, when the world was made
    Sums outside;                              ///< what calls and quarantine have brought in since
    double dynamic_mass = 0;                   ///< kg, of the dynamic bodies that are awake
    std::vector<std::int32_t> immovable_rows;  ///< static, kinematic and disabled ones, ascending
    std::int64_t quarantined_count = 0;
    EnergyWatch energy_watch;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.bodies, self.handles, self.edges, self.shapes, self.gravity, self.drag, self.walls);
        archive(self.effects);
        archive(self.time, self.falls, self.books, self.initial, self.outside, self.dynamic_mass);
        archive(self.immovable_rows, self.quarantined_count, self.joints, self.sensing);
        archive(self.energy_watch);
    }

    std::size_t bytes() const;

    /// Books what a call, or quarantine, has brought in.
    void bring(const Sums& more) {
        outside = outside + more, energy_watch.brought += std::fabs(more.energy.total());
    }

    /// Energy and momentum of one row; zero if it is not dynamic.
    Sums sums_of(std::size_t row) const;
    /// The same of a state that is not in its columns. @param spin  rad/s
    Sums sums_of(std::size_t row, Vec2 position, Vec2 velocity, double spin) const;
    Sums sums() const;

    /// The shape of a row; of a polygon, the one around its centroid.
    Shape shape_of(std::size_t row) const;

    /// Appends a row for a body that has been validated: behind those that move, where the first standing
    /// one makes room, or behind those that stand.
    BodyId append(const Body& body);
    /// Takes a row out; the last row that is awake takes its place.
    /// @return the edges that went with it.
    EdgeStore::Removed remove(std::size_t row);
    /// Rolls a row whose next state would leave the limits out of the simulation, where it is.
    /// @param taken  what the books say it had by then; if that is no number, what its columns say is booked
    void quarantine(std::size_t row, const Sums& taken);
    void quarantine(std::size_t row) { quarantine(row, sums_of(row)); }
    /// Whether two bodies can touch: a joint may say that they do not, or a filter.
    bool may_collide(std::size_t row_a, std::size_t row_b) const {
        if (bodies.has_filters() && !bodies.may_touch(row_a, row_b)) return false;
        return joints.empty() || !joints.excludes(bodies.id[row_a], bodies.id[row_b]);
    }
    /// Whether there are bodies for which may_collide may say no.
    bool has_filters() const { return bodies.has_filters() || !joints.empty(); }
    /// Exchanges two rows. `list_immovable_rows` is to be called after it.
    void swap_rows(std::size_t a, std::size_t b);
    void list_immovable_rows();
    /// Those of immovable_rows that are below `row`.
    std::span<const std::int32_t> immovable_rows_below(std::size_t row) const {
        const auto end =
            std::lower_bound(immovable_rows.begin(), immovable_rows.end(), static_cast<std::int32_t>(row));
        return {immovable_rows.begin(), end};
    }
    /// Sorts the rows that are awake: new row i is the old row order[i].
    void reorder(const std::int32_t* order);

  private:
    void turn_shapes_on();
    void set_shape(std::size_t row, const Body& body, BodyId id);

    Column<std::byte> spare_;  // one column's worth, kept so that reordering allocates nothing
};

extern template struct WorldState<float>;
extern template struct WorldState<double>;

}  // namespace carom
