// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/result/report/report.h"

// Pictures of the contacts between two objects.
namespace octotomy::planner {

/// Adds a group of pictures for each contact map in `result.measurements` that has none yet. It shows the
/// first object, seen towards its contacts, which are numbered. Colours are the distance to the second
/// object.
void add_contact_pictures(Result& result);

}  // namespace octotomy::planner
