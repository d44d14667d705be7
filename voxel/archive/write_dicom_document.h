// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "voxel/scan/dicom_source.h"

namespace octotomy::voxel {

/// The format of a document's file: Stl and Obj for surfaces, Pdf for reports.
enum class DocumentFormat { Stl, Obj, Pdf };

struct DicomDocumentOptions {
  std::string label = "Document";               ///< title of the document: 1 to 64 characters
  std::string series_description = "Octotomy";  ///< 1 to 64 characters
  /// The series from which the document was made. Its patient and study are copied, for a surface also its
  /// frame of reference; its images are listed. None, as for a phantom: the document gets a new study.
  std::optional<DicomSource> source = std::nullopt;
};

/// Writes a file as an encapsulated DICOM document, byte for byte (PS3.3: A.85 for surfaces, A.45.1 for PDF).
/// `bytes` is the file's content. A surface's coordinates must be LPS millimetres of the source's frame of
/// reference, because readers assume that; its measurement unit is stated as millimetres. For a PDF the
/// object states that the patient's name may stand in it, because reports contain it. Identifiers are
/// computed from the content. Written to a temporary file and renamed into place. Throws
/// std::invalid_argument if `bytes` is empty or a text is too long; Error (Geometry) if `bytes` exceeds
/// DICOM's 4 GB; Error (Input or Resource) with path and reason.
void write_dicom_document(const std::string& bytes, DocumentFormat format, const std::filesystem::path& path,
                          const DicomDocumentOptions& options = {});

}  // namespace octotomy::voxel
