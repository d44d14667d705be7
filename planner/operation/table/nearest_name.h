// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// No suggestion is made for longer names, because the cost grows with the square of the length.
inline constexpr std::size_t longest_suggested = 100;

/// The known name that is reached from `name` with the fewest edits (insert, delete, replace, swap of
/// neighbours), without regard to case. If several need the same number, the one with the longest common
/// beginning, then the first. None if more than half of the longer word would change, because such a
/// suggestion misleads, or if either name has more than longest_suggested bytes. Cost: the product of the
/// lengths for each known name. Source: optimal string alignment distance (Damerau 1964).
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);

/// The end of an error's sentence: `, did you mean 'low'? Known are: do, high, id, low, scan`.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace octotomy::planner
