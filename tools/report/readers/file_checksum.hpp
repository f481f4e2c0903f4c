#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "report/page/markup.hpp"

namespace carom::report {

/// What tells a file that was damaged from the one that was written. HDF5 trusts what it reads: bytes that
/// were changed can crash it, so they are found before it sees them.
struct FileChecksum {
    std::uintmax_t bytes = 0;
    std::uint32_t crc32 = 0;  ///< of all bytes (ISO-HDLC, as zlib has it): shows whatever damages 4 bytes in
                              ///< a row, other damage but once in 2^32

    friend bool operator==(const FileChecksum&, const FileChecksum&) = default;
};

/// Nothing if the file cannot be read. Cost: it is read once, at about 1 GB/s from memory.
std::optional<FileChecksum> checksum_of(const std::filesystem::path& path);

/// As summary.json has it: {"bytes": 26792, "crc32": "1a2b3c4d"}.
Json json_of(const FileChecksum& checksum);

/// @param folder  of a run
/// @param summary  of it; where it has no checksum of the file, as those of earlier versions, all is well
/// @throws ResultError naming the file, if it is another one than the run wrote
void check_file(const std::filesystem::path& folder, const std::string& name, const Json& summary);

}  // namespace carom::report
