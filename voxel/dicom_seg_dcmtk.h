// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

#include "voxel/dicom_source.h"

// What crosses between write_dicom_seg.cpp and the library octotomy_dicom_seg, which alone knows DCMTK. Both
// are built together.

namespace octotomy::voxel {

/// One segment's frames, in the order of their planes.
struct SegmentFile {
  glm::ivec2 size_px{0};
  glm::dvec2 spacing_mm{1.0};  ///< between columns, between rows
  double step_mm = 1.0;        ///< between planes
  glm::dvec3 along_row{1, 0, 0};
  glm::dvec3 along_column{0, 1, 0};
  struct Frame {
    glm::dvec3 first_mm{0.0};
    std::vector<DicomSource::Image> images;  ///< that it comes from
  };
  std::vector<Frame> frames;
  /// Fills a frame's pixels, row by row, with 0 or 1; there is a place for each.
  std::function<void(std::size_t frame, std::uint8_t* pixels)> fill;

  std::map<DicomTag, DicomSource::Text> attributes;  ///< of patient, study and frame of reference
  std::string source_series_uid;                     ///< empty: there is no source
  std::string instance_uid, series_uid, dimensions_uid;
  std::string label, series_description;
};

}  // namespace octotomy::voxel

/// Writes the segmentation to a file; false with one line of reason where that fails.
extern "C" bool octotomy_write_dicom_seg(const octotomy::voxel::SegmentFile* file, const char* path,
                                         std::string* error);
