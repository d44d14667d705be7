// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

// Densities that a scan's samples cluster about.
namespace octotomy::verify {

/// A density and its noise, in sample units.
struct SampleDensity {
  double value = 0.0, noise = 0.0;
};

/// The density that most of the values lie close to: the middle of the narrowest quarter of them, and the
/// spread of those. Precondition: eight values or more. Sorts them.
SampleDensity densest(std::vector<float>& values);

/// The same density from all values close to it; its noise only falls, so that the next density stays out.
SampleDensity refined(const std::vector<float>& values, SampleDensity level);

/// The middle of the values about the density that is nearest to this one.
double nearest_mode(const std::vector<float>& values, SampleDensity level);

}  // namespace octotomy::verify
