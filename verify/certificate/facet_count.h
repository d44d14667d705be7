// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::verify {

/// A flat part of a solid's boundary. Lengths are in voxels.
struct Facet {
  glm::dvec3 area{0.0};  ///< along the outward normal
  /// The sides of the facet's rims, in any order. Seen from outside, the facet lies on the left of each side.
  std::vector<std::array<glm::dvec3, 2>> sides;
};

/// The integer vectors k over which count_variance() sums: one of each pair k and -k, without repeats.
/// Precondition: facets are sorted by area, the largest first.
std::vector<glm::ivec3> count_vectors(const std::vector<Facet>& facets);

/// The variance, in voxels squared, that facets add to a count of lattice points over all positions of the
/// lattice. For a polyhedron it is the sum over integer vectors k of |F(k)|^2, F the Fourier transform of its
/// indicator, which is a sum over facets. The sum runs to 6 along each axis, and to 64 near the normals of
/// the 32 largest facets, where a facet's points are in phase; the rest assumes evenly spread normals. So the
/// sum includes the coherent error of facets along the lattice and of parallel facets. Precondition: no
/// facet's normal is along a vector of small integers. A digitised plane follows such a facet exactly, so the
/// variance over all positions is no bound for a single position. Cost: a few dozen products a side for 1098
/// vectors, and for up to 576 more for each of those normals. Parallel; same bits on any thread count.
/// Source: Kendall, "On the number of lattice points inside a random oval", 1948; the transform of a polygon
/// by its sides: Lee and Mittra, "Fourier transform of a polygonal shape function", 1983.
double count_variance(const std::vector<Facet>& facets);

}  // namespace octotomy::verify
