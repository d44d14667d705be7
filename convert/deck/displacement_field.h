// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/mesh/distance.h"
#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::convert {

/// The displacements of tetrahedra's nodes as a field over space: linear within each element; outside all
/// elements, the displacement of the nearest point of their surface. So the field is continuous across the
/// surface.
class DisplacementField {
 public:
  /// Throws std::invalid_argument if there are no elements, or not one displacement for each node.
  DisplacementField(Tetrahedra tetrahedra, std::vector<glm::dvec3> displacement_mm);

  /// The displacement of each point, both in LPS millimetres. Parallel. Cost a point: some elements inside,
  /// log n outside.
  std::vector<glm::dvec3> at(const std::vector<glm::dvec3>& points_mm) const;

  /// The field that moves displaced points back. Exactly the inverse within the elements if none is inverted.
  DisplacementField inverse() const;
  /// The number of elements that the displacements invert.
  std::size_t turned_over() const;

 private:
  struct Bins {
    glm::dvec3 low_mm{0.0};
    double side_mm = 1.0;
    glm::ivec3 dims{1};
    std::vector<std::uint32_t> first;  ///< index of each bin's first element in `tets`, then the end
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

/// The scan of a displaced body: each voxel gets the trilinear sample at the position from which it moved.
/// int16 samples are rounded to the nearest integer. Throws voxel::Stopped.
voxel::Scene warped(const voxel::Scene& scan, const DisplacementField& field,
                    const voxel::Progress& progress = {});

}  // namespace octotomy::convert
