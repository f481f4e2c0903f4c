#include "report/readers/h5_reader.hpp"

#include <array>
#include <memory>
#include <utility>

#include "report/readers/json_text.hpp"
#include "report/readers/result_error.hpp"

namespace carom::report {
namespace {

/// Numbers that a byte of a file holds at most: deflate packs 1,032 bytes into one.
constexpr double kMostNumbersAByte = 1032;

/// Closes an identifier of HDF5 when it is no longer needed.
class Open {
  public:
    Open(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Open() {
        if (id_ >= 0) close_(id_);
    }
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;
    operator hid_t() const { return id_; }

  private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

}  // namespace

H5Reader::H5Reader(const std::filesystem::path& path) : name_(path.string()) {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are ours to tell
    file_ = check(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    try {
        find_size(path);
    } catch (...) {
        close();
        throw;
    }
}

/// A damaged file may claim any size; memory is asked for by what it says.
void H5Reader::find_size(const std::filesystem::path& path) {
    const Dataset& position = open("position");
    std::array<hsize_t, 3> shape{};
    if (position.rank != 3) refuse();
    H5Sget_simple_extent_dims(position.space, shape.data(), nullptr);
    std::error_code failed;
    const auto bytes = static_cast<double>(std::filesystem::file_size(path, failed));
    if (failed || shape[2] != 2) refuse();
    // Each of them alone, too, as the other one may be 0.
    for (const double numbers : {static_cast<double>(shape[0]), static_cast<double>(shape[1]),
                                 static_cast<double>(shape[0]) * static_cast<double>(shape[1])})
        if (numbers > kMostNumbersAByte * bytes) refuse();
    frames_ = shape[0];
    bodies_ = shape[1];
}

H5Reader::~H5Reader() {
    close();
}

void H5Reader::close() {
    for (const Dataset& dataset : open_) {
        H5Sclose(dataset.space);
        H5Dclose(dataset.id);
    }
    H5Fclose(file_);
}

void H5Reader::refuse() const {
    throw ResultError(name_ + ": cannot be read as a trajectory that a run wrote");
}

hid_t H5Reader::check(hid_t result) const {
    if (result < 0) refuse();
    return result;
}

const H5Reader::Dataset& H5Reader::open(const char* name) {
    for (const Dataset& dataset : open_)
        if (dataset.name == name) return dataset;
    const hid_t id = check(H5Dopen2(file_, name, H5P_DEFAULT)), space = H5Dget_space(id);
    const int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    open_.push_back({.name = name, .id = id, .space = space, .rank = rank});
    if (rank < 1 || rank > 3) refuse();
    return open_.back();
}

bool H5Reader::has(const char* dataset) const {
    return H5Lexists(file_, dataset, H5P_DEFAULT) > 0;
}

bool H5Reader::holds_data(const char* dataset) const {
    if (!has(dataset)) return false;
    const Open id(check(H5Dopen2(file_, dataset, H5P_DEFAULT)), &H5Dclose);
    return H5Dget_storage_size(id) > 0;
}

std::string H5Reader::text(const char* attribute) const {
    if (H5Aexists(file_, attribute) <= 0) return {};
    const Open id(check(H5Aopen(file_, attribute, H5P_DEFAULT)), &H5Aclose);
    const Open type(check(H5Aget_type(id)), &H5Tclose);
    const Open space(check(H5Aget_space(id)), &H5Sclose);
    if (H5Tis_variable_str(type) <= 0 || H5Sget_simple_extent_npoints(space) != 1) return {};
    char* data = nullptr;
    check(H5Aread(id, type, &data));
    const std::unique_ptr<char, herr_t (*)(void*)> owner(data, &H5free_memory);
    return data != nullptr ? data : "";
}

Json H5Reader::json(const char* attribute) const {
    try {
        return parse_json(text(attribute));
    } catch (const Json::exception&) {
        return nullptr;
    }
}

std::vector<double> H5Reader::column(const char* dataset, std::size_t size) const {
    const Open id(check(H5Dopen2(file_, dataset, H5P_DEFAULT)), &H5Dclose);
    const Open space(check(H5Dget_space(id)), &H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(size)) refuse();
    std::vector<double> values(size);
    if (!values.empty()) check(H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    return values;
}

void H5Reader::read_frame(const char* dataset, std::size_t frame, std::span<float> values) {
    if (values.empty()) return;
    const Dataset& source = open(dataset);
    const hsize_t start[3] = {frame, 0, 0}, count[3] = {1, bodies_, values.size() / bodies_},
                  size = values.size();
    check(H5Sselect_hyperslab(source.space, H5S_SELECT_SET, start, nullptr, count, nullptr));
    if (H5Sget_select_npoints(source.space) != static_cast<hssize_t>(size)) refuse();
    const Open memory(check(H5Screate_simple(1, &size, nullptr)), &H5Sclose);
    check(H5Dread(source.id, H5T_NATIVE_FLOAT, memory, source.space, H5P_DEFAULT, values.data()));
}

}  // namespace carom::report
