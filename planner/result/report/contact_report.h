// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/measurement.h"
#include "planner/result/report/report.h"

// Pictures and tables of contacts between objects.
namespace octotomy::planner {

/// Adds a group of pictures for each contact map of `result.measurements` that has none yet: the surface
/// coloured by its distance to the other one, seen towards the contacts, which are numbered.
void add_contact_pictures(Result& result);

/// One table per contact map; empty if there are none.
std::string contact_tables(const std::vector<Measurement>& measurements);

}  // namespace octotomy::planner
