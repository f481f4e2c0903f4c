#pragma once

#include <carom/errors.hpp>

#include <cstddef>
#include <string>
#include <string_view>

namespace carom::tool {

/// What is wrong with a text that is not JSON, in words for a text that was written by hand.
struct SyntaxHint {
    ErrorCode code;
    std::string statement;
};

/// @param position   bytes the parser has read
/// @param token      what it read last
/// @param complaint  the parser's own words
/// @param id         the parser's number of that error; 406 is a number too large for a double
SyntaxHint explain_syntax_error(std::string_view text, std::size_t position, std::string_view token,
                                std::string_view complaint, int id);

}  // namespace carom::tool
