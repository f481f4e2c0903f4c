#include "solvers/substeps/body_records.hpp"

#include <algorithm>
#include <limits>

namespace carom {
namespace {

// ns a body on one thread, for the executor: docs/decisions/0012-threads-of-soft.md.
constexpr double kNanosecondsToBegin = 0.7, kNanosecondsToAdvance = 1, kNanosecondsToMeasure = 0.6;

/// Speed that is none, in shares of what gravity adds in a substep: what rounding leaves of what it leaves.
template <class Real>
constexpr double kNoSpeed =
    static_cast<double>(std::numeric_limits<Real>::epsilon()) * std::numeric_limits<Real>::epsilon();

constexpr std::size_t kRowsToMeasure = 2048;  // of a task: sums have the same bits on any number of threads
static_assert(kContactBlock == kRowPadding);

}  // namespace

template <class Real>
StartColumns<Real> BodyRecords<Real>::start_columns() {
    return {start_x_.data(), start_y_.data(), has_rotation_ ? start_rim_.data() : nullptr};
}

template <class Real>
void BodyRecords<Real>::begin(const WorldState<Real>& world, const Column<Real>& motion,
                              const BodyMasses<Real>& masses, std::size_t written, std::size_t padding_rows,
                              const SubstepTerms& terms, const StepLoops<Real>& loops) {
    const Bodies<Real>& bodies = world.bodies;
    count_ = bodies.count, moving_ = bodies.moving(), has_rotation_ = world.effects.rotation;
    comes_to_rest_ = bodies.has_shapes || !world.joints.empty();
    delays_.clear();
    const std::size_t rows = padded(count_ + padding_rows);
    velocity.resize(4 * rows), displacement.resize(2 * rows);
    // Contacts of shapes ask for turns even where no body can turn.
    turn_.resize(has_rotation_ || bodies.has_shapes ? rows : 0);
    if (!has_rotation_) std::fill(turn_.begin(), turn_.end(), Real(0));
    start_x_.resize(rows), start_y_.resize(rows), start_rim_.resize(has_rotation_ ? rows : 0);
    const auto real = [](double value) { return static_cast<Real>(value); };
    BeginSubsteps<Real> k{};
    k.motion = motion.data();
    k.angular_velocity = has_rotation_ ? bodies.angular_velocity.data() : nullptr;
    k.radius = bodies.rim().data(), k.uniform_radius = bodies.rim().uniform_value();
    k.inverse_mass = masses.inverse();
    k.uniform_inverse_mass = count_ > 0 ? real(bodies.inverse_mass(0)) : Real(0);
    k.gain_x = real(terms.gravity_change.x), k.gain_y = real(terms.gravity_change.y);
    k.decay = real(terms.decay), k.spin_decay = real(terms.spin_decay);
    k.velocity = velocity.data(), k.start = start_columns();
    k.displacement = displacement.data(), k.turn = turn();
    const auto kernel = loops.kernels->begin_substeps[has_rotation_ ? 1 : 0];
    loops.executor->for_each_chunk(
        written, loops.rows_per_task, kNanosecondsToBegin,
        [&](std::size_t, std::size_t first, std::size_t last) { kernel(k, first, padded(last)); });
    // Padding must not fall.
    std::fill(velocity.data() + 4 * count_, velocity.data() + 4 * rows, Real(0));
    for (Column<Real>* column : {&start_x_, &start_y_, &start_rim_})
        if (!column->empty()) std::fill(column->data() + count_, column->data() + rows, Real(0));
}

template <class Real>
void BodyRecords<Real>::add_still_rows(std::size_t added) {
    const std::size_t all = padded(rows() + added);
    velocity.resize(4 * all), displacement.resize(2 * all);
    if (!turn_.empty()) turn_.resize(all);
}

template <class Real>
void BodyRecords<Real>::add_velocity(std::int32_t row, Vec2 dv, double du, const SubstepTerms& terms) {
    const auto i = static_cast<std::size_t>(row);
    const auto x = static_cast<Real>(dv.x), y = static_cast<Real>(dv.y), rim = static_cast<Real>(du);
    const auto left = static_cast<Real>(terms.decay), spin_left = static_cast<Real>(terms.spin_decay);
    start_x_[i] += x, start_y_[i] += y;
    velocity[4 * i] += left * x, velocity[4 * i + 1] += left * y;
    if (has_rotation_) start_rim_[i] += rim, velocity[4 * i + 2] += spin_left * rim;
}

template <class Real>
void BodyRecords<Real>::delay(std::int32_t row, Vec2 dv, double du, double time) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    const auto i = static_cast<std::size_t>(row);
    Delay& delay = delays_.emplace_back();
    delay = {i, {real(time * dv.x), real(time * dv.y), real(time * du)}, {}};
    const auto places = places_of(i);
    for (std::size_t k = 0; k < places.size() && places[k]; ++k)
        delay.before[k] = *places[k], *places[k] -= delay.by[k];
}

template <class Real>
void BodyRecords<Real>::put_off_delays() {
    for (std::size_t n = delays_.size(); n-- > 0;) {
        const auto places = places_of(delays_[n].row);
        for (std::size_t k = 0; k < places.size() && places[k]; ++k) *places[k] = delays_[n].before[k];
    }
}

template <class Real>
void BodyRecords<Real>::advance(bool is_last, const SubstepTerms& terms, const StepLoops<Real>& loops,
                                const Real* joined) {
    for (const Delay& delay : delays_) {
        const auto places = places_of(delay.row);
        for (std::size_t k = 0; k < places.size() && places[k]; ++k) *places[k] -= delay.by[k];
    }
    delays_.clear();
    const auto real = [](double value) { return static_cast<Real>(value); };
    AdvanceBodies<Real> k{};
    k.velocity = velocity.data(), k.start = start_columns();
    k.displacement = displacement.data(), k.turn = turn();
    k.h = real(terms.substep_dt);
    k.gain_x = real(terms.gravity_change.x), k.gain_y = real(terms.gravity_change.y);
    k.decay = real(terms.decay), k.spin_decay = real(terms.spin_decay), k.is_last = is_last;
    k.joined = joined;
    if (comes_to_rest_) k.nothing = real(kNoSpeed<Real> * terms.fall_speed());
    const auto kernel = loops.kernels->advance_bodies[(has_rotation_ ? 1 : 0) + (comes_to_rest_ ? 2 : 0)];
    loops.executor->for_each_chunk(
        moving_, loops.rows_per_task, kNanosecondsToAdvance,
        [&](std::size_t, std::size_t first, std::size_t last) { kernel(k, first, padded(last)); });
}

template <class Real>
EnergyGain BodyRecords<Real>::gain(const SubstepTerms& terms, const StepLoops<Real>& loops, GainOf of) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    MeasureGain<Real> k{};
    k.velocity = velocity.data(), k.start = start_columns();
    k.gain_x = real(terms.gravity_change.x), k.gain_y = real(terms.gravity_change.y);
    k.decay = real(terms.decay), k.spin_decay = real(terms.spin_decay);
    const auto kernel = loops.kernels->measure_gain[(has_rotation_ ? 1 : 0) + (of == GainOf::work ? 2 : 0)];
    gains_.assign(padded(moving_) / kRowsToMeasure + 1, {});
    loops.executor->for_each_chunk(moving_, kRowsToMeasure, kNanosecondsToMeasure,
                                   [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                       gains_[chunk] = kernel(k, first, padded(last));
                                   });
    EnergyGain sum;
    for (const EnergyGain& part : gains_) sum.gain += part.gain, sum.before += part.before;
    return sum;
}

template <class Real>
void BodyRecords<Real>::end(Bodies<Real>& bodies, ChunkedList& lost_rows, std::vector<std::int32_t>& lost,
                            const StepLoops<Real>& loops) {
    EndSubsteps<Real> k{};
    k.velocity = velocity.data(), k.displacement = displacement.data(), k.turn = turn();
    k.radius = bodies.rim().data(), k.uniform_radius = bodies.rim().uniform_value();
    k.position_x = bodies.position_x.data(), k.position_y = bodies.position_y.data();
    k.velocity_x = bodies.velocity_x.data(), k.velocity_y = bodies.velocity_y.data();
    k.angle = has_rotation_ ? bodies.angle.data() : nullptr;
    k.angular_velocity = has_rotation_ ? bodies.angular_velocity.data() : nullptr;
    k.largest_position = static_cast<Real>(kLargestPosition);
    k.largest_speed = static_cast<Real>(kLargestSpeed);
    lost_rows.prepare(moving_, loops.rows_per_task);
    const auto kernel = loops.kernels->end_substeps[has_rotation_ ? 1 : 0];
    loops.executor->for_each_chunk(moving_, loops.rows_per_task, kNanosecondsToBegin,
                                   [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                       EndSubsteps<Real> part = k;
                                       part.lost = lost_rows.part(chunk);
                                       lost_rows.set_count(chunk, kernel(part, first, padded(last)));
                                   });
    lost.clear();
    lost_rows.for_each_below(moving_, [&](std::int32_t row) { lost.push_back(row); });
}

template <class Real>
Sums BodyRecords<Real>::sums_of_lost(const WorldState<Real>& world, std::size_t row) const {
    const Bodies<Real>& bodies = world.bodies;
    const Real* record = &velocity[4 * row];
    return world.sums_of(row, {bodies.position_x[row], bodies.position_y[row]}, {record[0], record[1]},
                         static_cast<double>(record[2]) / static_cast<double>(bodies.rim(row)));
}

template <class Real>
std::size_t BodyRecords<Real>::bytes() const {
    return velocity.bytes() + displacement.bytes() + turn_.bytes() + start_x_.bytes() + start_y_.bytes() +
           start_rim_.bytes() + gains_.capacity() * sizeof(EnergyGain) + delays_.capacity() * sizeof(Delay);
}

template class BodyRecords<float>;
template class BodyRecords<double>;

}  // namespace carom
