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
  int size_px = 480;                                            ///< side of each view's square
  EvaluateOptions evaluation;  ///< preview() sets its wanted steps, meshes and certificates
};

/// One step's picture: its views side by side.
struct Preview {
  Evaluation evaluation;  ///< evaluation of the steps that the preview needed
  std::vector<voxel::DrawnObject> objects;
  std::vector<ScenePicture> frames;
  std::vector<std::uint8_t> png;
};

/// Draws one step, by the voxel kernel alone and without certificates. The step's result is in colour; the
/// bone from which it was cut, or that remains, is pale. A mask shows the part of the object that it will
/// cut, a landmarks step its points as balls. A step that makes a scan shows removed_picture(), independent
/// of the views. Throws std::runtime_error, with the nearest name, if the plan has no such step; if the step
/// makes a scan with a different lattice; as evaluate() does.
Preview preview(const Plan& plan, const std::string& step, const PreviewOptions& options = {});

}  // namespace octotomy::planner
