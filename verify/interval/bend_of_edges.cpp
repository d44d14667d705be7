// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/bend_of_edges.h"

#include <cmath>

#include "voxel/space/vector_clones.h"

namespace octotomy::verify {
namespace {

inline glm::dvec3 vector_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return 0.5 * glm::cross(b - a, c - a);
}

/// Returns the vector with length 1; zero for a vector of length zero.
inline glm::dvec3 unit(const glm::dvec3& v, double length) {
  const glm::dvec3 u = v / length;
  const bool is_long = length > 0.0;
  return {is_long ? u.x : 0.0, is_long ? u.y : 0.0, is_long ? u.z : 0.0};
}

}  // namespace

OCTOTOMY_VECTOR_CLONES void measure_faces(FaceBatch& faces, const BendFrame& within, std::size_t count) {
  const BendFrame frame = within;  // which no result overwrites
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 a = faces.corner[0].at(i), b = faces.corner[1].at(i), c = faces.corner[2].at(i);
    const glm::dvec3 across = vector_area(a, b, c);
    faces.across.set(i, across);
    faces.size[i] = glm::length(across);
    faces.along.set(i, across * frame.units);
    faces.part.set(i,
                   glm::floor(frame.from_lps * ((a + b + c) / 3.0 - frame.origin_mm) / frame.part_samples));
  }
}

OCTOTOMY_VECTOR_CLONES void open_edges(EdgeBatch& edges, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 here = vector_area(edges.here[0].at(i), edges.here[1].at(i), edges.here[2].at(i));
    const glm::dvec3 beyond =
        vector_area(edges.beyond[0].at(i), edges.beyond[1].at(i), edges.beyond[2].at(i));
    edges.across_here.set(i, here);
    edges.across_beyond.set(i, beyond);
    const glm::dvec3 across = glm::cross(here, beyond);
    edges.sine[i] = std::copysign(glm::length(across), glm::dot(across, edges.to.at(i) - edges.from.at(i)));
    edges.cosine[i] = glm::dot(here, beyond) + 0.0;
  }
}

OCTOTOMY_VECTOR_CLONES void bend_edges(EdgeBatch& edges, const BendFrame& within, std::size_t count) {
  const BendFrame frame = within;  // which no result overwrites
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 here = edges.across_here.at(i), beyond = edges.across_beyond.at(i);
    const glm::dvec3 p = edges.from.at(i), q = edges.to.at(i), along = q - p, middle = 0.5 * (p + q);
    const glm::dvec3 normal = unit(here, glm::length(here)) + unit(beyond, glm::length(beyond));
    const glm::dvec3 across = glm::cross(normal, along);
    edges.tangent[i] = glm::length(across);
    const glm::dvec3 t = unit(across, edges.tangent[i]);
    edges.normal.set(i, normal);
    edges.along.set(i, normal * frame.units);
    edges.mm[i] = 0.5 * glm::length(along) * edges.angle[i];
    edges.spacing_mm[i] = glm::length((t * frame.units) * frame.spacing_mm);
    edges.inverse[i] = glm::length(frame.from_lps * t);
    edges.part.set(i, glm::floor(frame.from_lps * (middle - frame.origin_mm) / frame.part_samples));
    edges.cell.set(i, glm::floor(middle / frame.cell_mm));
  }
}

}  // namespace octotomy::verify
