#pragma once

#include <hdf5.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace carom::tool {

/// An HDF5 file being written, with the few operations a trajectory needs. Every failure is a WriteError with
/// the system's reason. A file that is not closed is abandoned as it is: HDF5 cannot close one whose disk is
/// full, and would try again for ever.
class H5File {
  public:
    explicit H5File(const std::filesystem::path& path);
    H5File(const H5File&) = delete;
    H5File& operator=(const H5File&) = delete;

    hid_t root() const { return file_; }

    /// Text in UTF-8, of any length.
    void set_attribute(hid_t object, const char* name, const std::string& text);
    void set_attribute(hid_t object, const char* name, double value);

    /// A dataset whose first dimension grows; the others are fixed. Chunks are shuffled and deflated.
    hid_t make_growing(const char* name, hid_t type, std::vector<hsize_t> shape, std::vector<hsize_t> chunk);
    /// A dataset of one dimension, written at once.
    hid_t make_column(const char* name, const std::vector<double>& values);

    void set_extent(hid_t dataset, const std::vector<hsize_t>& shape);
    /// Writes one chunk that has been shuffled and deflated already.
    void write_chunk(hid_t dataset, const std::vector<hsize_t>& offset, std::span<const std::byte> bytes);
    /// Appends to a growing dataset of one dimension.
    void append(hid_t dataset, hsize_t first, std::span<const double> values);

    void close_dataset(hid_t dataset);
    void close();

  private:
    hid_t check(hid_t result);
    /// Of a dataset that does not say when it was written: the same run gives the same file.
    hid_t dataset_properties();
    hid_t filters(const std::vector<hsize_t>& chunk);

    std::string name_;
    hid_t file_ = H5I_INVALID_HID;
};

}  // namespace carom::tool
