// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "voxel/scan/dicom_source.h"

namespace octotomy::voxel {

/// The format of a surface's file.
enum class ModelFormat { Stl, Obj };

struct DicomModelOptions {
  std::string label = "Model";                  ///< title of the document: 1 to 64 characters
  std::string series_description = "Octotomy";  ///< 1 to 64 characters
  /// The series that the surface was made from: its patient, study and frame of reference are copied, its
  /// images listed. None: a phantom in a study of its own.
  std::optional<DicomSource> source = std::nullopt;
};

/// Writes a file of a surface as an encapsulated DICOM document (PS3.3, A.85), byte for byte, with millimetres
/// as its measurement unit. `bytes` is the file; its coordinates are LPS millimetres of the source's frame of
/// reference, which is what a reader takes them for. Identifiers are computed from the content. Written to a
/// temporary file and renamed into place. Throws std::invalid_argument if `bytes` are none or a text is too
/// long; Error, Geometry, if there are more than DICOM's 4 GB; Error, Input or Resource, with path and reason.
void write_dicom_model(const std::string& bytes, ModelFormat format, const std::filesystem::path& path,
                       const DicomModelOptions& options = {});

}  // namespace octotomy::voxel
