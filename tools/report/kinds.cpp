#include "report/kinds.hpp"

#include <array>
#include <fstream>
#include <string>
#include <string_view>

namespace carom::report {
namespace {

namespace fs = std::filesystem;

struct Kind {
    std::string_view name;
    void (*draw)(const Result&, Page&);
};

constexpr std::array kKinds{
    Kind{"run", &draw_run},
};

std::string known_kinds() {
    std::string names;
    for (const Kind& kind : kKinds) {
        if (!names.empty()) names += ", ";
        names += kind.name;
    }
    return names;
}

[[noreturn]] void refuse(const fs::path& file, const std::string& statement) {
    throw ResultError(file.string() + ": " + statement);
}

Result read_result(const fs::path& path, std::size_t page_bytes) {
    std::error_code ignored;
    const bool is_folder = fs::is_directory(path, ignored);
    Result result{.file = is_folder ? path / "summary.json" : path, .json = {}, .page_bytes = page_bytes};
    std::ifstream file(result.file, std::ios::binary);
    if (!file)
        refuse(result.file,
               is_folder ? "cannot be read; expected the folder of a finished run" : "cannot be read");
    try {
        result.json = Json::parse(file);
    } catch (const Json::parse_error&) {
        refuse(result.file, "is no JSON; expected a result file that the program wrote");
    }
    return result;
}

void draw(const Result& result, Page& page) {
    const auto kind = result.json.is_object() ? result.json.find("kind") : result.json.end();
    if (kind == result.json.end() || !kind->is_string())
        refuse(result.file, "has no \"kind\" at its top level; expected one of " + known_kinds());
    for (const Kind& known : kKinds) {
        if (known.name != kind->get_ref<const std::string&>()) continue;
        try {
            return known.draw(result, page);
        } catch (const Json::exception& error) {
            refuse(result.file, std::string("is not as its kind should be: ") + error.what());
        }
    }
    refuse(result.file, "has the kind " + kind->dump(-1, ' ', true, Json::error_handler_t::replace) +
                            ", which cannot be drawn; expected one of " + known_kinds());
}

}  // namespace

Page page_of(const std::vector<fs::path>& files, std::size_t page_bytes) {
    Page page("Carom");
    for (const fs::path& file : files) draw(read_result(file, page_bytes), page);
    return page;
}

}  // namespace carom::report
