// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octotomy::planner {

/// First guesses of landmarks and what was not found, as HTML that says that nobody has confirmed them;
/// nothing where none was asked for.
std::string landmark_tables(const nlohmann::ordered_json& measurements);

}  // namespace octotomy::planner
