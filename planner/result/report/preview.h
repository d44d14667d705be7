// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"
#include "planner/result/report/scene_pictures.h"

namespace octotomy::planner {

struct PreviewOptions {
  std::vector<std::string> views{"anterior", "left", "35,15"};  ///< as voxel::parse_view() reads them
  int size_px = 480;                                            ///< of each view's square
  EvaluateOptions evaluation;  ///< its wanted steps, meshes and certificates are chosen by the preview
};

/// One step's picture: its views side by side.
struct Preview {
  Evaluation evaluation;  ///< of the steps that it needed
  std::vector<voxel::DrawnObject> objects;
  std::vector<ScenePicture> frames;
  std::vector<std::uint8_t> png;
};

/// Draws one step, in the voxel kernel alone and without certificates. What a step makes is in colour; the
/// bone that it was cut from, or that stays behind, is pale. A mask shows what it holds of the object that it
/// cuts, a landmarks step its points as balls. A step that makes a scan shows removed_picture(), whatever the
/// views are. Throws std::runtime_error where the plan has no such step, with the nearest name, or the step
/// makes a scan of other voxels; what evaluate() throws.
Preview preview(const Plan& plan, const std::string& step, const PreviewOptions& options = {});

}  // namespace octotomy::planner
