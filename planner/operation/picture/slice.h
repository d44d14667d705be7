// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/operation/file/picture_frame.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"
#include "voxel/tree/octree.h"
#include "voxel/view/reformat.h"

// A plane or a curved sheet of samples: its fields, and the picture.
namespace octotomy::planner {

struct Slice {
  ScanName scan;
  std::filesystem::path path;
  std::string axial, coronal, sagittal;  ///< millimetres, or "middle"
  std::vector<glm::dvec3> oblique, curve_mm;
  double height_mm = 60.0;
  std::optional<glm::dvec3> up;
  std::optional<SampleWindow> window;
  std::vector<double> level;
  std::vector<ObjectName> objects, hatched;
  std::vector<std::string> colours;  ///< colours of the objects, then of the hatched objects
  std::optional<double> pixel_mm;
  std::string size;  ///< WxH in pixels; empty: the whole scan
  std::optional<glm::dvec3> centre_mm;
  std::string interpolate = "linear";
  bool plain = false;
  std::optional<double> grid_mm;
  // Of the command only.
  std::filesystem::path out;
  std::vector<std::string> curve;
};

/// An object whose outline is drawn.
struct Outlined {
  std::string name;  ///< path of its file, or name of the object
  voxel::Octree octree;
  bool is_hatched = false;  ///< its inside is hatched
};

/// A picture of a slice, with its position and its results.
struct SlicePicture {
  voxel::Sheet sheet;
  voxel::SheetSamples samples;
  glm::ivec2 size_px{0};  ///< with a grid's margin
  std::vector<std::uint8_t> rgb;
  std::optional<PictureFrame> frame;  ///< of a plane
  nlohmann::ordered_json said;
};

/// Draws a slice of a scan as the operation `slice` does. Throws std::runtime_error for fields that cannot be
/// read; std::invalid_argument if a plane without a size misses the scan; Stopped.
SlicePicture slice_of(const Slice& slice, const voxel::Scene& scene, const std::vector<Outlined>& objects,
                      Timings& timings, const std::stop_token& stop);

}  // namespace octotomy::planner
