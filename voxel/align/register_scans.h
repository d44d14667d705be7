// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// How the likeness of two scans is measured. Correlation: for samples in one unit, or in units that differ
/// by a scale and an offset. MutualInformation: for any two modalities or contrasts; the likeness is then the
/// entropy correlation coefficient.
enum class ScanLikeness { Correlation, MutualInformation };

/// One step of a search. At each resolution no step has a lower likeness than the one before. The first step
/// is the motion from which the search began.
struct ScanFitStep {
  double resolution_mm = 8.0;
  glm::dmat4 fixed_from_moving{1.0};
  double likeness = 0.0;
};

struct ScanFitOptions {
  ScanLikeness by = ScanLikeness::MutualInformation;
  /// Share of the smaller scan, above 0 and at most 1, that the other scan must cover. A lower share allows
  /// scans of regions that overlap little, but also more meaningless motions.
  double least_overlap = 0.3;
  /// The resolution at which the search ends, above 0 and at most 8 mm. A finer resolution takes longer; one
  /// below the scans' spacing does not improve the result.
  double finest_mm = 2.0;
  /// Called with each step of the best search, beginning with its start.
  std::function<void(const ScanFitStep&)> watch = {};
  Progress progress = {};
};

struct ScanFit {
  glm::dmat4 fixed_from_moving{1.0};  ///< rigid, LPS to LPS
  double likeness = 0.0;              ///< at the finest resolution
  double overlap = 0.0;               ///< share of the smaller scan that the other covers, 0..1
  std::size_t starts = 0;             ///< number of motions from which the search began
  std::size_t refined = 0;            ///< number of best starts that were refined at finer resolutions
  std::size_t agreeing = 0;           ///< number of refined starts that ended at the answer
  /// Likeness of the best motion other than the answer, at the resolution `rival_mm`; none if there is no
  /// other.
  std::optional<double> rival;
  double likeness_there = 0.0;  ///< likeness of the answer at the resolution `rival_mm`
  double rival_mm = 8.0;
  /// Smallest loss of likeness by a further motion that shifts the scans' edge by `probe_mm`.
  double least_drop = 0.0;
  double probe_mm = 4.0;
  std::size_t motions = 0;  ///< number of motions whose likeness was computed
  Verdict verdict = Verdict::Pass;
  std::vector<std::string> findings;  ///< reasons for the verdict; empty if it is Pass
};

/// Computes the rigid motion of the moving scan at which the two scans are most alike. The search begins at
/// 21 motions: no motion, the one that joins the scans' middles and the one that joins their centres of mass,
/// each also turned by 30 degrees to both sides about each axis. The verdict is Fail if the likeness is no
/// higher than between unrelated scans, or the overlap is too small. It is Warn if another motion is nearly
/// as good, if fewer than two starts agree, or if a small further motion loses no likeness. Throws
/// InvalidInput if a scan has no measured sample or one value only, or an option is out of its range;
/// Stopped. Deterministic on any thread count. Cost: the likeness of about a thousand motions, each at up to
/// 100,000 points.
ScanFit register_scans(const Scene& moving, const Scene& fixed, const ScanFitOptions& options = {});

}  // namespace octotomy::voxel
