// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "verify/phantom/head_phantom.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

/// How the leg is scanned. Frame: LPS millimetres. The phantom is a left lower leg along z with the knee
/// above. The tibia's axis is x = y = 0; the fibula lies to the left and behind.
struct LegOptions {
  double voxel_mm = 1.0;
  double noise_sigma_hu = 0.0;  ///< Gaussian noise
  std::uint64_t seed = 1;
  HeadTissues tissues;  ///< a voxel half of bone and half of soft tissue has 300 HU
};

/// The fibula's shaft: an elliptic cylinder with a round canal of marrow, which has the Hounsfield value of
/// soft tissue. Head and malleolus lie beyond the ends of the shaft.
struct LegFibula {
  glm::dvec3 from_mm{30.0, 12.0, 105.0};  ///< end of the shaft on its axis, below the head
  glm::dvec3 to_mm{33.0, 16.0, -105.0};   ///< end of the shaft on its axis, above the malleolus
  double across_mm = 8.5;                 ///< half of the shaft's width along face()
  double other_mm = 6.5;                  ///< half of the shaft's width perpendicular to face()
  double canal_mm = 2.5;                  ///< the canal's radius

  glm::dvec3 along() const;
  /// A unit vector perpendicular to the shaft's axis, to the patient's left.
  glm::dvec3 face() const;
  double length_mm() const { return glm::distance(from_mm, to_mm); }
  /// The area of a section of the shaft's bone perpendicular to the axis, without the canal.
  double section_mm2() const;
};

/// Returns a CT of a lower leg. Each sample is the mean of the closed forms over its voxel, by 4^3
/// sub-samples near surfaces; then follow noise and rounding to int16. Throws std::invalid_argument that
/// names the option out of its range; voxel::Stopped. Same bits on any thread count. Cost: about a second of
/// processor time at 1 mm.
voxel::Scene leg_phantom(const LegOptions& options = {}, const voxel::Progress& progress = {});

/// Whether a point, in LPS millimetres, is in the bone of the fibula's shaft: between the ends of the shaft
/// and outside the canal.
bool in_fibula_shaft(const glm::dvec3& p_mm);

}  // namespace octotomy::verify
