// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// The known name that takes the fewest edits (insert, delete, replace, swap of neighbours) to reach from
/// `name`, upper and lower case alike; of several the one that
/// begins most alike, then the first. None where even that changes more than half of
/// the longer word, as such a suggestion would mislead. Cost: the lengths' product for each name.
/// Source: optimal string alignment distance (Damerau 1964).
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);

/// `, did you mean 'low'? Known are: do, high, id, low, scan` for the end of an error's sentence.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace octotomy::planner
