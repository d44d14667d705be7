// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

// Vector areas, angles and curvatures of a surface's triangles and edges, for size_interval.cpp. They are
// computed in batches so that the compiler can vectorise the loops. Every result has the same bits as without
// batches.
namespace octotomy::verify {

inline constexpr std::size_t batch = 128;

/// Vectors as one array per component.
struct Vectors {
  std::array<double, batch> x, y, z;
  glm::dvec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const glm::dvec3& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// The lattice of the samples, and the cells that divide a surface into parts.
struct BendFrame {
  glm::dmat3 from_lps{1.0};   ///< from LPS millimetres to samples
  glm::dvec3 origin_mm{0.0};  ///< a corner of a part; the parts move with the samples
  glm::dmat3 units{1.0};      ///< columns: the lattice's directions, of length 1
  glm::dvec3 spacing_mm{1.0};
  double part_samples = 6.0;
  glm::dvec3 cell_mm{1.0};  ///< along the LPS axes
};

struct FaceBatch {
  std::array<Vectors, 3> corner;
  Vectors across;  ///< the vector area
  Vectors along;   ///< the vector area in the lattice's directions
  Vectors part;    ///< indices of the part that holds the centroid
  std::array<double, batch> size;
};
void measure_faces(FaceBatch& faces, const BendFrame& frame, std::size_t count);

struct EdgeBatch {
  Vectors from, to;
  /// corners of the two triangles at the edge, in each triangle's order
  std::array<Vectors, 3> here, beyond;
  Vectors across_here, across_beyond;             ///< the vector areas
  std::array<double, batch> sine, cosine, angle;  ///< of the dihedral angle; the caller computes the angle
  Vectors normal, along;                          ///< `along`: the normal in the lattice's directions
  /// indices of the part and of the cell that hold the edge's middle
  Vectors part, cell;
  std::array<double, batch> tangent;  ///< zero if no direction across the edge could be computed
  std::array<double, batch> mm, spacing_mm, inverse;
};
/// Computes the vector areas, and the sine and cosine of each dihedral angle as brep::dihedral_angle() does.
void open_edges(EdgeBatch& edges, std::size_t count);
/// Computes the remaining fields. Precondition: the caller has set the angles.
void bend_edges(EdgeBatch& edges, const BendFrame& frame, std::size_t count);

}  // namespace octotomy::verify
