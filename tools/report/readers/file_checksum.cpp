#include "report/readers/file_checksum.hpp"

#include <zlib.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <vector>

#include "report/readers/result_error.hpp"

namespace carom::report {

std::optional<FileChecksum> checksum_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    FileChecksum checksum;
    uLong sum = crc32(0, nullptr, 0);
    std::vector<char> block(1 << 18);
    while (file) {
        file.read(block.data(), static_cast<std::streamsize>(block.size()));
        const auto count = static_cast<std::size_t>(file.gcount());
        sum = crc32_z(sum, reinterpret_cast<const Bytef*>(block.data()), count);
        checksum.bytes += count;
    }
    if (!file.eof()) return std::nullopt;
    checksum.crc32 = static_cast<std::uint32_t>(sum);
    return checksum;
}

Json json_of(const FileChecksum& checksum) {
    std::array<char, 9> text{};
    std::snprintf(text.data(), text.size(), "%08x", static_cast<unsigned>(checksum.crc32));
    return {{"bytes", checksum.bytes}, {"crc32", text.data()}};
}

void check_file(const std::filesystem::path& folder, const std::string& name, const Json& summary) {
    const auto checksums = summary.find("checksums");
    if (checksums == summary.end() || !checksums->contains(name)) return;
    const std::filesystem::path path = folder / name;
    const std::optional<FileChecksum> found = checksum_of(path);
    if (!found) throw ResultError(path.string() + ": cannot be read");
    if (json_of(*found) != checksums->at(name))
        throw ResultError(path.string() + ": is not the file that the run wrote: it has " +
                          std::to_string(found->bytes) +
                          " bytes, and its CRC-32 is not the one in summary.json. Run the scene again; if it "
                          "was changed on purpose, take its entry out of \"checksums\" there.");
}

}  // namespace carom::report
