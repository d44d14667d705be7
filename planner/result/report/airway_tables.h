// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/measurement.h"

namespace octotomy::planner {

/// Airways: size, narrowest section and the area along the line as HTML; empty if none was measured.
std::string airway_tables(const std::vector<Measurement>& measurements);

}  // namespace octotomy::planner
