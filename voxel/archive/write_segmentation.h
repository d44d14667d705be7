// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// One object of a segmentation.
struct WrittenSegment {
  std::string name;        ///< without control characters
  glm::vec3 colour{1.0f};  ///< sRGB, 0..1
  Octree octree;
};

/// Writes objects as a segmentation of 3D Slicer, .seg.nrrd: labels in layers, so that overlapping objects
/// keep all their voxels; frame LPS, millimetres. Each segment states its name, its colour and SNOMED's code
/// of tissue. An object is in the first layer in which it overlaps no earlier object. The segment with index
/// n, counted from 0 over all layers, has the label n + 1. Preconditions: the octrees share one universe, and
/// there is at least one. Writes directly to the path, not to a temporary file, so no reader may use the
/// folder yet. Throws Error (Input, Resource) with path and reason. Cost: two passes over all slices; memory:
/// one slice of every layer. Source: Slicer's documentation of the format, "Segmentations", which names the
/// fields of the header.
void write_segmentation(const std::vector<WrittenSegment>& segments, const std::filesystem::path& path);

}  // namespace octotomy::voxel
