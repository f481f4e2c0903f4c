#include "results/page_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "results/whole_file.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path) {
    throw WriteError(joined(path.string(), ": ", std::strerror(errno)));
}

}  // namespace

void write_page_to(const fs::path& path, const report::Page& page) {
    std::ofstream file(path, std::ios::binary);
    if (!file) fail(path);
    page.write(file);
    file.close();
    if (!file) fail(path);
}

void write_page(const fs::path& path, const report::Page& page) {
    write_then_rename(path, [&](const fs::path& temporary) { write_page_to(temporary, page); });
}

}  // namespace carom::tool
