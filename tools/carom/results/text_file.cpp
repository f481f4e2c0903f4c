#include "results/text_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "terminal/exit_codes.hpp"
#include "terminal/format.hpp"

namespace carom::tool {

TextFile::TextFile(const std::filesystem::path& path)
    : name_(path.string()), file_(std::fopen(path.c_str(), "we")) {
    if (file_ == nullptr) fail();
}

TextFile::~TextFile() {
    if (file_ != nullptr) std::fclose(file_);
}

void TextFile::write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail();
}

void TextFile::close() {
    std::FILE* const file = file_;
    file_ = nullptr;
    if (std::fclose(file) != 0) fail();
}

void TextFile::fail() {
    throw WriteError(joined(name_, ": ", std::strerror(errno)));
}

void append_number(std::string& line, double value) {
    std::array<char, 32> text;  // the longest is "-2.2250738585072014e-308"
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    line.append(text.data(), end);
}

void append_field(std::string& line, std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
        line += text;
        return;
    }
    line += '"';
    for (const char c : text) {
        if (c == '"') line += '"';
        line += c;
    }
    line += '"';
}

}  // namespace carom::tool
