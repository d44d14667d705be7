// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

// Finds the densities around which a scan's samples cluster.
namespace octotomy::verify {

/// A density and the standard deviation of its noise, in sample units.
struct SampleDensity {
  double value = 0.0, noise = 0.0;
};

/// Finds the most frequent density: the middle of the narrowest quarter of the values. The noise follows from
/// the width of this quarter. Precondition: eight values or more. Sorts the values.
SampleDensity densest(std::vector<float>& values);

/// Computes a density again, from all values close to it. The noise never increases, so that values of the
/// next density stay excluded.
SampleDensity refined(const std::vector<float>& values, SampleDensity level);

/// Returns the centre of the cluster of values that is nearest to `level`.
double nearest_mode(const std::vector<float>& values, SampleDensity level);

}  // namespace octotomy::verify
