// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/scene.h"

namespace octotomy::voxel {

/// Writes a scene as the extension says: .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd. Written beside and renamed
/// into place, so that a failure leaves what was there. Throws std::runtime_error with path and reason.
void write_scene(const Scene& scene, const std::filesystem::path& path);

/// How a scene is cut into DICOM slices. Defaults write the lattice as it is.
struct DicomOptions {
  std::string patient_name = "Phantom^Octotomy";
  std::string series_description = "Octotomy";
  /// Gantry tilt in degrees about the patient's x axis: slices keep their own plane's orientation and their
  /// positions move along y with z, as a tilted scanner's do. The scene must hold the slices as scanned.
  double gantry_tilt_deg = 0.0;
};

/// Writes one CT Image Storage file a slice into a folder, which is made where absent and must hold no file
/// of the same names. Samples are written as int16 with slope 1 and intercept 0 for Hounsfield scenes.
/// Throws std::runtime_error, and std::invalid_argument where samples do not fit int16.
void write_dicom_series(const Scene& scene, const std::filesystem::path& folder,
                        const DicomOptions& options = {});

}  // namespace octotomy::voxel
