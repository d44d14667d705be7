// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// Names that people type are shorter; the cost grows with the square.
inline constexpr std::size_t longest_suggested = 100;

/// The known name that takes the fewest edits (insert, delete, replace, swap of neighbours) to reach from
/// `name`, upper and lower case alike; of several the one that
/// begins most alike, then the first. None where even that changes more than half of
/// the longer word, as such a suggestion would mislead, or where either has more than longest_suggested
/// bytes. Cost: the lengths' product for each name. Source: optimal string alignment distance (Damerau 1964).
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);

/// `, did you mean 'low'? Known are: do, high, id, low, scan` for the end of an error's sentence.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace octotomy::planner
