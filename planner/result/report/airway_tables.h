// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octotomy::planner {

/// Airways: size, narrowest section and the area along the line as HTML; empty if none was measured.
std::string airway_tables(const nlohmann::ordered_json& measurements);

}  // namespace octotomy::planner
