// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/distance.h"
#include "convert/tetrahedra.h"
#include "voxel/progress.h"
#include "voxel/scene.h"

namespace octotomy::convert {

/// Displacements of the nodes of tetrahedra as a field over space: linear within each element, and outside of
/// all that of the nearest point of their surface, so that it is continuous across the surface.
class DisplacementField {
 public:
  /// Throws std::invalid_argument where there are no elements, or not one displacement a node.
  DisplacementField(Tetrahedra tetrahedra, std::vector<glm::dvec3> displacement_mm);

  /// The displacement of each point, both in LPS millimetres. Cost: some elements a point inside, log n
  /// outside. Parallel.
  std::vector<glm::dvec3> at(const std::vector<glm::dvec3>& points_mm) const;

  /// From displaced points back to where they came from: exactly the inverse within the elements, as long as
  /// none is turned over.
  DisplacementField inverse() const;
  /// Elements that the displacements turn inside out.
  std::size_t turned_over() const;

 private:
  struct Bins {
    glm::dvec3 low_mm{0.0};
    double side_mm = 1.0;
    glm::ivec3 dims{1};
    std::vector<std::uint32_t> first;  ///< of each bin in `tets`, and the end
    std::vector<std::uint32_t> tets;

    glm::ivec3 bin(const glm::dvec3& p_mm) const;
    std::size_t number(const glm::ivec3& bin) const;
  };
  static Bins bins_of(const Tetrahedra& tetrahedra);
  std::optional<glm::dvec3> within(const glm::dvec3& p_mm) const;

  Tetrahedra tetrahedra_;
  std::vector<glm::dvec3> displacement_mm_;
  Bins bins_;
  brep::Triangles surface_;
  brep::SurfaceTree surface_tree_;
};

/// A surface whose points are displaced.
brep::Mesh warped(const brep::Mesh& mesh, const DisplacementField& field);

/// A scan as it would show what is displaced: each voxel takes the trilinear sample of where it came from.
/// int16 samples are rounded to the nearest integer.
voxel::Scene warped(const voxel::Scene& scan, const DisplacementField& field,
                    const voxel::Progress& progress = {});

}  // namespace octotomy::convert
