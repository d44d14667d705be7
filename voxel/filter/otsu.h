// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/filter/histogram.h"

namespace octotomy::voxel {

/// The thresholds, ascending, that divide a histogram into 2 to 8 classes with the least variance within
/// classes; class c reaches from threshold c - 1, included, to threshold c. Exact over the histogram's bins;
/// among equal divisions it takes the lowest thresholds. Throws std::invalid_argument for another number of
/// classes, or more classes than bins. Cost: classes times the square of the bins.
/// Source: Otsu, IEEE Trans. Systems, Man, and Cybernetics 9, 1979, with its multithresholding. Departure:
/// dynamic programming over the last class's first bin, instead of a search through all combinations.
std::vector<double> otsu_thresholds(const Histogram& histogram, int classes);

}  // namespace octotomy::voxel
