// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/plan/evaluate.h"
#include "planner/result/report/report.h"

namespace octotomy::planner {

struct LookOptions {
  /// Lower bounds of bone and of everything within the skin, in sample units. Default: 300 and -300 for
  /// Hounsfield units; otherwise thresholds_of() the scan's own samples, with a finding.
  std::optional<double> bone_low, skin_low;
  EvaluateOptions evaluation;
  /// Called after about a fifth of the time with the voxel kernel's results: audit, pictures, parts and
  /// volumes. They contain a finding that the mesh kernel and the certificates are still missing.
  std::function<void(Result first)> seen = nullptr;
  voxel::ReadOptions read = {};  ///< the series, and facts that the file does not state
};

/// Two thresholds that divide samples into three classes with the least variance within each.
struct Thresholds {
  double lower = 0.0, upper = 0.0;
};
/// Uses a histogram of 256 bins from the 0.1st to the 99.9th percentile, so that metal and padding do not
/// widen the bins. Throws std::runtime_error if all samples are equal. Cost: one pass over the samples.
/// Source: Otsu 1979, section on multithresholding.
Thresholds thresholds_of(const voxel::Scene& scene);

/// A first look at a scan without a plan: its audit, bone and skin in all views, the parts of the bone,
/// volumes and areas by both kernels, certified. `octotomy run` can replay the result's plan. Throws as
/// evaluate() does.
Result first_look(const std::filesystem::path& scan, const LookOptions& options = {});

}  // namespace octotomy::planner
