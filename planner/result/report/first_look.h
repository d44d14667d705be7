// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/plan/evaluate.h"
#include "planner/result/report/report.h"

namespace octotomy::planner {

struct LookOptions {
  /// Lower bounds of bone and of everything within the skin, in sample units. Default: 300 and -300 for
  /// Hounsfield units; otherwise thresholds_of() the scan's own samples, with a finding that says so.
  std::optional<double> bone_low, skin_low;
  EvaluateOptions evaluation;
  /// Called with what the voxel kernel has alone: audit, pictures, parts and volumes, after about a fifth of
  /// the time. A finding in it says that the mesh kernel and the certificates are still to come.
  std::function<void(Result first)> seen = nullptr;
  voxel::ReadOptions read = {};  ///< the series, and what the file does not say of itself
};

/// Two thresholds that part samples into three classes of least variance within each.
struct Thresholds {
  double lower = 0.0, upper = 0.0;
};
/// Of a histogram of 256 bins from the 0.1st to the 99.9th percentile, so that metal and padding do not take
/// the bins. Throws std::runtime_error where the samples are all alike. Cost: one pass over the samples.
/// Source: Otsu 1979, section on multithresholding.
Thresholds thresholds_of(const voxel::Scene& scene);

/// What a scan without a plan shows: its audit, bone and skin in all views, the parts of the bone,
/// volumes and areas by both kernels, certified. The result's plan is one that run replays. Throws as
/// evaluate() does.
Result first_look(const std::filesystem::path& scan, const LookOptions& options = {});

}  // namespace octotomy::planner
