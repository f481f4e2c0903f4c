#include "results/result_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

namespace fs = std::filesystem;

// What a run may leave in a folder; a file of these names from an earlier run does not outlive the next one.
constexpr std::array<std::string_view, 6> kResultFiles{"summary.json", "final.csv",     "ledger.csv",
                                                       "events.csv",   "trajectory.h5", "report.html"};
constexpr std::string_view kSummary = "summary.json";
constexpr std::string_view kTemporarySuffix = ".part";

[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
    throw UsageError(joined("output folder \"", path.string(), "\": ", reason,
                            ". Name another one with --out. Nothing was written."));
}

}  // namespace

ResultFolder::ResultFolder(fs::path path) : path_(std::move(path)) {
    try {
        make_folders();
        lock();
        check_writable();
    } catch (...) {
        if (lock_ >= 0) ::close(lock_);
        remove_made_folders();
        throw;
    }
}

ResultFolder::~ResultFolder() {
    if (!committed_) {
        std::error_code ignored;
        for (const std::string& name : names_) fs::remove(path_ / joined(name, kTemporarySuffix), ignored);
        remove_made_folders();
    }
    ::close(lock_);
}

void ResultFolder::make_folders() {
    std::error_code error;
    if (path_.empty()) refuse(path_, "is no name");
    std::vector<fs::path> missing;
    for (fs::path folder = path_; !folder.empty() && !fs::exists(folder, error);
         folder = folder.parent_path()) {
        if (folder.has_filename()) missing.push_back(folder);
        if (folder == folder.parent_path()) break;
    }
    std::reverse(missing.begin(), missing.end());
    for (const fs::path& folder : missing) {
        if (fs::create_directory(folder, error)) made_.push_back(folder);
        if (error) refuse(path_, joined("cannot make \"", folder.string(), "\": ", error.message()));
    }
    if (!fs::is_directory(path_, error)) refuse(path_, error ? error.message() : "is not a folder");
}

void ResultFolder::lock() {
    lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock_ < 0) refuse(path_, std::strerror(errno));
    // File systems without locks are fine: the lock only guards against a mistake.
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        refuse(path_, "another run is writing to it");
}

/// By writing a file there: permission bits do not tell about read-only mounts, quotas and the like.
void ResultFolder::check_writable() {
    for (const std::string_view name : kResultFiles) {
        std::error_code error;
        fs::remove(path_ / joined(name, kTemporarySuffix), error);  // of a run that was killed
        if (fs::is_directory(path_ / name, error)) refuse(path_, joined("\"", name, "\" in it is a folder"));
    }
    const fs::path probe = path_ / joined("probe", kTemporarySuffix);
    ::unlink(probe.c_str());
    const int file = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) refuse(path_, joined("cannot write a file there: ", std::strerror(errno)));
    ::close(file);
    ::unlink(probe.c_str());
}

void ResultFolder::remove_made_folders() noexcept {
    for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder)
        if (::rmdir(folder->c_str()) != 0) return;
}

fs::path ResultFolder::temporary(std::string_view name) {
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.emplace_back(name);
    return path_ / joined(name, kTemporarySuffix);
}

void ResultFolder::commit() {
    for (const std::string_view name : kResultFiles) {
        std::error_code ignored;
        const bool replaced = std::find(names_.begin(), names_.end(), name) != names_.end();
        if (!replaced || name == kSummary) fs::remove(path_ / name, ignored);
    }
    for (const std::string& name : names_)
        if (name != kSummary) rename(name);
    rename(std::string(kSummary));
    committed_ = true;
}

void ResultFolder::rename(const std::string& name) {
    std::error_code error;
    fs::rename(temporary(name), path_ / name, error);
    if (error) throw WriteError(joined((path_ / name).string(), ": ", error.message()));
}

}  // namespace carom::tool
