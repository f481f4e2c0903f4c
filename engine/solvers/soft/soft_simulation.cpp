#include "solvers/soft/soft_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/soft/stages.hpp"

namespace carom {
namespace {

/// Substeps are so many that a body falls at most this share of the usual radius from rest in one, because
/// contacts are looked at once a substep. No more are taken than a scene may ask for.
constexpr double kLargestFall = 0.005, kMostSubsteps = 1024;

/// Where a step is cut into flights, a body of root mean square speed travels at most this share of the usual
/// radius in a substep, unless more substeps than so many would be needed in a flight: what falls into a
/// crowd faster is stopped too deep in it.
constexpr double kLargestTravel = 0.5;
constexpr double kMostSubstepsOfFlight = 16;

/// Far pairs a body (Candidates::count_far_pairs) above which flights are halved, and below which a step
/// begins with longer ones.
constexpr double kMostFarPairs = 1;
constexpr double kFewFarPairs = 0.125;
/// Candidate pairs a body that crowds have at any speed: where there are no more, far ones are not counted.
constexpr double kOrdinaryPairs = 5;
/// Bodies that are counted besides, for a few may all be near each other.
constexpr double kFewBodies = 64;

}  // namespace

template <class Real>
void SoftSimulation<Real>::forget_derived_state() {
    this->candidates.invalidate();
    soft.forget_rows(), soft.paths.forget_cut(), edge_candidates.forget_rows();
}

/// Substeps a second that gravity calls for; 0: as few as anything.
template <class Real>
double SoftSimulation<Real>::rate_against_gravity() const {
    if (soft.joints.is_rattle) return 0;
    const Radii* known = this->candidates.known_radii();
    const double usual = known ? known->usual : measure_radii(this->world.bodies).usual;
    if (!(usual > 0)) return 0;
    const double gravity = std::sqrt(length_squared(this->world.gravity));
    return std::sqrt(0.5 * gravity / (kLargestFall * usual));
}

/// Substeps of a flight of dt [s] among several that speed calls for.
template <class Real>
int SoftSimulation<Real>::substeps_for_speed(double dt) const {
    const Bodies<Real>& bodies = this->world.bodies;
    double sum = 0;  // m²/s²
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        sum += length_squared(Vec2{bodies.velocity_x[row], bodies.velocity_y[row]});
    const double travel = dt * std::sqrt(sum / static_cast<double>(bodies.moving()));
    const double substeps = std::ceil(travel / (kLargestTravel * this->candidates.usual_radius()));
    return static_cast<int>(std::fmin(substeps, kMostSubstepsOfFlight));
}

template <class Real>
void SoftSimulation<Real>::set_flight() {
    const double dt = flights.length(), rate = rate_against_gravity();
    const auto against_gravity = static_cast<int>(std::fmin(std::ceil(dt * rate), kMostSubsteps));
    this->flight_dt = dt;
    substep_count =
        std::max({this->substeps_for_drag(dt, flights.count()), against_gravity, substeps_for_joints()});
    if (flights.count() > 1) substep_count = std::max(substep_count, substeps_for_speed(dt));
    substep_dt = dt / substep_count;
    longest_substep = rate > 0 ? 1 / rate : 0;
}

template <class Real>
bool SoftSimulation<Real>::shorten_flight() {
    const double bodies = static_cast<double>(this->world.bodies.count) + kFewBodies;
    if (static_cast<double>(this->candidates.pair_count()) <= kOrdinaryPairs * bodies ||
        static_cast<double>(this->candidates.count_far_pairs(this->world.bodies)) <= kMostFarPairs * bodies ||
        !flights.shorten())
        return false;
    set_flight();
    this->candidates.invalidate_pairs();
    return true;
}

template <class Real>
void SoftSimulation<Real>::begin_flights(double dt) {
    const auto far_pairs = [&] {
        return static_cast<double>(this->candidates.count_far_pairs(this->world.bodies));
    };
    if (flights.count() > 1 && far_pairs() <= kFewFarPairs * static_cast<double>(this->world.bodies.count))
        flights.lengthen();
    flights.begin_step(dt);
}

template <class Real>
void SoftSimulation<Real>::take_back_flight() {
    this->world.books = start_books_;
    soft.drop_books();
    forget_derived_state();
}

/// A body is about to be removed or put elsewhere: what it leaves is told to contacts of discs by its place,
/// and to those of shapes by its mass.
template <class Real>
void SoftSimulation<Real>::note_leaving(std::size_t row) {
    const std::int32_t former = soft.graph.trail.old_row(row);
    const Bodies<Real>& bodies = this->world.bodies;
    if (bodies.has_shapes && !bodies.is_immovable(row)) soft.note_lost(bodies.mass[row]);
    const double mass = bodies.is_immovable(row) ? std::numeric_limits<double>::infinity() : bodies.mass[row];
    if (former >= 0)
        soft.graph.former_places.push_back({former, {bodies.position_x[row], bodies.position_y[row]}, mass});
}

/// Whatever the pairs, their contacts or the length of substeps cannot follow makes all of it void.
template <class Real>
void SoftSimulation<Real>::note_change(bool may_follow) {
    ++changes_;
    if (!may_follow || !this->candidates.may_follow(changes_, this->world.bodies.moving()))
        forget_derived_state();
}

/// Whether pairs and contacts can follow what becomes of a body: not where it has edges, nor where a shape
/// stands, which others may be held by.
template <class Real>
bool SoftSimulation<Real>::can_follow(std::size_t row) const {
    const Bodies<Real>& bodies = this->world.bodies;
    return bodies.is_disc(row) ||
           (bodies.has_shapes && bodies.shape[row] >= 0 && (bodies.flags_of(row) & (kEdges | kSensor)) == 0 &&
            !bodies.is_immovable(row));
}

template <class Real>
void SoftSimulation<Real>::remove(std::size_t row) {
    note_leaving(row);
    soft.graph.trail.follow_removed(row, this->world.bodies.count - 1);
    const Bodies<Real>& bodies = this->world.bodies;
    const Radii* radii = this->candidates.known_radii();
    // A small disc that goes may change what radius is usual; where there are shapes that waits until pairs
    // are found anew.
    const bool may_follow =
        can_follow(row) && radii &&
        (bodies.has_shapes || bodies.radius.is_uniform() || bodies.radius[row] > radii->usual);
    const std::size_t joints = this->world.joints.count();
    const EdgeStore::Removed edges = this->world.remove(row);
    soft.graph.supports.follow_removed_edges(edges);
    if (edges.count > 0) sleepers.forget_woken();
    // What a joint kept apart may touch now.
    note_change(may_follow && this->world.joints.count() == joints);
}

template <class Real>
void SoftSimulation<Real>::note_added(std::size_t row) {
    const Radii* radii = this->candidates.known_radii();
    const Bodies<Real>& bodies = this->world.bodies;
    const double least = bodies.has_shapes ? bodies.inradius(row) : static_cast<double>(bodies.radius[row]);
    if (bodies.standing > 0 && !bodies.stands(row)) soft.graph.trail.follow_made_room(row, bodies.count - 1);
    note_change(can_follow(row) && radii && least >= (bodies.has_shapes ? radii->smallest : radii->usual) &&
                static_cast<double>(bodies.radius[row]) <= radii->largest);
}

template <class Real>
void SoftSimulation<Real>::note_place_before(std::size_t row) {
    note_leaving(row);
}

template <class Real>
void SoftSimulation<Real>::note_place(std::size_t row) {
    elsewhere_.push_back(this->world.bodies.id[row]);
    note_change(can_follow(row));
}

/// What contacts have columns of: one bit each.
template <class Real>
std::uint32_t SoftSimulation<Real>::kinds_of_columns() const {
    const Bodies<Real>& bodies = this->world.bodies;
    const Effects& effects = this->world.effects;
    std::uint32_t kinds = 1;
    for (const bool kind :
         {bodies.radius.is_uniform(), bodies.mass.is_uniform(), bodies.friction.is_uniform(),
          bodies.restitution.is_uniform(), bodies.rolling_resistance.is_uniform(), bodies.has_flags,
          bodies.has_rotation, bodies.has_shapes, effects.friction, effects.restitution})
        kinds = 2 * kinds + kind;
    return kinds;
}

template <class Real>
void SoftSimulation<Real>::follow_changes() {
    const WorldState<Real>& state = this->world;
    const std::size_t count = state.bodies.count, changes = changes_;
    const bool may_follow = this->candidates.may_follow(changes, state.bodies.moving()) &&
                            state.bodies.asleep == 0 && soft.paths.manifolds.may_follow_rows(state) &&
                            !state.effects.rolling_resistance && kinds_of_graph == kinds_of_columns() &&
                            graph_of_rebuild == this->candidates.rebuild_count();
    changes_ = 0;
    if (!may_follow) {
        elsewhere_.clear();
        forget_derived_state();
        return;
    }
    is_elsewhere_.assign(count, 0);
    for (const BodyId body : elsewhere_)
        if (state.handles.is_alive(body)) is_elsewhere_[state.handles.row_of_slot(body.index)] = 1;
    elsewhere_.clear();
    const std::vector<std::int32_t>& now = soft.graph.trail.new_rows();
    bool are_renamed = now.size() != count;  // some rows; joints name theirs
    for (std::size_t row = 0; row < now.size() && !are_renamed; ++row)
        are_renamed = now[row] != static_cast<std::int32_t>(row);
    this->candidates.follow_rows(state.bodies, now, is_elsewhere_);
    edge_candidates.follow_rows(now, is_elsewhere_);
    soft.paths.manifolds.follow_rows(state, edge_candidates, now, is_elsewhere_);
    soft.graph.follow_rows(state.bodies, is_elsewhere_);
    soft.follow_rows();
    if (are_renamed) soft.joints.forget();
}

template <class Real>
void SoftSimulation<Real>::wake_at(Vec2 place, double reach) {
    if (sleepers.mark_near(this->world, place, reach, *this->kernels, this->executor)) wake_marked(*this);
}

template <class Real>
void SoftSimulation<Real>::wake_all() {
    if (sleepers.mark_all(this->world)) wake_marked(*this);
}

template <class Real>
std::size_t SoftSimulation<Real>::wake_body(std::size_t row) {
    Bodies<Real>& bodies = this->world.bodies;
    if (row < bodies.count) return row;
    const BodyId id = bodies.id[row];
    sleepers.mark(bodies.island[row]);
    wake_marked(*this);
    return this->world.handles.row_of_slot(id.index);
}

template <class Real>
void SoftSimulation<Real>::report(Profile& profile) const {
    const SoftCounters& counters = soft.counters;
    profile.contacts = counters.contacts, profile.colours = counters.colours;
    profile.overflow = counters.overflow;
    const ImpactCounters& impacts = soft.impacts.counters;
    profile.impacts += soft.paths.counters.impacts, profile.path_cuts += soft.paths.counters.cuts;
    profile.path_solves += soft.paths.counters.solves;
    profile.impacts += impacts.impacts, profile.wall_impacts += impacts.of_walls;
    profile.bounces += impacts.impacts - impacts.inelastic;
    const SolveQuality solve = soft.quality();
    profile.touching = solve.touching;
    profile.residual = solve.residual, profile.residual_max = solve.residual_max;
    profile.islands_asleep = sleepers.island_count();
    profile.islands_woken += sleepers.woken_count();
}

template <class Real>
std::size_t SoftSimulation<Real>::bytes() const {
    return Simulation<Real>::bytes() + sizeof(*this) + edge_candidates.bytes() + soft.bytes() +
           tunnelling.bytes() + shape_tunnelling.bytes() + sleepers.bytes() + motion.bytes();
}

template class SoftSimulation<float>;
template class SoftSimulation<double>;

}  // namespace carom
