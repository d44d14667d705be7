// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/browser/server/message.h"

namespace octotomy::planner::serve {

/// A measurement of measurements_json() as a page shows it: {"id", "says", "value", "unit", "half_width",
/// "sentence", "details"}. The value is a distance, an angle, a gap, a size, or the first number of a result
/// with a table (an airway, contacts, a comparison, trials, a flap). It is null for tables without such a
/// number (guesses of landmarks, proofs of printed parts). Returns null for other measurements without a
/// number, such as the gap to an empty object.
Json measurement_message(const Json& measured);

/// A number of a result as a page shows it. `what` is the beginning of its sentence.
Json number_message(const Json& value, const std::string& unit, const Json& half_width,
                    const std::string& what);

}  // namespace octotomy::planner::serve
