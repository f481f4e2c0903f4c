#include "results/whole_file.hpp"

#include "results/text_file.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::tool {

namespace fs = std::filesystem;

void write_then_rename(const fs::path& path, const std::function<void(const fs::path&)>& write) {
    const fs::path temporary = joined(path.string(), ".part");
    std::error_code error;
    try {
        write(temporary);
        fs::rename(temporary, path, error);
        if (error) throw WriteError(joined(path.string(), ": ", error.message()));
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
}

void write_whole_file(const fs::path& path, std::string_view text) {
    write_then_rename(path, [&](const fs::path& temporary) {
        TextFile file(temporary);
        file.write(text);
        file.close();
    });
}

}  // namespace carom::tool
