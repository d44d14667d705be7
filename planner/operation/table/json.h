// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace octotomy::planner {

/// JSON for writing: members keep the order of insertion.
using Json = nlohmann::ordered_json;
/// JSON for reading: members are sorted by name.
using SortedJson = nlohmann::json;

}  // namespace octotomy::planner
