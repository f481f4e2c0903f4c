// Whatever is in a file that `carom report` reads: the page is drawn, or ResultError says which file cannot
// be read and why, in a line. The first byte says which file of a run the others stand for; the rest of the
// run is whole, in corpus/result_files as it was written.

#include "report/kinds/kinds.hpp"

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <span>
#include <streambuf>
#include <string>
#include <string_view>

#include "requirement.hpp"

namespace {

namespace fs = std::filesystem;
using carom::fuzz::require;

constexpr std::size_t kLongestMessage = 2000;
constexpr std::size_t kPageBytes = 2'000'000;

/// Takes what is written and keeps nothing.
class Nowhere : public std::streambuf {
    int overflow(int c) override { return traits_type::not_eof(c); }
    std::streamsize xsputn(const char*, std::streamsize count) override { return count; }
};

/// The folder of a run, for this process.
class RunFolder {
  public:
    RunFolder() : path_(fs::temp_directory_path() / ("carom_fuzz_" + std::to_string(getpid()))) {
        fs::create_directories(path_);
        for (const Part& part : kParts) {
            std::ifstream file(fs::path(CAROM_FUZZ_CORPUS) / part.whole, std::ios::binary);
            require(file.get() == part.letter, "the kept run is there");
            std::string text((std::istreambuf_iterator<char>(file)), {});
            write(path_ / part.name, text);
            whole_.push_back(std::move(text));
        }
    }
    ~RunFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }

    /// The file to draw, with `bytes` in place of a part of the run, or alone.
    fs::path with(char letter, std::string_view bytes) {
        for (std::size_t i = 0; i < std::size(kParts); ++i)
            if (kParts[i].letter == letter) {
                write(path_ / kParts[i].name, bytes);
                replaced_ = i;
                return path_ / "summary.json";
            }
        write(path_ / "alone.json", bytes);
        return path_ / "alone.json";
    }
    void mend() {
        if (replaced_ < std::size(kParts)) write(path_ / kParts[replaced_].name, whole_[replaced_]);
        replaced_ = std::size(kParts);
    }

  private:
    struct Part {
        char letter;
        const char *name, *whole;
    };
    static constexpr Part kParts[] = {{'s', "summary.json", "whole-summary.input"},
                                      {'f', "final.csv", "whole-final.input"},
                                      {'l', "ledger.csv", "whole-ledger.input"},
                                      {'t', "trajectory.h5", "whole-trajectory.input"}};

    static void write(const fs::path& path, std::string_view bytes) {
        std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }

    fs::path path_;
    std::vector<std::string> whole_;
    std::size_t replaced_ = std::size(kParts);
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static RunFolder folder;
    if (size == 0) return 0;
    const std::string bytes(data, data + size);
    const fs::path file = folder.with(bytes[0], std::string_view(bytes).substr(1));
    Nowhere nowhere;
    std::ostream out(&nowhere);
    try {
        carom::report::page_of({file}, kPageBytes).write(out);
    } catch (const carom::report::ResultError& error) {
        const std::string_view message = error.what();
        require(message.starts_with(file.parent_path().string()), "messages name the file");
        require(message.size() <= kLongestMessage, "messages are short");
        for (const char c : message)
            require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f, "messages are one line");
    }
    folder.mend();
    return 0;
}
