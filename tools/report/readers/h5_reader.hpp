#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "report/page/markup.hpp"

namespace carom::report {

/// Reads trajectory.h5 frame by frame; memory is what HDF5 caches, a megabyte a dataset. Every failure is a
/// ResultError that names the file.
class H5Reader {
  public:
    explicit H5Reader(const std::filesystem::path& path);
    ~H5Reader();
    H5Reader(const H5Reader&) = delete;
    H5Reader& operator=(const H5Reader&) = delete;

    std::size_t frame_count() const { return frames_; }
    std::size_t body_count() const { return bodies_; }
    bool has(const char* dataset) const;
    /// Whether anything was ever written to it; what was not reads as zeros.
    bool holds_data(const char* dataset) const;

    /// A text attribute of the root; empty if there is none.
    std::string text(const char* attribute) const;
    /// Likewise, as JSON; null if it is none.
    Json json(const char* attribute) const;
    /// A dataset of one dimension, whole: `size` values, or it is an error.
    std::vector<double> column(const char* dataset, std::size_t size) const;
    std::vector<double> body_column(const char* dataset) const { return column(dataset, bodies_); }
    std::vector<double> times() const { return column("time", frames_); }
    /// All components of one frame of a dataset, in body order. `values` has the size of a frame.
    void read_frame(const char* dataset, std::size_t frame, std::span<float> values);

  private:
    struct Dataset {
        std::string name;
        hid_t id;
        hid_t space;
        int rank;
    };
    [[noreturn]] void refuse() const;
    hid_t check(hid_t result) const;
    void find_size(const std::filesystem::path& path);
    void close();
    const Dataset& open(const char* name);

    std::string name_;
    hid_t file_ = H5I_INVALID_HID;
    std::vector<Dataset> open_;
    std::size_t frames_ = 0, bodies_ = 0;
};

}  // namespace carom::report
