// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"
// After mesh.h, which leaves OpenMesh's assertions out.
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "brep/mesh/measure.h"
#include "brep/shape/decimate.h"

namespace octotomy::brep {

/// What decimate() does in one round, by OpenMesh's decimater on OpenMesh's own mesh; for comparisons.
inline Mesh plain_decimation(Mesh mesh, const DecimateOptions& options) {
  mesh.request_face_normals();
  mesh.update_face_normals();
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).set_max_err(4.0 * size_of(triangles_of(mesh)).area_mm2 /
                                            static_cast<double>(mesh.n_faces()) * options.max_error_mm *
                                            options.max_error_mm,
                                        false);
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle normals;
  decimater.add(normals);
  decimater.module(normals).set_max_normal_deviation(options.max_normal_deviation_deg);
  OpenMesh::Decimater::ModAspectRatioT<Mesh>::Handle aspect;
  decimater.add(aspect);
  decimater.module(aspect).set_aspect_ratio(options.max_aspect);
  decimater.initialize();
  decimater.decimate_to_faces(0, options.faces.value_or(0));
  mesh.garbage_collection();
  return mesh;
}

}  // namespace octotomy::brep
