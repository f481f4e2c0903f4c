#pragma once

#include <span>
#include <string>
#include <string_view>

namespace carom::tool {

/// The one of `known` with the fewest letters to change, add, drop or swap; upper and lower case count as
/// one.
/// @param known  not empty. Cost: O(known · letters²), letters beyond the 64th are not looked at.
std::string_view nearest_name(std::string_view wanted, std::span<const std::string_view> known);

/// `the nearest known one is "radius"; known are: "radius", "mass"`, for the end of a message.
std::string known_names(std::string_view wanted, std::span<const std::string_view> known);

}  // namespace carom::tool
