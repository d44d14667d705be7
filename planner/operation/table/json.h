// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace octotomy::planner {

/// Members keep the order of insertion. For JSON that is written.
using Json = nlohmann::ordered_json;
/// Members are sorted by name. For JSON that is only read, by name.
using SortedJson = nlohmann::json;

}  // namespace octotomy::planner
