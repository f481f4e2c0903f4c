#pragma once

#include "scene_file/scene_reader.hpp"

#include <doctest/doctest.h>

#include <string>

namespace carom::test {

/// Checks that a scene file is refused: with that code, at that place, with those words in the message.
/// @param pointer  JSON pointer
inline void check_refused_scene(const std::string& text, ErrorCode code, const std::string& pointer,
                                const std::string& words) {
    CAPTURE(text);
    try {
        tool::parse_scene(text, "test.json");
        FAIL_CHECK("it is read");
    } catch (const tool::SceneFileError& error) {
        CAPTURE(error.what());
        CHECK(error.code() == code);
        CHECK(error.pointer() == pointer);
        CHECK(std::string(error.what()).find(words) != std::string::npos);
    }
}

}  // namespace carom::test
