// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace octotomy::planner {

/// What trials with errors of landmarks, saw, segmentation and seating leave of a plan's numbers, as HTML;
/// nothing where no step asked for it.
std::string trial_tables(const nlohmann::ordered_json& measurements);

}  // namespace octotomy::planner
