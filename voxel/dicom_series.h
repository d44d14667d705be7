// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "voxel/dicom_slice.h"
#include "voxel/read_scene.h"

namespace octotomy::voxel {

/// Slices of one series with one size and orientation, ordered along the normal.
struct DicomStack {
  std::vector<DicomSlice> slices;
  glm::dvec3 along_row{1, 0, 0};
  glm::dvec3 along_column{0, 1, 0};
  glm::dvec3 normal{0, 0, 1};

  const DicomSlice& first() const { return slices.front(); }
  double height_mm(const DicomSlice& slice) const {
    return glm::dot(slice.first_mm - first().first_mm, normal);
  }
  /// How far a slice's first pixel lies from the first slice's normal, in pixels.
  glm::dvec2 aside_px(const DicomSlice& slice) const {
    const glm::dvec3 offset_mm = slice.first_mm - first().first_mm;
    return glm::dvec2(glm::dot(offset_mm, along_row), glm::dot(offset_mm, along_column)) / first().spacing_mm;
  }
};

/// Reads the headers below a path, chooses the series that the options ask for, and of it the slices that
/// make a stack; what was left out, and why, goes into the audit: stray_files, series, localizers, size,
/// orientation, pixel_spacing, duplicates. Throws as read_scene.
DicomStack stack_of_series(const std::filesystem::path& path, const ReadOptions& options,
                           std::vector<Finding>& audit);

/// Runs a task an index in parallel; of several exceptions the lowest index's is thrown, on any thread count.
/// Throws Stopped where the token is set before a task begins.
void for_each_index(std::size_t count, const std::stop_token& stop,
                    const std::function<void(std::size_t)>& task);

}  // namespace octotomy::voxel
