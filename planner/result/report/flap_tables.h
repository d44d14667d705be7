// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace octotomy::planner {

/// A free flap's segments and osteotomies as two tables of HTML; empty if no measurement is of a flap.
std::string flap_tables(const nlohmann::ordered_json& measurements);

}  // namespace octotomy::planner
