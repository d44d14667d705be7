// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/certify_surface.h"

#include <stdexcept>

#include "brep/mesh/health.h"
#include "voxel/measure/measure.h"

namespace octotomy::verify {
namespace {

/// A certificate that has only the octree's answer.
Certificate without_mesh(const voxel::Octree& octree, const BoundInputs& inputs) {
  const voxel::Measures voxels = voxel::measure(octree);
  Certificate certificate;
  certificate.operation = inputs.operation;
  certificate.voxel = {inputs.voxel_lineage, voxels.volume_mm3, voxels.area_crofton13_mm2,
                       voxels.centroid_mm};
  certificate.mesh.lineage = inputs.mesh_lineage;
  certificate.difference_mm3 = voxels.volume_mm3;
  certificate.symmetric_difference_mm3 = voxels.volume_mm3;
  return certificate;
}

}  // namespace

Certificate certify_surface(const voxel::Octree& octree, const brep::Triangles& triangles,
                            const BoundInputs& inputs, const voxel::Progress& progress) {
  if (triangles.faces.empty()) return certify_bounded(octree, brep::Solid(), inputs, progress);
  const brep::Health health = brep::health(triangles, {.self_intersections = false});
  Certificate certificate = without_mesh(octree, inputs);
  // A halfedge mesh cannot represent non-manifold or misoriented edges, and an open mesh has no inside.
  if (health.closed && health.manifold && health.misoriented_edges == 0)
    certificate =
        certify_bounded(octree, brep::trusted_solid(triangles, brep::Proof::Connection), inputs, progress);
  if (!health.closed || !health.manifold || !health.oriented || health.duplicate_faces > 0)
    for (const std::string& finding : health.findings)
      lower(certificate, Verdict::Fail, "The mesh is no solid: " + finding);
  return certificate;
}

}  // namespace octotomy::verify
