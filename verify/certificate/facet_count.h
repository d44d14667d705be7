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

/// The integer vectors k of count_variance()'s sum, one of each pair k and -k, each once. Precondition: large
/// facets first.
std::vector<glm::ivec3> count_vectors(const std::vector<Facet>& facets);

/// The variance, in voxels squared, that facets add to a count of lattice points over all positions of the
/// lattice. For a polyhedron it is the sum over integer vectors k of |F(k)|^2, F the Fourier transform of its
/// indicator, which is a sum over facets. The sum runs to 6 along each axis, and to 64 near the normals of
/// the 32 largest facets, where a facet's points are in phase; the rest assumes evenly spread normals. So
/// facets along the lattice, or parallel ones, err coherently, as they do. Precondition: no facet has its
/// normal along a vector of small integers, which a digitised plane follows exactly: there the sum is right
/// over all positions and says nothing of a single one. Cost: a few dozen products a side for 1098
/// vectors, and for up to 576 more for each of those normals; parallel; the same bits on any number of
/// threads. Source: Kendall, "On the number of lattice points inside a random oval", 1948; the transform
/// of a polygon by its sides: Lee and Mittra, "Fourier transform of a polygonal shape function", 1983.
double count_variance(const std::vector<Facet>& facets);

}  // namespace octotomy::verify
