#include "report/kinds/kinds.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "report/readers/json_text.hpp"

namespace carom::report {
namespace {

namespace fs = std::filesystem;

struct Kind {
    std::string_view name;
    void (*draw)(const Result&, Page&);                                  ///< one after the other, or null:
    void (*draw_together)(const std::vector<Result>&, Page&) = nullptr;  ///< side by side
};

constexpr std::array kKinds{
    Kind{"run", &draw_run},
    Kind{"scaling", nullptr, &draw_scaling},
    Kind{"kernels", nullptr, &draw_kernels},
    Kind{"stages", nullptr, &draw_stages},
    Kind{"scenes", nullptr, &draw_scenes},
    Kind{"peers", nullptr, &draw_peers},
    Kind{"profile", nullptr, &draw_profile},
    Kind{"prices", nullptr, &draw_prices},
    Kind{"accuracy", &draw_accuracy},
    Kind{"torture", &draw_torture},
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
        result.json = parse_json(file);
    } catch (const Json::parse_error&) {
        refuse(result.file, "is no JSON; expected a result file that the program wrote");
    } catch (const Json::out_of_range& error) {
        refuse(result.file, std::string("is not as its kind should be: ") + error.what());
    }
    return result;
}

const Kind& kind_of(const Result& result) {
    const auto kind = result.json.is_object() ? result.json.find("kind") : result.json.end();
    if (kind == result.json.end() || !kind->is_string())
        refuse(result.file, "has no \"kind\" at its top level; expected one of " + known_kinds());
    for (const Kind& known : kKinds)
        if (known.name == kind->get_ref<const std::string&>()) return known;
    refuse(result.file, "has the kind " + kind->dump(-1, ' ', true, Json::error_handler_t::replace) +
                            ", which cannot be drawn; expected one of " + known_kinds());
}

/// Draws what is one kind.
void draw(const Kind& kind, const std::vector<Result>& results, Page& page) {
    const fs::path* file = &results.front().file;
    try {
        if (kind.draw_together) return kind.draw_together(results, page);
        for (const Result& result : results) {
            file = &result.file;
            kind.draw(result, page);
        }
    } catch (const Json::exception& error) {
        refuse(*file, std::string("is not as its kind should be: ") + error.what());
    }
}

}  // namespace

Page page_of(const std::vector<fs::path>& files, std::size_t page_bytes) {
    std::vector<std::pair<const Kind*, std::vector<Result>>> by_kind;  // in the order they were named
    for (const fs::path& file : files) {
        Result result = read_result(file, page_bytes);
        const Kind* const kind = &kind_of(result);
        const auto is_same = [kind](const auto& each) { return each.first == kind; };
        auto place = std::find_if(by_kind.begin(), by_kind.end(), is_same);
        if (place == by_kind.end()) place = by_kind.insert(by_kind.end(), {kind, {}});
        place->second.push_back(std::move(result));
    }
    Page page("Results");
    for (const auto& [kind, results] : by_kind) {
        if (kind->name == "run" && results.size() > 1)
            refuse(results[1].file,
                   "is a second run; a page has one player, so draw each run as a page of its own");
        Page section{std::string(kind->name)};
        draw(*kind, results, section);
        if (by_kind.size() == 1) return section;
        page.append(std::move(section), std::string(kind->name) + "-");
    }
    return page;
}

}  // namespace carom::report
