// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "voxel/archive/png_pixels.h"

namespace octotomy::voxel {

/// A document or a colour picture from a DICOM archive.
struct ArchivedObject {
  std::string class_uid;
  std::string kind;        ///< such as "encapsulated CDA"
  std::string media_type;  ///< of a document
  std::string title;       ///< a document's title, or a picture's comment
  std::string patient_name, patient_id, study_uid, series_uid;
  bool is_identity_removed = false;
  std::string document;  ///< its bytes, without padding
  std::optional<ColourPixels> picture = std::nullopt;
};

/// Reads an encapsulated PDF, CDA, STL or OBJ, or an uncompressed secondary capture of three 8-bit channels.
/// None if the file is no DICOM file, or another kind of object, such as images of a scan. Texts are UTF-8
/// without control characters. Throws Error (Input) with path and reason, if such an object is damaged, or
/// states more bytes than it has. Memory: twice the file's size.
std::optional<ArchivedObject> read_archived(const std::filesystem::path& path);

}  // namespace octotomy::voxel
