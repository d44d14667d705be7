// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// Measures the size of an object, the gap between two objects, the distance of two points or the angle of
/// three.
struct Measure {
  std::optional<ObjectName> object, to;
  std::vector<Mark> points_mm;
  std::vector<glm::dvec3> section, along;
  bool thickness = false, curvature = false;
  // Of the command only.
  std::vector<glm::dvec3> distance, angle;
  std::optional<SampleWindow> window;
  std::optional<double> voxel_mm;
  std::filesystem::path out;

  /// Whether a measure is requested that only a surface has, but voxels do not.
  bool asks_mesh() const {
    return !section.empty() || !along.empty() || !distance.empty() || !angle.empty() || curvature ||
           !out.empty();
  }
  /// Whether the requested measures need the mesh kernel's surface, or the thickness of walls, which voxels
  /// also have.
  bool asks_surface() const { return asks_mesh() || thickness; }
};

/// Measures a scan's window, an octree or a mesh in a file.
FileAnswer measure_file(const Measure& asked, const FileBench& bench);

}  // namespace octotomy::planner
