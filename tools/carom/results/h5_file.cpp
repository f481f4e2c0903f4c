#include "results/h5_file.hpp"

#include <cerrno>
#include <cstring>
#include <string_view>

#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

constexpr unsigned kDeflateLevel = 1;  // for what HDF5 compresses itself: times and columns, a small part

/// Takes "No space left on device" out of the innermost message of HDF5, or the message as it is.
herr_t note_reason(unsigned, const H5E_error2_t* error, void* reason) {
    constexpr std::string_view kBefore = "error message = '";
    std::string text = error->desc != nullptr ? error->desc : "";
    if (const auto begin = text.find(kBefore); begin != std::string::npos) {
        text.erase(0, begin + kBefore.size());
        text.erase(std::min(text.find('\''), text.size()));
    }
    *static_cast<std::string*>(reason) = text;
    return 1;  // no further
}

/// HDF5 would print its errors on standard error; each thread has its own setting.
void silence_hdf5() {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace

H5File::H5File(const std::filesystem::path& path) : name_(path.string()) {
    H5dont_atexit();
    silence_hdf5();
    file_ = check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
}

hid_t H5File::check(hid_t result) {
    if (result >= 0) return result;
    std::string reason = "HDF5 error";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, &note_reason, &reason);
    H5Eclear2(H5E_DEFAULT);
    throw WriteError(joined(name_, ": ", reason));
}

void H5File::set_attribute(hid_t object, const char* name, const std::string& text) {
    const hid_t type = check(H5Tcopy(H5T_C_S1)), space = check(H5Screate(H5S_SCALAR));
    check(H5Tset_size(type, H5T_VARIABLE));
    check(H5Tset_cset(type, H5T_CSET_UTF8));
    const hid_t attribute = check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
    const char* const data = text.c_str();
    check(H5Awrite(attribute, type, &data));
    check(H5Aclose(attribute));
    H5Sclose(space);
    H5Tclose(type);
}

void H5File::set_attribute(hid_t object, const char* name, double value) {
    const hid_t space = check(H5Screate(H5S_SCALAR));
    const hid_t attribute = check(H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT));
    check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value));
    check(H5Aclose(attribute));
    H5Sclose(space);
}

hid_t H5File::dataset_properties() {
    const hid_t properties = check(H5Pcreate(H5P_DATASET_CREATE));
    check(H5Pset_obj_track_times(properties, false));
    return properties;
}

hid_t H5File::filters(const std::vector<hsize_t>& chunk) {
    const hid_t properties = dataset_properties();
    check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()));
    check(H5Pset_shuffle(properties));
    check(H5Pset_deflate(properties, kDeflateLevel));
    return properties;
}

hid_t H5File::make_growing(const char* name, hid_t type, std::vector<hsize_t> shape,
                           std::vector<hsize_t> chunk) {
    std::vector<hsize_t> limit = shape;
    for (std::size_t i = 0; i < shape.size(); ++i)
        if (i == 0 || shape[i] == 0)
            limit[i] = H5S_UNLIMITED;  // a chunk is never wider than a fixed dimension
    shape[0] = 0;
    const hid_t space = check(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), limit.data()));
    const hid_t properties = filters(chunk);
    const hid_t dataset = check(H5Dcreate2(file_, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    H5Pclose(properties);
    H5Sclose(space);
    return dataset;
}

hid_t H5File::make_column(const char* name, const std::vector<double>& values) {
    constexpr hsize_t kLargestChunk = 65536;  // elements: 512 KiB
    const hsize_t size = values.size();
    const hid_t space = check(H5Screate_simple(1, &size, nullptr));
    const hid_t properties = size > 0 ? filters({std::min(size, kLargestChunk)}) : dataset_properties();
    const hid_t dataset =
        check(H5Dcreate2(file_, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT));
    if (size > 0) check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    H5Pclose(properties);
    H5Sclose(space);
    return dataset;
}

void H5File::set_extent(hid_t dataset, const std::vector<hsize_t>& shape) {
    silence_hdf5();
    check(H5Dset_extent(dataset, shape.data()));
}

void H5File::write_chunk(hid_t dataset, const std::vector<hsize_t>& offset,
                         std::span<const std::byte> bytes) {
    constexpr std::uint32_t kAllFiltersApplied = 0;
    check(
        H5Dwrite_chunk(dataset, H5P_DEFAULT, kAllFiltersApplied, offset.data(), bytes.size(), bytes.data()));
}

void H5File::append(hid_t dataset, hsize_t first, std::span<const double> values) {
    const hsize_t count = values.size();
    set_extent(dataset, {first + count});
    const hid_t file_space = check(H5Dget_space(dataset)),
                memory_space = check(H5Screate_simple(1, &count, nullptr));
    check(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, &first, nullptr, &count, nullptr));
    check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory_space, file_space, H5P_DEFAULT, values.data()));
    H5Sclose(memory_space);
    H5Sclose(file_space);
}

void H5File::close_dataset(hid_t dataset) {
    check(H5Dclose(dataset));
}

void H5File::close() {
    check(H5Fflush(file_, H5F_SCOPE_LOCAL));
    check(H5Fclose(file_));
    file_ = H5I_INVALID_HID;
}

}  // namespace carom::tool
