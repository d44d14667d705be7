// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::verify {

/// A flat part of a solid's boundary, in voxels.
struct Facet {
  glm::dvec3 area{0.0};  ///< along the outward normal
  /// Its rims, each side with the facet on its left as seen from outside, in any order.
  std::vector<std::array<glm::dvec3, 2>> sides;
};

/// The variance, in voxels squared, that facets add to a count of lattice points over all places of the
/// lattice: of a polyhedron the sum over integer vectors k of |F(k)|^2, F its indicator's Fourier transform,
/// which is a sum over facets. Summed up to 6 along each axis and, near the normals of the 32 largest facets,
/// where a facet's points are in phase, up to 64; the rest, of other facets, as if normals were spread
/// evenly. So facets that run along the lattice or are parallel err in step, as they do. Precondition: no
/// facet has its normal along one of the vectors of small integers that a digitised plane follows exactly,
/// where the sum is right over all places but says nothing of one place. Cost: 1098 sines and cosines a side,
/// and up to 576 more for each of those normals; parallel; the same bits on any number of threads. Source:
/// Kendall, "On the number of lattice points inside a random oval", 1948; the transform of a polygon by its
/// sides: Lee and Mittra, "Fourier transform of a polygonal shape function", 1983.
double count_variance(const std::vector<Facet>& facets);

}  // namespace octotomy::verify
