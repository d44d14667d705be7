// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "voxel/dicom_file.h"
#include "voxel/lattice.h"
#include "voxel/read_scene.h"

namespace octotomy::voxel {

/// The DICOM series that something is made from: whose it is, and its images, for what is made to refer to.
struct DicomSource {
  struct Text {
    std::string vr;  ///< its value representation
    std::string value;
  };
  struct Image {
    std::string class_uid;
    std::string instance_uid;
    double height_mm = 0.0;  ///< of its plane along `normal`, from the frame of reference's origin
  };

  /// Patient, study, frame of reference and acquisition by tag, as the first image's file has them, in its
  /// character set; those that the file has and that what is made from it takes over.
  std::map<DicomTag, Text> attributes;
  std::string series_uid;
  int series_number = 0;
  std::string modality;
  std::vector<Image> images;  ///< along the normal; frames of one file are one image each
  glm::dvec3 normal{0, 0, 1};
};

/// The series that a scan was read from with these options. Throws as read_scene().
DicomSource dicom_source(const std::filesystem::path& path, const ReadOptions& options = {});

/// The images that slice k of a lattice can have been interpolated from: those between its lowest and its
/// highest corner along the source's normal, and the next beyond either where none lies there. No image twice
/// where frames of one file are meant.
std::vector<DicomSource::Image> images_behind(const DicomSource& source, const Lattice& lattice, int k);

}  // namespace octotomy::voxel
