// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/align/register_surfaces.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The same places of the teeth on both surfaces, in the same order: at least three points on biting
/// surfaces, not on one line. Each lies within 3 mm of its surface, because such points are placed by hand.
struct ToothPoints {
  std::vector<glm::dvec3> fixed_mm, scan_mm;
};

struct ToothScanOptions {
  /// The crowns are fitted from their tips, the plane of the points, down to this depth in mm, above 0.
  /// Deeper parts of the scan are gum.
  double depth_mm = 5.0;
  /// The largest spacing of the samples from which the fixed surface was made, mm, at least 0. The fixed
  /// surface may be off by a share of the spacing, by the same length on all teeth.
  double sample_mm = 1.0;
  std::size_t samples = 6000;                           ///< as in SurfaceFitOptions
  std::string scan = "the scan", fixed = "the object";  ///< names for messages
  Progress progress = {};
};

/// A patch of the scan's surface, a few millimetres wide, that the fit did not use.
struct HeldPatch {
  glm::dvec3 at_mm{0.0};     ///< middle of the patch in the laid scan
  double mean_mm = 0.0;      ///< mean distance from the fixed surface, negative inside
  double mean_mm2 = 0.0;     ///< mean of the squared distances
  bool is_left_out = false;  ///< not used: much farther from the fixed surface than the other patches
};

/// A scan laid onto the teeth, and the error of its position.
struct LaidToothScan {
  glm::dmat4 fixed_from_scan{1.0};
  glm::dvec3 to_roots{0, 0, 1};  ///< unit normal of the plane of the points, from the tips to the roots
  double tips_mm = 0.0;          ///< p . to_roots for the points p of the plane
  double points_rms_mm = 0.0;    ///< root mean square residual of the given points, before the surfaces are
                                 ///< fitted
  SurfaceFit fit;                ///< fit of the crowns' patches that were not held back
  std::vector<HeldPatch> held;
  std::size_t fitted_patches = 0;
  double matched_share = 0.0;  ///< share of the held patches' samples that match the fixed surface
  double distance_mm = 0.0;    ///< root mean square distance of the held patches in use from the fixed
                               ///< surface
  /// The root mean square distance of the laid scan's points from their true positions is error_mm +-
  /// half_width_mm in 99 of 100 cases.
  double error_mm = 0.0, half_width_mm = 0.0;

  /// The depth of a point below the tips.
  double depth_mm(const glm::dvec3& p_mm) const { return glm::dot(p_mm, to_roots) - tips_mm; }
};

/// Lays a scan of teeth, open and with holes, onto a solid that shows the same teeth: first by the points,
/// then by the surfaces of the crowns, without their farthest parts. About a quarter of the crowns, in
/// patches, is not fitted: the distances of these patches bound the error. Both in LPS millimetres. Throws
/// Error (Input or Geometry) in one sentence that states the cause: a wrong unit; points that are too few,
/// off their surface or fit only mirrored; a scan that does not match the teeth, such as one of the other
/// jaw; too little of the crowns. Throws std::invalid_argument if the points lie on one line, and Stopped.
/// The same bits on any number of threads. Cost: that of register_surfaces() with a start. Sources: as
/// register_surfaces(); held-out patches are a cross-validation.
LaidToothScan lay_tooth_scan(const Mesh& scan, const Solid& fixed, const ToothPoints& points,
                             const ToothScanOptions& options);

}  // namespace octotomy::brep
