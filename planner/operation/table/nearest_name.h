// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// Longer names get no suggestion, because the cost grows with the square of the length.
inline constexpr std::size_t longest_suggested = 100;

/// The known name that takes the fewest edits (insert, delete, replace, swap of neighbours) to reach from
/// `name`, upper and lower case alike; of several the one with the longest common beginning, then the first.
/// None if the edits would change more than half of the longer word, because such a suggestion misleads, or
/// if either name has more than longest_suggested bytes. Cost: the lengths' product for each name. Source:
/// optimal string alignment distance (Damerau 1964).
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);

/// `, did you mean 'low'? Known are: do, high, id, low, scan` for the end of an error's sentence.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace octotomy::planner
