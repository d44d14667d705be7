// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

// The arithmetic of size_interval.cpp on the triangles and edges of a surface, in batches so that the
// compiler can vectorise it. Every result has the same bits as without batches.
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
  glm::dvec3 origin_mm{0.0};  ///< a corner of a part; parts move with the samples
  glm::dmat3 units{1.0};      ///< columns: the lattice's directions, of length 1
  glm::dvec3 spacing_mm{1.0};
  double part_samples = 6.0;
  glm::dvec3 cell_mm{1.0};  ///< along the LPS axes
};

struct FaceBatch {
  std::array<Vectors, 3> corner;
  Vectors across;  ///< the vector area
  Vectors along;   ///< the vector area in the lattice's directions
  Vectors part;    ///< the part that holds the centroid
  std::array<double, batch> size;
};
void measure_faces(FaceBatch& faces, const BendFrame& frame, std::size_t count);

struct EdgeBatch {
  Vectors from, to;
  std::array<Vectors, 3> here, beyond;  ///< corners of the triangles on either side, in their own order
  Vectors across_here, across_beyond;   ///< the vector areas
  std::array<double, batch> sine, cosine, angle;  ///< of the dihedral angle; the caller computes the angle
  Vectors normal, along;                          ///< along: the normal in the lattice's directions
  Vectors part, cell;                             ///< part and cell that hold the edge's middle
  std::array<double, batch> tangent;              ///< zero: no direction across the edge
  std::array<double, batch> mm, spacing_mm, inverse;
};
/// Computes vector areas, and the sines and cosines whose quotient is the tangent in brep::dihedral_angle().
void open_edges(EdgeBatch& edges, std::size_t count);
/// Computes the remaining fields. Precondition: the caller has set the angles.
void bend_edges(EdgeBatch& edges, const BendFrame& frame, std::size_t count);

}  // namespace octotomy::verify
