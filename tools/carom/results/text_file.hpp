#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace carom::tool {

/// A text file written from start to end; every error of the system becomes a WriteError.
class TextFile {
  public:
    explicit TextFile(const std::filesystem::path& path);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    void write(std::string_view text);
    /// Hands everything to the system; nothing can be written afterwards.
    void close();

  private:
    [[noreturn]] void fail();

    std::string name_;
    std::FILE* file_;
};

/// Appends the shortest text that reads back as the same double ("nan" and "inf" included).
void append_number(std::string& line, double value);

/// Appends a CSV field, in quotes if it has to be (RFC 4180).
void append_field(std::string& line, std::string_view text);

}  // namespace carom::tool
