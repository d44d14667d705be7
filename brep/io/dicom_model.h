// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

#include "brep/io/mesh_statements.h"

namespace octotomy::brep {

/// Whether a file is an STL or OBJ that is encapsulated in DICOM, by its storage class. Returns false also for
/// files that cannot be read.
bool is_dicom_model(const std::filesystem::path& path);

/// The surface inside, with the unit and the frame of the DICOM header. Throws Error (Input) without the path.
/// Precondition: is_dicom_model() accepts the file.
MeshContent read_dicom_model(std::string_view bytes);

}  // namespace octotomy::brep
