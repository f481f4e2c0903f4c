// Whatever the bytes: the reader either gives a scene that is sound, or throws SceneFileError with a message
// that is short, printable and names the file. Nothing else may happen.

#include "scene_file/scene_reader.hpp"

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

using namespace carom;

/// Small, so that a run is quick; the limits themselves are tested in tests/interface.
constexpr tool::SceneFileLimits kLimits{
    .file_bytes = 1 << 16, .depth = 16, .values = 4000, .body_bytes = 3000 * sizeof(Body)};
constexpr std::size_t kLongestMessage = 2000;

void require(bool holds) {
    if (!holds) std::abort();
}

bool is_printable(std::string_view text) {
    for (const char c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
    return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(data, data + size);
    try {
        const Scene scene = tool::parse_scene(text, "fuzz.json", kLimits);
        require(!scene.find_problem().has_value());
        require(scene.bodies.size() <= 3000);
    } catch (const tool::SceneFileError& error) {
        const std::string_view message = error.what();
        require(message.starts_with("fuzz.json: "));
        require(message.size() <= kLongestMessage);
        require(is_printable(message));
    }
    return 0;
}
