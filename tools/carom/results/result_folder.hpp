#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace carom::tool {

/// The output folder of a run. Files are written under temporary names (`summary.json.part`) and get their
/// own only when all of them are complete; a run that fails leaves the folder as it was.
class ResultFolder {
  public:
    /// Makes the folder if need be, and locks it against a second run writing there.
    /// @throws UsageError if it cannot be made or written to, or is in use.
    explicit ResultFolder(std::filesystem::path path);
    /// Removes what was not committed, and the folders it made if they are empty.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Where the file of that name is to be written until `commit`.
    std::filesystem::path temporary(std::string_view name);
    /// Renames all temporary files, summary.json last, and removes result files of an earlier run that this
    /// one does not have: where there is a summary, the files beside it belong to it.
    /// @throws WriteError
    void commit();
    /// Names given to `temporary`, in that order.
    const std::vector<std::string>& names() const { return names_; }

  private:
    void make_folders();
    void lock();
    void check_writable();
    void rename(const std::string& name);
    void remove_made_folders() noexcept;

    std::filesystem::path path_;
    std::vector<std::filesystem::path> made_;  // outermost first
    std::vector<std::string> names_;
    bool committed_ = false;
    int lock_ = -1;
};

}  // namespace carom::tool
