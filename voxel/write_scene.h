// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "voxel/dicom_source.h"
#include "voxel/scene.h"

namespace octotomy::voxel {

/// Writes a scene as the extension says: .nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd. The samples' type, their
/// meaning and the modality come back on reading. Geometry is kept in double precision; NIfTI's own is
/// single, and what that rounds off stands in an extension that others skip. Written beside and renamed into
/// place, so that a failure leaves what was there. Throws std::runtime_error with path and reason;
/// std::invalid_argument for NIfTI and MetaImage where the lattice's axes are not perpendicular, which those
/// formats cannot say.
void write_scene(const Scene& scene, const std::filesystem::path& path);

struct DicomOptions {
  std::string patient_name = "Phantom^Octotomy";  ///< DICOM's form: family^given; a source's goes before it
  std::string series_description = "Octotomy";    ///< at most 64 characters
  /// The series that the scene was made from: patient, study and frame of reference are taken over from it,
  /// and each slice refers to the images that it comes from. None: a study of its own.
  std::optional<DicomSource> source = std::nullopt;
};

/// Writes one file a slice, of CT or, where that is the scene's modality, MR Image Storage, into a folder,
/// which is made where absent and must hold no file of the same names (slice_0001.dcm and so on). Slice k
/// stands where the lattice has its index k: a lattice whose third axis leans on the first two is a series
/// with gantry tilt. Samples are written as int16 with slope 1, intercept 0; a CT that is not Hounsfield says
/// so in its rescale type. Unique identifiers come from the content: the same scene and options give the same
/// files, byte by byte. Throws std::runtime_error with path and reason, std::invalid_argument where samples
/// are no integers of int16's range, the first two axes are not perpendicular or a text is too long.
void write_dicom_series(const Scene& scene, const std::filesystem::path& folder,
                        const DicomOptions& options = {});

}  // namespace octotomy::voxel
