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

/// Correlation: for samples in one unit, or in units that differ by a scale and an offset. MutualInformation:
/// for any two modalities or contrasts; its value is the entropy correlation coefficient.
enum class ScanLikeness { Correlation, MutualInformation };

/// A motion that is at least as good as those before it at its resolution; the first is the start.
struct ScanFitStep {
  double resolution_mm = 8.0;
  glm::dmat4 fixed_from_moving{1.0};
  double likeness = 0.0;
};

struct ScanFitOptions {
  ScanLikeness by = ScanLikeness::MutualInformation;
  /// Share of the smaller scan, 0..1, that the other must cover. Lower: scans of different regions can be laid on
  /// each other, and more motions without meaning are tried.
  double least_overlap = 0.3;
  /// The resolution at which the search ends, mm. Lower: slower; a scan's own spacing is the limit.
  double finest_mm = 2.0;
  std::function<void(const ScanFitStep&)> watch = {};  ///< called with each step of the best search, from its
                                                       ///< start on, while it is refined
  Progress progress = {};
};

struct ScanFit {
  glm::dmat4 fixed_from_moving{1.0};  ///< rigid, LPS to LPS
  double likeness = 0.0;              ///< at the finest resolution
  double overlap = 0.0;               ///< share of the smaller scan that the other covers
  std::size_t starts = 0;             ///< motions from which the search began
  std::size_t refined = 0;            ///< number of best starts that were followed further
  std::size_t agreeing = 0;           ///< number of refined starts that ended at the answer
  std::optional<double> rival;        ///< likeness of the best other motion, at `rival_mm`
  double likeness_there = 0.0;        ///< likeness of the answer at `rival_mm`
  double rival_mm = 8.0;
  double least_drop = 0.0;  ///< smallest loss of likeness by a motion of `probe_mm` at the scans' edge
  double probe_mm = 4.0;
  std::size_t motions = 0;  ///< number of motions that were compared
  Verdict verdict = Verdict::Pass;
  std::vector<std::string> findings;  ///< reasons for a verdict that is no PASS
};

/// The rigid motion of the moving scan at which the two are most alike. The search begins at 21 motions: as
/// the scans lie, by their middles and by their centres of mass, each also turned by 30 degrees to both sides
/// about each axis. The verdict is Fail if the similarity is no higher than between unrelated scans. It is
/// Warn if another motion is nearly as good, if fewer than two starts agree, or if a small motion loses no
/// similarity. Throws InvalidInput if a scan has no measured sample or one value only, or an option is out of
/// its range; Stopped. Deterministic on any thread count. Cost: about a thousand likenesses of up to 100,000
/// points.
ScanFit register_scans(const Scene& moving, const Scene& fixed, const ScanFitOptions& options = {});

}  // namespace octotomy::voxel
