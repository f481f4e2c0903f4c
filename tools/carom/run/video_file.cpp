#include "video_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

extern char** environ;

namespace carom::tool {
namespace {

namespace fs = std::filesystem;

/// Starts ffmpeg with the read end of a pipe as its standard input.
int start(const std::vector<std::string>& arguments, int input, pid_t& process) {
    std::vector<char*> words;
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    const int error = posix_spawnp(&process, words[0], &actions, nullptr, words.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

}  // namespace

bool VideoFile::is_possible() {
    const char* const path = std::getenv("PATH");
    std::string folder;
    for (const char* c = path != nullptr ? path : "";; ++c) {
        if (*c != ':' && *c != '\0') {
            folder += *c;
            continue;
        }
        if (::access((folder + "/ffmpeg").c_str(), X_OK) == 0) return true;
        folder.clear();
        if (*c == '\0') return false;
    }
}

VideoFile::VideoFile(fs::path path, int width, int height, double frames_a_second)
    : path_(std::move(path)), temporary_(path_.string() + ".part") {
    ::signal(SIGPIPE, SIG_IGN);  // an ffmpeg that ended early is an error of the write
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw OutputError(joined("--video: ", std::strerror(errno)));
    const int error = start({"ffmpeg",
                             "-loglevel",
                             "error",
                             "-nostdin",
                             "-y",
                             "-f",
                             "rawvideo",
                             "-pixel_format",
                             "bgr0",
                             "-video_size",
                             format("%dx%d", width, height),
                             "-framerate",
                             format("%g", frames_a_second),
                             "-i",
                             "pipe:0",
                             "-pix_fmt",
                             "yuv420p",
                             "-f",
                             "mp4",
                             "file:" + temporary_.string()},
                            ends[0], ffmpeg_);
    ::close(ends[0]);
    pipe_ = ends[1];
    if (error == 0) return;
    ::close(pipe_);
    throw OutputError(joined("--video: ffmpeg cannot be started: ", std::strerror(error)));
}

VideoFile::~VideoFile() {
    if (pipe_ < 0) return;
    ::close(pipe_);
    ::waitpid(ffmpeg_, nullptr, 0);
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void VideoFile::append(std::span<const unsigned char> pixels) {
    while (!pixels.empty()) {
        const ssize_t written = ::write(pipe_, pixels.data(), pixels.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw OutputError(joined(path_.string(), ": ffmpeg ended early; it said why"));
        pixels = pixels.subspan(static_cast<std::size_t>(written));
    }
}

void VideoFile::close() {
    ::close(pipe_);
    pipe_ = -1;
    int status = 0;
    ::waitpid(ffmpeg_, &status, 0);
    std::error_code error;
    if (status == 0) fs::rename(temporary_, path_, error);
    if (status == 0 && !error) return;
    const std::string reason = error ? error.message() : "ffmpeg could not write it and said why";
    fs::remove(temporary_, error);
    throw OutputError(joined(path_.string(), ": ", reason));
}

}  // namespace carom::tool
