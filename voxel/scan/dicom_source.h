// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_file.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/lattice.h"

namespace octotomy::voxel {

/// Patient, study and images of a DICOM series, for files that are derived from the series: these copy
/// patient and study and refer to the images.
struct DicomSource {
  struct Text {
    std::string vr;  ///< its value representation
    std::string value;
  };
  struct Image {
    std::string class_uid;
    std::string instance_uid;
    /// Position of the image's plane along `normal`, from the frame of reference's origin.
    double height_mm = 0.0;
  };

  /// Patient, study, frame of reference and acquisition by tag, from the first image's file and in its
  /// character set. Attributes that the file lacks are absent.
  std::map<DicomTag, Text> attributes;
  Identity identity;
  std::string series_uid;
  int series_number = 0;
  std::string modality;
  std::vector<Image> images;  ///< sorted along the normal; each frame of a file is an image
  glm::dvec3 normal{0, 0, 1};
  /// Lattice of the images at their stated positions; none if they form no lattice.
  std::optional<Lattice> lattice = {};
  Lattice around = {};  ///< the lattice on which read_scene() returns the samples, which contains all images
  /// The lines of read_scene()'s audit that follow from headers: about the chosen series, the images left
  /// out, and the positions. Lines about samples are absent.
  std::vector<Finding> audit = {};
};

/// The series that read_scene() reads with these options. Throws as read_scene() does.
DicomSource dicom_source(const std::filesystem::path& path, const ReadOptions& options = {});

/// The images from which slice k of a lattice may have been interpolated: all between the slice's lowest and
/// highest corner along the source's normal, and the next image beyond a corner that lies between two images.
/// Frames of one file count as one image.
std::vector<DicomSource::Image> images_behind(const DicomSource& source, const Lattice& lattice, int k);

}  // namespace octotomy::voxel
