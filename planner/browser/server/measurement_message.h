// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/browser/server/message.h"

namespace octotomy::planner::serve {

/// {"id", "says", "value", "unit", "half_width", "sentence", "details"} of one of measurements_json(): a
/// distance, an angle, a gap, a size, or a result with a table, whose first number is shown (an airway, contacts, a
/// comparison, trials, a flap) or null (guesses of landmarks, proofs of printed parts). Null if a measurement without
/// a table has no number, such as the gap to an empty object.
Json measurement_message(const Json& measured);

/// A number of a result as a page shows it; The sentence begins with `what`.
Json number_message(const Json& value, const std::string& unit, const Json& half_width,
                    const std::string& what);

}  // namespace octotomy::planner::serve
