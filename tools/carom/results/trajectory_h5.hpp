#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "results/h5_file.hpp"
#include "results/plane_deflater.hpp"
#include "simulation/simulation.hpp"

namespace carom::tool {

/// What a trajectory says of the run it was recorded in.
struct TrajectoryNotes {
    std::string scene_text;    ///< as it stands in the scene file
    std::string settings;      ///< JSON: what the run did with it, options included
    std::int64_t frame_count;  ///< expected; fewer or more may follow
    std::vector<double>
        shape{};  ///< of each body: number in the settings' "shapes", or -1; empty if there are none
};

/// Streams frames into trajectory.h5. `append` copies the state and returns; a thread of its own compresses
/// and writes. Memory: three blocks of frames, about half a megabyte or one frame each, whichever is larger.
class TrajectoryH5 {
  public:
    /// @throws WriteError
    TrajectoryH5(const std::filesystem::path& path, const Scene& scene, const Simulation& simulation,
                 const TrajectoryNotes& notes);
    /// Leaves the file unfinished unless `close` was called.
    ~TrajectoryH5();

    /// Appends the state of now. @throws WriteError if an earlier frame could not be written.
    void append(const Simulation& simulation);
    /// Writes what is left. @param breaks  JSON: joints that broke, and when  @throws WriteError
    void close(const std::string& breaks);

  private:
    struct Block {
        std::vector<double> time;
        std::vector<std::byte> position, velocity, angle;  // [frames a block, bodies, components]
    };
    struct Dataset {
        hid_t id = H5I_INVALID_HID;
        hsize_t components = 1;
        std::vector<std::byte> Block::*column = nullptr;
    };

    void make_datasets(const Scene& scene, const std::vector<double>& shape);
    void make_column(const char* name, const char* unit, const Scene& scene, double (*value)(const Body&));
    void make_column(const char* name, const char* unit, const std::vector<double>& values);
    void make_dataset(const char* name, const char* unit, hsize_t components,
                      std::vector<std::byte> Block::*column);
    void hand_over();
    void write_blocks() noexcept;
    void write_block(const Block& block);
    void write_frames(const Dataset& dataset, const Block& block);

    H5File file_;
    std::size_t bodies_, element_size_;
    std::size_t frames_a_block_, bodies_a_chunk_;
    hid_t time_ = H5I_INVALID_HID;
    std::vector<Dataset> datasets_;

    // Of the writing thread alone:
    PlaneDeflater deflater_;
    std::vector<std::byte> padded_;
    hsize_t frames_written_ = 0;

    // Between the two:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::unique_ptr<Block>> full_, empty_;
    std::exception_ptr failure_;
    bool ended_ = false;

    std::unique_ptr<Block> current_;
    std::thread thread_;
};

}  // namespace carom::tool
