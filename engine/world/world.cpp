#include <carom/world.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "scene/choose_solver.hpp"
#include "scene/validation/validation.hpp"
#include "scene/validation/wording.hpp"
#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"
#include "shapes/mass.hpp"
#include "state/body_faults.hpp"
#include "state/state_hash.hpp"
#include "step/make_simulation.hpp"
#include "step/plan.hpp"
#include "world/implementation.hpp"
#include "world/joints.hpp"
#include "world/measure.hpp"
#include "world/report.hpp"
#include "world/set_up.hpp"
#include "world/snapshot.hpp"

namespace carom {
namespace {

void check_options(const Scene& scene, const WorldOptions& options) {
    const Accuracy accuracy = accuracy_of(scene, options);
    validate_accuracy(accuracy, "World");
    if (accuracy.solver == Solver::pairwise)
        throw Error(
            ErrorCode::inconsistent,
            "World: solver \"pairwise\" is the naive reference engine, class carom::Pairwise "
            "(<carom/pairwise.hpp>), not a solver of World. Use \"auto\", \"impulse\" or \"soft\" here.");
    raise_if("World", find_iterations_problem(accuracy.iterations, accuracy.solver));
    raise_if("World", find_solver_problem(scene, accuracy.solver));
    raise_if("World: option effects", find_solver_problem(options.effects, accuracy.solver));
    validate_effects(scene, scene.effects, "World");
    validate_effects(scene, merged(options.effects, scene.effects), "World: option effects");
    constexpr int kMostThreads = 1024;  // more are a mistake: OpenMP would try to start them
    if (options.threads < 0 || options.threads > kMostThreads)
        throw Error(ErrorCode::out_of_range, "World: option threads is " + std::to_string(options.threads) +
                                                 "; expected 0 (as many as there are) to " +
                                                 std::to_string(kMostThreads) + ".");
}

/// A step that ended before its time.
template <class Real>
[[noreturn]] void throw_early_end(const Simulation<Real>& sim, double begin, double dt) {
    constexpr std::string_view kWhere = "World::step: ";
    if (const std::string& exceeded = sim.interruption.exceeded(); !exceeded.empty())
        throw Error(ErrorCode::given_up, join(kWhere, exceeded));
    throw Error(ErrorCode::interrupted,
                join(kWhere, "should_stop ended the step of ", dt, " s from ", begin,
                     " s on; the world is at ", sim.world.time, " s. It can go on from there."));
}

/// Drag cuts a step into substeps, and these must end.
constexpr double kMostTimesStep = 2048;  // no unit, 4,096 substeps

[[noreturn]] void refuse_drag(const Drag& drag, double dt) {
    const bool is_linear = drag.linear >= drag.angular;
    const double largest = is_linear ? drag.linear : drag.angular;
    throw Error(ErrorCode::out_of_range,
                join("World::step: dt is ", dt, " s and drag.", is_linear ? "linear" : "angular", " is ",
                     largest, " 1/s; expected a product of at most ", kMostTimesStep,
                     ", which takes 4096 substeps. Use shorter steps or less drag."));
}

/// A body of a world, in messages: by the index of its handle.
Item item_of(BodyId body) {
    return {"body", "/bodies", static_cast<std::ptrdiff_t>(body.index), ""};
}

}  // namespace

template <class Real>
BasicWorld<Real>::BasicWorld(const Scene& scene, const WorldOptions& options) {
    scene.validate();
    check_options(scene, options);
    const Accuracy accuracy = accuracy_of(scene, options);
    implementation_ = std::make_unique<Implementation>();
    implementation_->simulation = make_simulation<Real>(accuracy.solver);
    Simulation<Real>& sim = *implementation_->simulation;
    implementation_->called = call_effects(scene, options.effects);
    implementation_->overrides = merged(options.effects, scene.effects);
    implementation_->angular_drag = scene.drag.angular;
    implementation_->asked_for = options.solver.value_or(scene.accuracy.solver);
    implementation_->substeps = accuracy.substeps, implementation_->iterations = accuracy.iterations;
    implementation_->facts = facts_of(scene, accuracy.iterations);
    implementation_->called.solver_reason = implementation_->asked_for == Solver::automatic
                                                ? choose_solver(implementation_->facts).reason
                                                : "asked for";
    implementation_->threads = options.threads, implementation_->parallel_for = options.parallel_for;

    sim.interruption.set_question(options.should_stop);
    set_up(sim, scene, options, implementation_->called.effects);
    sim.check_bodies("World");
}

template <class Real>
BasicWorld<Real>::BasicWorld(const BasicWorld& other) : implementation_(std::make_unique<Implementation>()) {
    const Implementation& original = *other.implementation_;
    Implementation& copy = *implementation_;
    copy.threads = original.threads, copy.parallel_for = original.parallel_for;
    copy.simulation = make_simulation<Real>(original.sim().solver());
    copy.sim().kernels = original.sim().kernels;
    copy.sim().executor = Executor(copy.threads, copy.parallel_for);
    copy.sim().interruption.set_question(original.sim().interruption.question());
    std::vector<std::byte> bytes(other.state_bytes());
    other.save_state(bytes);
    restore_state(bytes);
}
template <class Real>
BasicWorld<Real>& BasicWorld<Real>::operator=(const BasicWorld& other) {
    if (this != &other) *this = BasicWorld(other);
    return *this;
}
template <class Real>
BasicWorld<Real>::~BasicWorld() = default;
template <class Real>
BasicWorld<Real>::BasicWorld(BasicWorld&&) noexcept = default;
template <class Real>
BasicWorld<Real>& BasicWorld<Real>::operator=(BasicWorld&&) noexcept = default;

template <class Real>
void BasicWorld<Real>::step(double dt) {
    validate_dt(dt, "World::step");
    if (dt == 0) return;
    Simulation<Real>& sim = implementation_->sim();
    if (const Drag& drag = sim.world.drag; std::max(drag.linear, drag.angular) * dt > kMostTimesStep)
        refuse_drag(drag, dt);
    if (!sim.world.sensing.keeps) clear_events();
    const double begin = sim.world.time;
    assert(!fault_of(sim.world.bodies) && "between steps");
    sim.interruption.start();
    const auto step = [&] { sim.step(dt); };
    if (sim.has_long_loops())
        sim.executor.with_team(step);
    else
        step();
    assert(!fault_of(sim.world.bodies) && "in the step");
    sim.executor.rethrow_host_error();
    sim.interruption.rethrow();
    if (sim.interruption.has_stopped()) throw_early_end(sim, begin, dt);
}

template <class Real>
std::size_t BasicWorld<Real>::body_count() const noexcept {
    return implementation_->bodies().rows();
}

template <class Real>
BodyView<Real> BasicWorld<Real>::bodies() const noexcept {
    const Bodies<Real>& b = implementation_->sim().world.bodies;
    BodyView<Real> view{
        b.rows(), b.position_x.span(), b.position_y.span(), b.velocity_x.span(), b.velocity_y.span(), {},
        {},       b.id.span()};
    if (b.has_rotation) view.angle = b.angle.span(), view.angular_velocity = b.angular_velocity.span();
    return view;
}

template <class Real>
std::uint32_t BasicWorld<Real>::row(BodyId body) const {
    return implementation_->sim().world.handles.row_of(body, "World::row");
}

template <class Real>
Shape BasicWorld<Real>::shape(BodyId body) const {
    return implementation_->sim().world.shape_of(implementation_->row_of(body, "World::shape"));
}

template <class Real>
bool BasicWorld<Real>::is_asleep(BodyId body) const {
    return implementation_->row_of(body, "World::is_asleep") >= implementation_->sim().world.bodies.count;
}

template <class Real>
BodyState BasicWorld<Real>::state(BodyId body) const {
    const std::size_t row = implementation_->row_of(body, "World::state");
    const Bodies<Real>& b = implementation_->sim().world.bodies;
    BodyState state{{b.position_x[row], b.position_y[row]}, 0, {b.velocity_x[row], b.velocity_y[row]}, 0};
    if (b.has_rotation) state.angle = b.angle[row], state.angular_velocity = b.angular_velocity[row];
    return state;
}

template <class Real>
BodyId BasicWorld<Real>::add(const Body& body) {
    validate_body(body, "World::add");
    SolverFacts facts = implementation_->facts;
    facts.add(body, "a body that was added");
    SolverChoice choice{implementation_->sim().solver(), implementation_->called.solver_reason};
    if (implementation_->asked_for == Solver::automatic && choice.solver != Solver::soft)
        choice = choose_solver(facts);
    raise_if("World::add", find_solver_problem({"the body has", "", -1, ""}, body,
                                               implementation_->world().gravity, choice.solver));
    if (implementation_->world().walls) validate_inside(body, *implementation_->world().walls, "World::add");
    if (body_count() >= kLargestBodyCount)
        throw Error(ErrorCode::too_large, "World::add: the world has " + std::to_string(body_count()) +
                                              " bodies, which is the limit. Remove some first.");
    std::optional<typename Implementation::Called> before;  // where the solver may yet refuse the body
    if (choice.solver == Solver::event) before = implementation_->what_is_called();
    implementation_->call_effects_of(body, choice.solver);
    implementation_->facts = std::move(facts);
    implementation_->change_solver(choice.solver, choice.reason);
    if (body.angular_velocity != 0 || body.angle != 0 || is_turned_by_contacts(body))
        implementation_->turn_rotation_on();
    if (const auto* compound = std::get_if<Compound>(&body.shape))
        implementation_->sim().wake_at(body.position, compound_size_of(*compound, body.material).extent);
    else if (is_convex(body.shape))
        implementation_->sim().wake_at(body.position, convex_shape_of<double>(body.shape).extent);
    else
        implementation_->sim().wake_all();
    WorldState<Real>& world = implementation_->world();
    const BodyId id = world.append(body);
    world.bring(world.sums_of(world.handles.row_of_slot(id.index)));
    implementation_->sim().note_added(world.handles.row_of_slot(id.index));
    implementation_->undo_if_refused("World::add", [&] {
        world.remove(world.handles.row_of_slot(id.index));
        if (before) implementation_->call_again(std::move(*before));
    });
    return id;
}

template <class Real>
void BasicWorld<Real>::set_solver(Solver solver) {
    Simulation<Real>& sim = implementation_->sim();
    if (solver == Solver::pairwise || solver == Solver::rigid)
        throw Error(ErrorCode::inconsistent,
                    "World::set_solver: solver \"" + std::string(name_of(solver)) +
                        "\" steps no World. Use \"auto\", \"impulse\", \"soft\", \"event\" or \"rattle\".");
    const Solver before = sim.solver();
    const std::string reason_before = implementation_->called.solver_reason;
    SolverChoice choice{solver, "asked for"};
    if (solver == Solver::automatic) choice = choose_solver(implementation_->facts);
    raise_if("World::set_solver", find_iterations_problem(implementation_->iterations, choice.solver));
    raise_if("World::set_solver", find_solver_problem(implementation_->as_scene(), choice.solver));
    implementation_->change_solver(choice.solver, choice.reason);
    implementation_->undo_if_refused("World::set_solver",
                                     [&] { implementation_->change_solver(before, reason_before); });
    implementation_->asked_for = solver;
}

template <class Real>
void BasicWorld<Real>::remove(BodyId body) {
    const std::size_t row = implementation_->row_of(body, "World::remove");
    implementation_->sim().remove(implementation_->wake_around(row));
}

template <class Real>
void BasicWorld<Real>::set_position(BodyId body, Vec2 position) {
    std::size_t row = implementation_->row_of(body, "World::set_position");
    validate_position(position, "World::set_position");
    Bodies<Real>& b = implementation_->bodies();
    row = implementation_->wake_around(row);
    implementation_->sim().wake_at(position, b.radius[row]);
    row = implementation_->row_of(body, "World::set_position");
    const auto move_to = [&](Real x, Real y) {
        implementation_->sim().note_place_before(row);
        if ((b.flags_of(row) & kEdges) != 0) implementation_->world().edges.note_change(body);
        implementation_->change_row(row, [&] { b.position_x[row] = x, b.position_y[row] = y; });
        implementation_->sim().note_place(row);
    };
    const Real x = b.position_x[row], y = b.position_y[row];
    move_to(static_cast<Real>(position.x), static_cast<Real>(position.y));
    implementation_->undo_if_refused("World::set_position", [&] { move_to(x, y); });
}

template <class Real>
void BasicWorld<Real>::set_velocity(BodyId body, Vec2 velocity) {
    std::size_t row = implementation_->row_of(body, "World::set_velocity");
    validate_velocity(velocity, "World::set_velocity");
    raise_if("World::set_velocity",
             find_velocity_problem(item_of(body), implementation_->mobility_of(row), velocity));
    row = implementation_->wake_around(row);
    Bodies<Real>& b = implementation_->bodies();
    implementation_->change_row(row, [&] {
        b.velocity_x[row] = static_cast<Real>(velocity.x), b.velocity_y[row] = static_cast<Real>(velocity.y);
    });
    implementation_->sim().note_velocity(row);
}

template <class Real>
void BasicWorld<Real>::set_angular_velocity(BodyId body, double angular_velocity) {
    std::size_t row = implementation_->row_of(body, "World::set_angular_velocity");
    validate_angular_velocity(angular_velocity, "World::set_angular_velocity");
    raise_if(
        "World::set_angular_velocity",
        find_angular_velocity_problem(item_of(body), implementation_->mobility_of(row), angular_velocity));
    if (angular_velocity != 0) implementation_->turn_rotation_on();
    Bodies<Real>& b = implementation_->bodies();
    if (!b.has_rotation) return;
    row = implementation_->wake_around(row);
    implementation_->change_row(row, [&] { b.angular_velocity[row] = static_cast<Real>(angular_velocity); });
    implementation_->sim().note_velocity(row);
}

template <class Real>
Filter BasicWorld<Real>::filter(BodyId body) const {
    const std::size_t row = implementation_->row_of(body, "World::filter");
    const Bodies<Real>& b = implementation_->sim().world.bodies;
    return {b.has_groups ? b.group[row] : 0, b.category(row), b.mask(row)};
}

template <class Real>
void BasicWorld<Real>::set_filter(BodyId body, const Filter& filter) {
    constexpr std::string_view kWhere = "World::set_filter";
    std::size_t row = implementation_->row_of(body, kWhere);
    if (filter == this->filter(body)) return;
    const Body wanted{.group = filter.group, .category = filter.category, .mask = filter.mask};
    const Solver solver = implementation_->sim().solver();
    if (solver == Solver::event) raise_if(kWhere, find_solver_problem(item_of(body), wanted, {}, solver));
    row = implementation_->wake_around(row);
    Bodies<Real>& b = implementation_->bodies();
    b.set_group(row, filter.group), b.set_filter(row, filter.category, filter.mask);
    if ((b.flags_of(row) & kEdges) != 0) implementation_->world().edges.note_change(body);
    // Pairs are found anew, and contacts that stay keep their impulses. To follow the row as one that is
    // elsewhere (decision 0031) would cost less and lose those of all its contacts.
    implementation_->sim().forget_derived_state();
}

template <class Real>
Events BasicWorld<Real>::events() const noexcept {
    const WorldState<Real>& world = implementation_->sim().world;
    return {world.sensing.events, world.joints.broken};
}

template <class Real>
void BasicWorld<Real>::clear_events() noexcept {
    WorldState<Real>& world = implementation_->sim().world;
    world.sensing.events.clear(), world.joints.broken.clear();
}

template <class Real>
std::vector<BodyId> BasicWorld<Real>::sensed(BodyId sensor) const {
    implementation_->row_of(sensor, "World::sensed");
    std::vector<BodyId> bodies;
    for (const SensedPair& pair : implementation_->sim().world.sensing.inside)
        if (pair.sensor == sensor) bodies.push_back(pair.body);
    return bodies;
}

template <class Real>
double BasicWorld<Real>::time() const noexcept {
    return implementation_->sim().world.time;
}

template <class Real>
Ledger BasicWorld<Real>::ledger() const {
    return ledger_of(implementation_->sim().world);
}

template <class Real>
Profile BasicWorld<Real>::profile() const {
    const Simulation<Real>& sim = implementation_->sim();
    Profile profile = implementation_->of_earlier_solvers;
    add_counts(sim, profile);
    profile.steps = sim.step_count;
    profile.candidate_pairs = static_cast<std::int64_t>(sim.candidates.pair_count());
    profile.asleep = static_cast<std::int64_t>(sim.world.bodies.asleep);
    profile.quarantined = sim.world.quarantined_count;
    profile.bytes = sim.bytes();
    return profile;
}

template <class Real>
Plan BasicWorld<Real>::plan() const {
    return describe_plan(implementation_->sim(), implementation_->called);
}

template <class Real>
OverlapReport BasicWorld<Real>::overlaps() const {
    const OverlapReport report = measure_overlaps(implementation_->sim());
    implementation_->sim().executor.rethrow_host_error();
    return report;
}

template <class Real>
std::vector<BodyId> BasicWorld<Real>::quarantined() const {
    return implementation_->quarantined();
}

template <class Real>
JointId BasicWorld<Real>::add(const Joint& joint) {
    return WorldJoints<Real>(*implementation_).add(joint);
}

template <class Real>
void BasicWorld<Real>::remove(JointId joint) {
    WorldJoints<Real>(*implementation_).remove(joint);
}

template <class Real>
std::size_t BasicWorld<Real>::joint_count() const noexcept {
    return WorldJoints<Real>(*implementation_).count();
}

template <class Real>
bool BasicWorld<Real>::is_alive(JointId joint) const noexcept {
    return WorldJoints<Real>(*implementation_).is_alive(joint);
}

template <class Real>
void BasicWorld<Real>::set_motor(JointId joint, double speed, double most) {
    WorldJoints<Real>(*implementation_).set_motor(joint, speed, most);
}

template <class Real>
void BasicWorld<Real>::set_limits(JointId joint, double lower, double upper) {
    WorldJoints<Real>(*implementation_).set_limits(joint, lower, upper);
}

template <class Real>
void BasicWorld<Real>::set_target(JointId joint, Vec2 target) {
    WorldJoints<Real>(*implementation_).set_target(joint, target);
}

template <class Real>
Vec2 BasicWorld<Real>::joint_force(JointId joint) const {
    return WorldJoints<Real>(*implementation_).force(joint);
}

template <class Real>
double BasicWorld<Real>::joint_torque(JointId joint) const {
    return WorldJoints<Real>(*implementation_).torque(joint);
}

template <class Real>
std::array<Vec2, 2> BasicWorld<Real>::joint_anchors(JointId joint) const {
    return WorldJoints<Real>(*implementation_).anchors(joint);
}

template <class Real>
JointErrors BasicWorld<Real>::joint_errors() const {
    return WorldJoints<Real>(*implementation_).errors();
}

template <class Real>
std::vector<JointId> BasicWorld<Real>::broken_joints() const {
    return WorldJoints<Real>(*implementation_).broken();
}

template <class Real>
std::size_t BasicWorld<Real>::state_bytes() const {
    return snapshot_bytes(implementation_->sim(), *implementation_);
}

template <class Real>
void BasicWorld<Real>::save_state(std::span<std::byte> out) const {
    save_snapshot(implementation_->sim(), *implementation_, out);
}

template <class Real>
void BasicWorld<Real>::restore_state(std::span<const std::byte> state) {
    const Solver solver = solver_of_snapshot<Real>(state);
    Implementation& own = *implementation_;
    if (solver != own.sim().solver()) own.simulation = own.make_next(solver);
    restore_snapshot(own.sim(), own, state);
}

template <class Real>
std::uint64_t BasicWorld<Real>::state_hash() const {
    return hash_of(implementation_->sim().world);
}

template class BasicWorld<float>;
template class BasicWorld<double>;

}  // namespace carom
