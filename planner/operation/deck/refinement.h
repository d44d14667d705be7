// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/tet/sizing_field.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// The regions where an export step requests finer elements: its points, and the meshes of its objects.
/// Throws std::runtime_error where an object has no mesh or an empty one.
std::vector<convert::Refinement> refinements(const Objects& objects, const Deck& step);

/// A key for the finer elements of a step: two steps with the same key request the same.
std::string refinement_key(const Deck& step);

}  // namespace octotomy::planner
