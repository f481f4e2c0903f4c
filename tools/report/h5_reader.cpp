#include "report/h5_reader.hpp"

#include "report/kinds.hpp"

namespace carom::report {

H5Reader::H5Reader(const std::filesystem::path& path) : name_(path.string()) {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are ours to tell
    file_ = check(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
    hsize_t shape[3] = {0, 0, 0};
    const Dataset& position = open("position");
    if (H5Sget_simple_extent_ndims(position.space) != 3) check(H5I_INVALID_HID);
    H5Sget_simple_extent_dims(position.space, shape, nullptr);
    frames_ = shape[0];
    bodies_ = shape[1];
}

H5Reader::~H5Reader() {
    for (const Dataset& dataset : open_) {
        H5Sclose(dataset.space);
        H5Dclose(dataset.id);
    }
    if (file_ >= 0) H5Fclose(file_);
}

hid_t H5Reader::check(hid_t result) const {
    if (result < 0) throw ResultError(name_ + ": cannot be read as a trajectory that a run wrote");
    return result;
}

const H5Reader::Dataset& H5Reader::open(const char* name) {
    for (const Dataset& dataset : open_)
        if (dataset.name == name) return dataset;
    const hid_t id = check(H5Dopen2(file_, name, H5P_DEFAULT));
    open_.push_back({.name = name, .id = id, .space = H5Dget_space(id)});
    return open_.back();
}

bool H5Reader::has(const char* dataset) const {
    return H5Lexists(file_, dataset, H5P_DEFAULT) > 0;
}

bool H5Reader::holds_data(const char* dataset) const {
    if (!has(dataset)) return false;
    const hid_t id = check(H5Dopen2(file_, dataset, H5P_DEFAULT));
    const hsize_t size = H5Dget_storage_size(id);
    H5Dclose(id);
    return size > 0;
}

std::string H5Reader::text(const char* attribute) const {
    if (H5Aexists(file_, attribute) <= 0) return {};
    const hid_t id = check(H5Aopen(file_, attribute, H5P_DEFAULT)), type = check(H5Aget_type(id));
    if (H5Tis_variable_str(type) <= 0) return {};
    char* data = nullptr;
    check(H5Aread(id, type, &data));
    std::string value = data != nullptr ? data : "";
    H5free_memory(data);
    H5Tclose(type);
    H5Aclose(id);
    return value;
}

std::vector<double> H5Reader::column(const char* dataset, std::size_t size) const {
    const hid_t id = check(H5Dopen2(file_, dataset, H5P_DEFAULT)), space = check(H5Dget_space(id));
    if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(size)) check(H5I_INVALID_HID);
    std::vector<double> values(size);
    if (!values.empty()) check(H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    H5Sclose(space);
    H5Dclose(id);
    return values;
}

void H5Reader::read_frame(const char* dataset, std::size_t frame, std::span<float> values) {
    if (values.empty()) return;
    const Dataset& source = open(dataset);
    const hsize_t start[3] = {frame, 0, 0}, count[3] = {1, bodies_, values.size() / bodies_},
                  size = values.size();
    check(H5Sselect_hyperslab(source.space, H5S_SELECT_SET, start, nullptr, count, nullptr));
    const hid_t memory = check(H5Screate_simple(1, &size, nullptr));
    const herr_t done =
        H5Dread(source.id, H5T_NATIVE_FLOAT, memory, source.space, H5P_DEFAULT, values.data());
    H5Sclose(memory);
    check(done);
}

}  // namespace carom::report
