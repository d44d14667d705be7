// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_slice.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Slices of one series with the same size and orientation, ordered along the normal.
struct DicomStack {
  std::vector<DicomSlice> slices;
  glm::dvec3 along_row{1, 0, 0};
  glm::dvec3 along_column{0, 1, 0};
  glm::dvec3 normal{0, 0, 1};

  const DicomSlice& first() const { return slices.front(); }
  double height_mm(const DicomSlice& slice) const {
    return glm::dot(slice.first_mm - first().first_mm, normal);
  }
  /// How far the first pixel of a slice is shifted within the plane from that of the first slice, in pixels.
  glm::dvec2 aside_px(const DicomSlice& slice) const {
    const glm::dvec3 offset_mm = slice.first_mm - first().first_mm;
    return glm::dvec2(glm::dot(offset_mm, along_row), glm::dot(offset_mm, along_column)) / first().spacing_mm;
  }
};

/// Reads the headers below a path, chooses the series that the options request, and keeps the slices that
/// form a stack. The audit lists the files that were left out, and why, under these checks: stray_files,
/// unusable_images, damaged_files, series, localizers, patient, patient_issuer (if stated), study, modality,
/// frame_of_reference, size, orientation, stacks, pixel_spacing, duplicates; then the lines of audit_stack().
/// A slice left out of a series is a Fail. These lines appear only if there is a doubt: orientation_noise,
/// orientation_rounded, orientation_length, join, image_count and concatenation. Folders of staged files
/// count as stray files. Throws as read_scene() does.
DicomStack stack_of_series(const std::filesystem::path& path, const ReadOptions& options,
                           std::vector<Finding>& audit);

/// Runs a task for every index in parallel. If tasks throw, rethrows the exception of the lowest index, so
/// that it does not depend on the threads. Throws Stopped if a stop is requested before a task begins.
void for_each_index(std::size_t count, const Progress& progress,
                    const std::function<void(std::size_t)>& task);

}  // namespace octotomy::voxel
