#include "results/trajectory_h5.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "simulation/body_mass.hpp"
#include "simulation/outlines.hpp"

namespace carom::tool {
namespace {

constexpr std::size_t kBlockBytes = 1024 * 1024;  // several frames, as the next differs little from the last
constexpr std::size_t kLargestBodiesAChunk =
    64 * 1024;                            // 1 MiB of double positions: what HDF5 caches by default
constexpr std::size_t kNumbersABody = 5;  // position, velocity, angle
constexpr int kBlockCount = 3;            // one being filled, one waiting, one being written
constexpr hsize_t kTimesAChunk = 4096;

bool is_zero(std::span<const std::byte> data) {
    return data.empty() ||
           (data[0] == std::byte{0} && std::memcmp(data.data(), data.data() + 1, data.size() - 1) == 0);
}

std::size_t frames_a_block(std::size_t bodies, std::size_t element_size, std::int64_t frame_count) {
    const std::size_t frame_bytes = std::max<std::size_t>(1, bodies * kNumbersABody * element_size);
    const auto expected = static_cast<std::size_t>(std::max<std::int64_t>(1, frame_count));
    return std::clamp<std::size_t>(kBlockBytes / frame_bytes, 1,
                                   std::min<std::size_t>(expected, kTimesAChunk));
}

/// "#rrggbb" as a number.
double color_of(const Body& body) {
    constexpr std::uint32_t kNone = 0xFFFFFFFF;
    std::uint32_t color = kNone;
    if (body.color.size() == 7) std::from_chars(body.color.data() + 1, body.color.data() + 7, color, 16);
    return color;
}

}  // namespace

TrajectoryH5::TrajectoryH5(const std::filesystem::path& path, const Scene& scene,
                           const Simulation& simulation, const TrajectoryNotes& notes)
    : file_(path),
      bodies_(simulation.body_count()),
      element_size_(simulation.precision() == Precision::single_ ? sizeof(float) : sizeof(double)),
      frames_a_block_(frames_a_block(bodies_, element_size_, notes.frame_count)),
      bodies_a_chunk_(std::clamp<std::size_t>(bodies_, 1, kLargestBodiesAChunk)) {
    file_.set_attribute(file_.root(), "scene", notes.scene_text);
    file_.set_attribute(file_.root(), "settings", notes.settings);
    file_.set_attribute(file_.root(), "name", scene.name);
    make_datasets(scene, notes.shape);
    for (int i = 0; i < kBlockCount; ++i) {
        auto block = std::make_unique<Block>();
        const std::size_t numbers = frames_a_block_ * bodies_ * element_size_;
        block->position.resize(2 * numbers);
        block->velocity.resize(2 * numbers);
        block->angle.resize(numbers);
        empty_.push_back(std::move(block));
    }
    current_ = std::move(empty_.front());
    empty_.pop_front();
    thread_ = std::thread([this] { write_blocks(); });
}

TrajectoryH5::~TrajectoryH5() {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        full_.clear();
        ended_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void TrajectoryH5::make_datasets(const Scene& scene, const std::vector<double>& shape) {
    time_ = file_.make_growing("time", H5T_IEEE_F64LE, {0}, {kTimesAChunk});
    file_.set_attribute(time_, "units", "s");
    make_dataset("position", "m", 2, &Block::position);
    make_dataset("velocity", "m/s", 2, &Block::velocity);
    make_dataset("angle", "rad", 1, &Block::angle);

    make_column("radius", "m", scene, [](const Body& body) { return extent_of(body); });
    make_column("mass", "kg", scene, [](const Body& body) { return mass_of(body); });
    make_column("inertia", "kg m2", scene, [](const Body& body) { return inertia_of(body); });
    if (!shape.empty()) make_column("shape", "number in the settings' shapes, or -1", shape);
    if (std::any_of(scene.bodies.begin(), scene.bodies.end(),
                    [](const Body& body) { return !body.color.empty(); }))
        make_column("color", "0xRRGGBB, or 0xFFFFFFFF for none", scene,
                    [](const Body& body) { return color_of(body); });
}

void TrajectoryH5::make_column(const char* name, const char* unit, const Scene& scene,
                               double (*value)(const Body&)) {
    std::vector<double> values;
    values.reserve(scene.bodies.size());
    for (const Body& body : scene.bodies) values.push_back(value(body));
    make_column(name, unit, values);
}

void TrajectoryH5::make_column(const char* name, const char* unit, const std::vector<double>& values) {
    const hid_t dataset = file_.make_column(name, values);
    file_.set_attribute(dataset, "units", unit);
    file_.close_dataset(dataset);
}

void TrajectoryH5::make_dataset(const char* name, const char* unit, hsize_t components,
                                std::vector<std::byte> Block::*column) {
    const hid_t type = element_size_ == sizeof(float) ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    std::vector<hsize_t> shape{0, bodies_}, chunk{frames_a_block_, bodies_a_chunk_};
    if (components > 1) shape.push_back(components), chunk.push_back(components);
    const hid_t dataset = file_.make_growing(name, type, shape, chunk);
    file_.set_attribute(dataset, "units", unit);
    datasets_.push_back({.id = dataset, .components = components, .column = column});
}

void TrajectoryH5::append(const Simulation& simulation) {
    const std::size_t first = current_->time.size() * bodies_ * element_size_;
    simulation.copy_frame({.position = current_->position.data() + 2 * first,
                           .velocity = current_->velocity.data() + 2 * first,
                           .angle = current_->angle.data() + first});
    current_->time.push_back(simulation.time());
    if (current_->time.size() == frames_a_block_) hand_over();
}

/// Gives the current block to the writing thread and takes an empty one, as soon as there is one.
void TrajectoryH5::hand_over() {
    std::unique_lock lock(mutex_);
    if (!failure_) full_.push_back(std::move(current_));
    changed_.notify_all();
    changed_.wait(lock, [this] { return failure_ || !empty_.empty(); });
    if (failure_) std::rethrow_exception(failure_);
    current_ = std::move(empty_.front());
    empty_.pop_front();
}

void TrajectoryH5::close(const std::string& breaks) {
    {
        const std::lock_guard lock(mutex_);
        if (!current_->time.empty()) full_.push_back(std::move(current_));
        ended_ = true;
    }
    changed_.notify_all();
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    file_.set_attribute(file_.root(), "breaks", breaks);
    for (const Dataset& dataset : datasets_) file_.close_dataset(dataset.id);
    file_.close_dataset(time_);
    file_.close();
}

void TrajectoryH5::write_blocks() noexcept {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return ended_ || !full_.empty(); });
        if (full_.empty()) return;
        std::unique_ptr<Block> block = std::move(full_.front());
        full_.pop_front();
        lock.unlock();
        std::exception_ptr failure;
        try {
            write_block(*block);
        } catch (...) {
            failure = std::current_exception();
        }
        block->time.clear();
        lock.lock();
        empty_.push_back(std::move(block));
        failure_ = failure;
        changed_.notify_all();
        if (failure_) return;
    }
}

void TrajectoryH5::write_block(const Block& block) {
    file_.append(time_, frames_written_, block.time);
    for (const Dataset& dataset : datasets_) write_frames(dataset, block);
    frames_written_ += block.time.size();
}

/// A chunk holds all frames of a block for a range of bodies. If a frame needs more than one chunk, a block
/// is one frame; so the bodies of a chunk are always contiguous in the block.
void TrajectoryH5::write_frames(const Dataset& dataset, const Block& block) {
    std::vector<hsize_t> shape{frames_written_ + block.time.size(), bodies_}, offset{frames_written_, 0};
    if (dataset.components > 1) shape.push_back(dataset.components), offset.push_back(0);
    file_.set_extent(dataset.id, shape);

    const std::vector<std::byte>& column = block.*dataset.column;
    const std::size_t row = bodies_a_chunk_ * dataset.components;  // numbers a frame in a chunk
    const std::size_t body_bytes = dataset.components * element_size_;
    const std::size_t chunk_bytes = frames_a_block_ * bodies_a_chunk_ * body_bytes;
    for (std::size_t body = 0; body < bodies_; body += bodies_a_chunk_) {
        const std::size_t frames = bodies_ > bodies_a_chunk_ ? 1 : block.time.size();
        const std::size_t used = frames * std::min(bodies_a_chunk_, bodies_ - body) * body_bytes;
        std::span<const std::byte> data(column.data() + body * body_bytes, used);
        if (is_zero(data)) continue;  // HDF5 reads what was never written as zeros
        if (used < chunk_bytes) {     // the last chunk of a frame, or of the file
            padded_.assign(chunk_bytes, std::byte{0});
            std::memcpy(padded_.data(), data.data(), used);
            data = padded_;
        }
        offset[1] = body;
        file_.write_chunk(dataset.id, offset, deflater_.compress(data, element_size_, row));
    }
}

}  // namespace carom::tool
