#include "scene_file/nearest_name.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "scene_file/lower.hpp"

namespace carom::tool {
namespace {

constexpr std::size_t kLongest = 64;     // letters compared
constexpr std::size_t kMostListed = 20;  // names in a message

bool same(char a, char b) {
    return lower(a) == lower(b);
}

/// Damerau-Levenshtein distance with adjacent swaps (optimal string alignment), by rows.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    a = a.substr(0, kLongest);
    b = b.substr(0, kLongest);
    using Row = std::array<std::size_t, kLongest + 1>;
    Row two_above{}, above{}, row{};
    for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = same(a[i - 1], b[j - 1]) ? 0 : 1;
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + change});
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                row[j] = std::min(row[j], two_above[j - 2] + 1);
        }
        two_above = above;
        above = row;
    }
    return above[b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view wanted, std::span<const std::string_view> known) {
    return *std::min_element(known.begin(), known.end(), [wanted](std::string_view a, std::string_view b) {
        return edit_distance(wanted, a) < edit_distance(wanted, b);
    });
}

std::string known_names(std::string_view wanted, std::span<const std::string_view> known) {
    std::string text = "the nearest known one is \"";
    text.append(nearest_name(wanted, known)).append("\"; known are: ");
    const std::size_t listed = std::min(known.size(), kMostListed);
    for (std::size_t i = 0; i < listed; ++i)
        text.append(i > 0 ? ", \"" : "\"").append(known[i].substr(0, kLongest)).append("\"");
    if (listed < known.size())
        text.append(" and ").append(std::to_string(known.size() - listed)).append(" more");
    return text;
}

}  // namespace carom::tool
