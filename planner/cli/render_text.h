// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/drawn_files.h"
#include "planner/cli/scan_in.h"
#include "voxel/view/annotation.h"
#include "voxel/view/cutaway.h"

namespace octotomy::planner::cli {

/// What the command line says of a picture.
struct RenderText {
  DrawnText drawn;
  ScanIn scan;
  std::filesystem::path out;
  std::string view = "anterior";
  std::string size = "512x512";
  std::string algorithm;
  std::string shading = "partial_volume";
  std::optional<double> width_mm;
  std::optional<double> eye_mm, stereo_deg;
  bool count = false;
  std::vector<std::string> cut_planes;
  std::vector<std::string> cut_boxes;
  std::string cut_face = "plain";
  std::string tones;
  bool annotate = false;
  std::string title;
  std::string transfer;
  std::string colour_by;
  std::optional<double> range_mm;
  std::vector<std::string> picks;
};

/// WxH in pixels.
glm::ivec2 size_of(const RenderText& text);
/// Normals are made unit.
std::vector<voxel::Cutaway> cuts_of(const RenderText& text);
/// Title, sides, scale, and a legend of the objects that are neither hidden nor coloured by a scalar.
voxel::Annotation annotation_of(const RenderText& text, const std::vector<voxel::DrawnObject>& objects);

}  // namespace octotomy::planner::cli
