// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/filter/histogram.h"

namespace octotomy::voxel {

/// The thresholds, ascending, that divide a histogram into 2 to 8 classes with the least variance within
/// classes; class c reaches from threshold c - 1, included, to threshold c. Exact over the histogram's bins;
/// of equally good divisions, the one with the lowest thresholds is returned. Throws std::invalid_argument
/// if there are fewer than 2 or more than 8 classes, or more classes than bins. Cost: classes times the
/// square of the bins. Source: Otsu, IEEE Trans. Systems, Man, and Cybernetics 9, 1979, which also describes
/// several thresholds. Departure: dynamic programming over the last class's first bin, instead of a search
/// through all combinations.
std::vector<double> otsu_thresholds(const Histogram& histogram, int classes);

}  // namespace octotomy::voxel
