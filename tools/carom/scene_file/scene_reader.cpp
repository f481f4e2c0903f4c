#include "scene_reader.hpp"

#include "json_text.hpp"
#include "parts.hpp"
#include "printable.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <memory>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

namespace carom::tool {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 20;  // at a time

std::string joined(std::string_view file, std::string_view pointer, std::string_view statement) {
    std::string text(file);
    if (!pointer.empty()) text.append(": ").append(pointer);
    return printable(text.append(": ").append(statement));
}

/// Where the bodies and joints of the file's generators begin.
struct Origins {
    std::size_t listed = 0, listed_joints = 0;  // bodies of "bodies", joints of "joints"
    std::vector<std::size_t> ends, joint_ends;  // one after the last of each generator
};

/// The problem of a scene as one of its file: what is made by a generator is the generator's.
[[noreturn]] void fail_scene(const Node& root, const Origins& origins, const Problem& found) {
    for (const bool of_joints : {false, true}) {
        const std::string_view items = of_joints ? "/joints/" : "/bodies/";
        if (!found.pointer.starts_with(items)) continue;
        const std::vector<std::size_t>& ends = of_joints ? origins.joint_ends : origins.ends;
        std::size_t item = 0;
        std::from_chars(found.pointer.data() + items.size(), found.pointer.data() + found.pointer.size(),
                        item);
        if (item < (of_joints ? origins.listed_joints : origins.listed)) break;
        const auto generator = std::upper_bound(ends.begin(), ends.end(), item) - ends.begin();
        root.fail_at(
            "/generate/" + std::to_string(generator), found.code,
            std::string(of_joints ? "of the joints" : "of the bodies") + " made here, " + found.statement);
    }
    root.fail_at(found.pointer, found.code, found.statement);
}

void check(const Node& root, const Origins& origins, const Scene& scene) {
    if (const auto found = scene.find_problem()) fail_scene(root, origins, *found);
}

Scene read_document(const Node& root, const SceneFileLimits& limits) {
    if (!root.json().is_object()) root.fail_type("a scene, {\"carom\": 1, ...}");
    Scene scene;
    const Materials materials = read_settings(root, scene);
    read_bodies(root, materials, scene);
    Origins origins;
    origins.listed = scene.bodies.size();
    check(root, origins, scene);
    if (const auto generators = root.find("generate")) {
        generators->expect_array("generators");
        for (std::size_t i = 0; i < generators->size(); ++i) {
            read_generator((*generators)[i], materials, limits, scene);
            origins.ends.push_back(scene.bodies.size());
            origins.joint_ends.push_back(scene.joints.size());
        }
    }
    const std::size_t made = scene.joints.size();
    read_joints(root, scene);
    origins.listed_joints = scene.joints.size() - made;
    for (std::size_t& end : origins.joint_ends) end += origins.listed_joints;
    check(root, origins, scene);
    return scene;
}

[[noreturn]] void fail_file(ErrorCode code, const std::string& name, const std::string& statement) {
    throw SceneFileError(code, name, "", statement);
}

std::string size_words(const SceneFileLimits& limits) {
    return "the file is larger than the limit of " + std::to_string(limits.file_bytes) +
           " bytes; let \"generate\" make the bodies.";
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// Reads up to one byte more than the limit, so that also what has no size of its own (a pipe) ends
/// somewhere.
std::string read_text(const std::filesystem::path& path, const SceneFileLimits& limits) {
    const std::string name = path.string();
    std::error_code no_status;
    if (std::filesystem::is_directory(path, no_status))
        fail_file(ErrorCode::unreadable, name, "this is a folder; expected a scene file.");
    const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(name.c_str(), "rb"));
    if (!file)
        fail_file(ErrorCode::unreadable, name,
                  "the file cannot be opened: " + std::generic_category().message(errno) + ".");
    std::string text;
    std::size_t got = kReadBytes;
    while (got == kReadBytes) {
        const std::size_t before = text.size();
        text.resize(before + kReadBytes);
        got = std::fread(text.data() + before, 1, kReadBytes, file.get());
        text.resize(before + got);
        if (text.size() > limits.file_bytes) fail_file(ErrorCode::too_large, name, size_words(limits));
    }
    if (std::ferror(file.get()) != 0)
        fail_file(ErrorCode::unreadable, name,
                  "the file cannot be read: " + std::generic_category().message(errno) + ".");
    return text;
}

}  // namespace

SceneFileError::SceneFileError(ErrorCode code, std::string file, std::string pointer,
                               const std::string& statement)
    : Error(code, joined(file, pointer, statement)), file_(std::move(file)), pointer_(std::move(pointer)) {}

Scene parse_scene(std::string_view text, std::string_view source_name, const SceneFileLimits& limits) {
    const std::string name(source_name);
    if (text.size() > limits.file_bytes) fail_file(ErrorCode::too_large, name, size_words(limits));
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        fail_file(ErrorCode::malformed, name, "the file is empty; expected a scene, {\"carom\": 1, ...}.");
    try {
        const nlohmann::json document = parse_json(text, name, limits);
        return read_document(Node(document, name), limits);
    } catch (const std::bad_alloc&) {
        fail_file(ErrorCode::too_large, name,
                  "there is not enough memory for this scene. Make fewer bodies.");
    }
}

Scene read_scene(const std::filesystem::path& path, const SceneFileLimits& limits) {
    return parse_scene(read_text(path, limits), path.string(), limits);
}

}  // namespace carom::tool
