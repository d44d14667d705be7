// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/tet/sizing_field.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// The places of finer elements that a step requests: its points, and the surfaces of its objects. Throws
/// std::runtime_error if an object has no mesh or an empty one.
std::vector<convert::Refinement> refinements(const Objects& objects, const Deck& step);

/// A text that is equal for two steps exactly if they request the same finer elements.
std::string refinement_key(const Deck& step);

}  // namespace octotomy::planner
