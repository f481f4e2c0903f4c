#pragma once

#include <sys/types.h>

#include <filesystem>
#include <span>

namespace carom::tool {

/// A video written by the program ffmpeg, which gets the pictures through a pipe. Under a temporary name
/// until `close`.
class VideoFile {
  public:
    /// Whether ffmpeg is on the path.
    static bool is_possible();

    /// @throws OutputError if ffmpeg cannot be started.
    VideoFile(std::filesystem::path path, int width, int height, double frames_a_second);
    /// Ends ffmpeg and removes what is not finished.
    ~VideoFile();
    VideoFile(const VideoFile&) = delete;
    VideoFile& operator=(const VideoFile&) = delete;

    /// @param pixels  rows from the top, blue, green, red, unused. @throws OutputError
    void append(std::span<const unsigned char> pixels);
    /// @throws OutputError if ffmpeg says that it failed.
    void close();

  private:
    std::filesystem::path path_, temporary_;
    int pipe_ = -1;
    pid_t ffmpeg_ = -1;
};

}  // namespace carom::tool
