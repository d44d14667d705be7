// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

// The arithmetic of size_interval.cpp on the triangles and edges of a surface, many at a time so that it runs
// on vectors. Every number has the bits that one at a time gives.
namespace octotomy::verify {

inline constexpr std::size_t batch = 128;

/// Vectors by their components.
struct Vectors {
  std::array<double, batch> x, y, z;
  glm::dvec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const glm::dvec3& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// The lattice of the samples and the cells by which parts of a surface are told apart.
struct BendFrame {
  glm::dmat3 from_lps{1.0};   ///< to samples
  glm::dvec3 origin_mm{0.0};  ///< a corner of a part; parts move with the samples
  glm::dmat3 units{1.0};      ///< columns: the lattice's directions
  glm::dvec3 spacing_mm{1.0};
  double part_samples = 6.0;
  glm::dvec3 cell_mm{1.0};  ///< along the LPS axes
};

struct FaceBatch {
  std::array<Vectors, 3> corner;
  Vectors across;  ///< the vector area
  Vectors along;   ///< the same by the lattice's directions
  Vectors part;    ///< the part that holds the centre
  std::array<double, batch> size;
};
void measure_faces(FaceBatch& faces, const BendFrame& frame, std::size_t count);

struct EdgeBatch {
  Vectors from, to;
  std::array<Vectors, 3> here, beyond;  ///< corners of the triangles on either side, in their own order
  Vectors across_here, across_beyond;   ///< the vector areas
  std::array<double, batch> sine, cosine, angle;  ///< the dihedral angle's; the caller finds the angle
  Vectors normal, along;                          ///< along: the normal by the lattice's directions
  Vectors part, cell;                             ///< that hold the middle
  std::array<double, batch> tangent;              ///< zero: no direction across the edge
  std::array<double, batch> mm, spacing_mm, inverse;
};
/// Vector areas, sines and cosines, the latter two as brep::dihedral_angle() has them.
void open_edges(EdgeBatch& edges, std::size_t count);
/// The others, with the angles known.
void bend_edges(EdgeBatch& edges, const BendFrame& frame, std::size_t count);

}  // namespace octotomy::verify
