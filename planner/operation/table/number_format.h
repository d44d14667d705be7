// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// A number for display: `decimals` decimals, digits grouped in threes by a narrow no-break space from five
/// digits on, a true minus sign. "not a number" and infinities are an en dash.
std::string grouped(double value, int decimals);

/// A number with three significant figures, but all integer digits and at most six decimals: 1 234, 56.7,
/// 0.0123.
std::string three_figures(double value);

/// A number with at most six decimals, without trailing zeros, in plain ASCII: 0.5, 300; from 1e+15 on in
/// exponential form.
std::string plain(double value);
/// A box by its axes: "x -10..20, y 0..5.5, z 1..2 mm".
std::string plain(const voxel::Box& box);

}  // namespace octotomy::planner
