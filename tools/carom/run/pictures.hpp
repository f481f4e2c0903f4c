#pragma once

#include <filesystem>
#include <optional>

#include "report/frames/picture.hpp"

namespace CLI {
class App;
}

namespace carom::tool {

/// Pictures of a run that the command line asks for.
struct PictureChoices {
    std::optional<std::filesystem::path> frames;   ///< folder of a picture for each frame
    std::optional<std::filesystem::path> video;    ///< by ffmpeg, as fast as the scene itself
    std::optional<std::filesystem::path> picture;  ///< one frame ...
    std::optional<double> picture_time;            ///< ... at this time [s]; else the last

    int width = report::kPictureWidth;  ///< pixels

    bool any() const { return frames || video || picture; }
};

/// Adds --frames, --video, --picture, --picture-time.
void add_picture_options(CLI::App& command, PictureChoices& choices);

/// @throws UsageError for what cannot be made: no trajectory, no ffmpeg. Called before the run.
void check_pictures(const PictureChoices& choices, bool no_trajectory);

/// Draws them from the trajectory. @throws OutputError
void write_pictures(const PictureChoices& choices, const std::filesystem::path& trajectory_h5);

}  // namespace carom::tool
