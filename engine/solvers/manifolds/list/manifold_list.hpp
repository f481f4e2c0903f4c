#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/manifolds/manifold_arguments.hpp"
#include "narrowphase/manifold.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// A contact whose normal turns by no more than this keeps its impulses: cosine of 25 degrees.
inline constexpr double kSameNormal = 0.9;

/// Bits of ManifoldMemory::slot_kind: the path goes from b to a; nothing moved b.
inline constexpr std::int32_t kTurnedSlot = 1, kStillSlot = 2;

/// What lasts of a contact of convex shapes from step to step.
template <class Real>
struct ManifoldMemory {
    Real normal_x = 0, normal_y = 0;             // of the step that the impulses are of
    Real normal1 = 0, normal2 = 0, tangent = 0;  // N s, of a substep
    Real separation1 = 0, separation2 = 0;       // m, at the start of the step, of a contact carried on
    // Where the last cut has put the contact, in crowds: PathCut::Slot.
    std::int32_t slot = -1, slot_kind = 0;

    bool is_loaded() const { return normal1 + normal2 > 0; }
    /// Forgets all but its slot.
    void forget_impulses() { *this = {.slot = slot, .slot_kind = slot_kind}; }
    void rescale(Real factor) { normal1 *= factor, normal2 *= factor, tangent *= factor; }
    /// The same contact seen from its other body: the normal turns round, and with it the order of the
    /// points.
    ManifoldMemory reversed() const {
        return {-normal_x,   -normal_y, normal2,
                normal1,     tangent,   separation2,
                separation1, slot,      slot_kind ^ kTurnedSlot};
    }
};

/// Names a contact whatever row its bodies have.
struct ManifoldName {
    BodyId a, b;             // b: a body; of a wall an id that no body has, of an edge its body
    std::int32_t place = 0;  // of a wall its side; else 0; of compounds the pieces besides

    static constexpr std::int32_t kPlaces = 4096;  // more than pieces of a compound, and sides
    static std::int32_t place_of_pieces(std::int32_t piece_a, std::int32_t piece_b) {
        return kPlaces * piece_a + piece_b;
    }
    static std::int32_t piece_of_a(std::int32_t place) { return place / kPlaces; }
    static std::int32_t piece_of_b(std::int32_t place) { return place % kPlaces; }
    static std::int32_t place_of_side(std::int32_t side, std::int32_t piece) {
        return side - kPlaces * piece;
    }
    static std::int32_t piece_of_surface(std::int32_t place) { return -place / kPlaces; }
    /// The same contact of two bodies, seen from the other one.
    ManifoldName reversed() const { return {b, a, place_of_pieces(piece_of_b(place), piece_of_a(place))}; }
    friend bool operator==(const ManifoldName&, const ManifoldName&) = default;
};

/// What lasts of a contact while its body sleeps. It has no padding, so that equal states are saved as equal
/// bytes.
template <class Real>
struct KeptManifold {
    ManifoldName name;
    std::int32_t is_surface = 0;  ///< not zero: b is no body
    ManifoldMemory<Real> memory;
    Real friction = 0;  ///< Coulomb coefficient
};

/// Contacts of convex shapes that can come about before the candidate pairs change, as columns.
template <class Real>
struct ManifoldList {
    Column<std::int32_t> a, b;  ///< row of a body that moves; Partner
    /// Items, of Manifolds: the bodies, or pieces of theirs. Only with compounds, else the rows.
    Column<std::int32_t> item_a, item_b;
    Column<Real> margin;              ///< m
    Column<Real> thickness;           ///< m, the smaller inradius of the two
    Column<Real> friction;            ///< Coulomb coefficient
    Column<Real> restitution;         ///< no unit
    std::vector<ManifoldName> names;  ///< of every contact
    std::vector<ManifoldMemory<Real>> memory;

    // As they were found: kernels/manifolds/manifold_arguments.hpp.
    Column<Real> normal_x, normal_y, lever_a1, lever_a2, lever_b1, lever_b2, lever_a_t, lever_b_t,
        separation1, separation2;

    std::size_t count() const { return names.size(); }
    void clear();
    /// Appends a contact; `fit` is to be called when all are in. Padding names the body of the first one
    /// twice: what kernels find there is not looked at, but row 0 may be edges, which have no shape.
    void add(std::int32_t row_a, std::int32_t partner, const ManifoldName& name);
    void fit();
    /// Contact i goes, and the last one takes its place; `fit` is to be called when all are gone.
    void remove(std::size_t i);
    /// Appends what is known of a contact whose body wakes; its rows are those of no contact, to be found
    /// anew.
    void add_kept(const KeptManifold<Real>& kept);

    ManifoldColumns<Real> columns();
    /// Writes what was found of a contact in double precision.
    void set_manifold(std::size_t i, const Manifold<double>& found);
    /// What was found of a contact, in double precision.
    Manifold<double> manifold(std::size_t i) const;

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.a, self.b, self.item_a, self.item_b, self.names, self.memory, self.margin,
                self.thickness, self.friction, self.restitution);
        for_each_found_column(self, [&](auto& column) { archive(column); });
        if constexpr (!std::is_const_v<Self>) self.fit();
    }

  private:
    template <class Self, class Fn>
    static void for_each_found_column(Self& self, const Fn& fn) {
        for (auto* column :
             {&self.normal_x, &self.normal_y, &self.lever_a1, &self.lever_a2, &self.lever_b1, &self.lever_b2,
              &self.lever_a_t, &self.lever_b_t, &self.separation1, &self.separation2})
            fn(*column);
    }
};

extern template struct ManifoldList<float>;
extern template struct ManifoldList<double>;

}  // namespace carom
