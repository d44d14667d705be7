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
  int size_px = 480;                                            ///< width and height of each view
  EvaluateOptions evaluation;  ///< preview() sets the members on steps, meshes and certificates
};

/// The picture of one step, with its views side by side.
struct Preview {
  Evaluation evaluation;  ///< of the steps that the picture needed
  std::vector<voxel::DrawnObject> objects;
  std::vector<ScenePicture> frames;
  std::vector<std::uint8_t> png;
};

/// Draws a step of a plan by the voxel kernel alone. The step's result is coloured; the bone from which it
/// was cut, or that remains, is pale. For a mask, the part of the object that it cuts is coloured; for
/// landmarks, balls show the points. For a step that makes a scan the picture is removed_picture(), whatever
/// the views. Throws std::runtime_error if the plan has no such step, with the most similar name, and if the
/// step makes a scan on another lattice; otherwise as evaluate() does.
Preview preview(const Plan& plan, const std::string& step, const PreviewOptions& options = {});

}  // namespace octotomy::planner
