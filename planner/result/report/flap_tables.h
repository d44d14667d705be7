// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/measurement.h"

namespace octotomy::planner {

/// A free flap's segments and osteotomies as two tables of HTML; empty if no measurement is of a flap.
std::string flap_tables(const std::vector<Measurement>& measurements);

}  // namespace octotomy::planner
