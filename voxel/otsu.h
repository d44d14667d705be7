// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/histogram.h"

namespace octotomy::voxel {

/// The values that part a histogram into so many classes, 2 to 8, of least variance within each, ascending:
/// class c reaches from threshold c - 1, included, to threshold c. Exact over the histogram's bins; of equals
/// the lowest thresholds. Throws std::invalid_argument for another number of classes, or more than there are
/// bins. Cost: classes times the square of the bins.
/// Source: Otsu, IEEE Trans. Systems, Man, and Cybernetics 9, 1979, with its multithresholding; departure: by
/// dynamic programming over the last class's first bin, instead of a search through all combinations.
std::vector<double> otsu_thresholds(const Histogram& histogram, int classes);

}  // namespace octotomy::voxel
