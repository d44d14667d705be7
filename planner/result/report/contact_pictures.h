// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/result/report/report.h"

// Pictures of contacts between objects.
namespace octotomy::planner {

/// Adds a group of pictures for each contact map of `result.measurements` that has none yet: the surface
/// coloured by its distance to the other one, seen towards the contacts, which are numbered.
void add_contact_pictures(Result& result);

}  // namespace octotomy::planner
