// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace octotomy::planner {

/// Members keep the order they were given: what is written.
using Json = nlohmann::ordered_json;
/// Members lie in the order of their names: what is read by name alone.
using SortedJson = nlohmann::json;

}  // namespace octotomy::planner
