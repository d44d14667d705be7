// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// A number for display with `decimals` decimals, digits grouped in threes by a narrow no-break space from
/// five digits on, and a true minus sign. NaN and infinities become an en dash.
std::string grouped(double value, int decimals);

/// A number with three significant figures, for example 1 234, 56.7 or 0.0123. All digits before the decimal
/// point are written, and at most six decimals.
std::string three_figures(double value);

/// A number in plain ASCII with at most six decimals, without trailing zeros, for example 0.5 or 300; from
/// 1e+15 on in exponential form.
std::string plain(double value);
/// The ranges of a box as text: "x -10..20, y 0..5.5, z 1..2 mm".
std::string plain(const voxel::Box& box);

}  // namespace octotomy::planner
