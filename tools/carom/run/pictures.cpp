#include "pictures.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "report/frames/picture.hpp"
#include "report/kinds/kinds.hpp"
#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"
#include "terminal/option_values.hpp"
#include "video_file.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;

constexpr double kFramesASecond = 30;                     // of a video
constexpr std::int64_t kNarrowest = 100, kWidest = 8000;  // pixels

void write_frames(const fs::path& folder, report::Picture& picture) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw OutputError(joined(folder.string(), ": ", error.message()));
    for (std::size_t frame = 0; frame < picture.frame_count(); ++frame) {
        picture.draw(frame);
        picture.write_png(folder / format("frame-%06zu.png", frame));
    }
}

/// A second of the video is a second of the scene.
void write_video(const fs::path& path, report::Picture& picture) {
    VideoFile video(path, picture.width(), picture.height(), kFramesASecond);
    const double begin = picture.time(0), end = picture.time(picture.frame_count() - 1);
    const auto last = static_cast<std::int64_t>((end - begin) * kFramesASecond);
    for (std::int64_t i = 0; i <= last; ++i) {
        picture.draw(picture.frame_at(begin + static_cast<double>(i) / kFramesASecond));
        video.append(picture.pixels());
    }
    video.close();
}

}  // namespace

void add_picture_options(CLI::App& command, PictureChoices& choices) {
    command.add_option("--frames", choices.frames, "Folder for a PNG picture of every recorded frame")
        ->type_name("DIR");
    command.add_option("--video", choices.video, "A video of the scene, made by ffmpeg")
        ->type_name("FILE.mp4");
    command.add_option("--picture", choices.picture, "A PNG picture of the last frame")
        ->type_name("FILE.png");
    command
        .add_option_function<std::string>(
            "--picture-time",
            [&choices](const std::string& text) {
                choices.picture_time = real_number("--picture-time", text);
            },
            "The picture shows the frame at this time in seconds")
        ->type_name("S");
    command
        .add_option_function<std::string>(
            "--picture-width",
            [&choices](const std::string& text) {
                choices.width =
                    static_cast<int>(whole_number("--picture-width", text, kNarrowest, kWidest) / 2 * 2);
            },
            "Pixels of all pictures' width (default: 960)")
        ->type_name("PX");
}

void check_pictures(const PictureChoices& choices, bool no_trajectory) {
    if (choices.any() && no_trajectory)
        throw UsageError(
            "--frames, --video and --picture are drawn from the trajectory, and --no-trajectory leaves it "
            "out");
    if (choices.picture_time && !choices.picture)
        throw UsageError("--picture-time: there is no --picture that it could be the time of");
    if (choices.video && !VideoFile::is_possible())
        throw UsageError("--video: the program ffmpeg is not installed; --frames makes pictures without it");
}

void write_pictures(const PictureChoices& choices, const fs::path& trajectory_h5) {
    if (!choices.any()) return;
    try {
        report::Picture picture(trajectory_h5, choices.width);
        if (choices.frames) write_frames(*choices.frames, picture);
        if (choices.video) write_video(*choices.video, picture);
        if (!choices.picture) return;
        picture.draw(choices.picture_time ? picture.frame_at(*choices.picture_time)
                                          : picture.frame_count() - 1);
        picture.write_png(*choices.picture);
    } catch (const report::ResultError& error) {
        throw OutputError(error.what());
    }
}

}  // namespace carom::tool
