// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/plan/evaluate.h"
#include "planner/result/report/report.h"

namespace octotomy::planner {

struct LookOptions {
  /// Lower bounds of bone and of everything inside the skin, in sample units. Default: 300 and -300 in
  /// Hounsfield units; otherwise thresholds_of() the scan, with a finding.
  std::optional<double> bone_low, skin_low;
  EvaluateOptions evaluation;
  /// Called after about a fifth of the time with the results of the voxel kernel: audit, pictures, parts and
  /// volumes. A finding in it states that the mesh kernel's answers and the certificates are still missing.
  std::function<void(Result first)> seen = nullptr;
  voxel::ReadOptions read = {};  ///< which series to read, and facts that the file does not state
};

/// Two thresholds that divide samples into three classes, so that the variance within the classes is least.
struct Thresholds {
  double lower = 0.0, upper = 0.0;
};
/// Computes the thresholds from a histogram with 256 bins. Its bins divide the range from the 0.1st to the
/// 99.9th percentile, so that metal and padding do not widen them. Throws std::runtime_error if all samples
/// are equal. Cost: one pass over the samples. Source: Otsu 1979, section on multithresholding.
Thresholds thresholds_of(const voxel::Scene& scene);

/// A first look at a scan for which there is no plan: its audit, pictures of bone and skin in all views, the
/// parts of the bone, and volumes and areas by both kernels with certificates. `octotomy run` can replay the
/// plan in the result. Throws as evaluate() does.
Result first_look(const std::filesystem::path& scan, const LookOptions& options = {});

}  // namespace octotomy::planner
