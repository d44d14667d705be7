// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::tests {

/// A scan as ITK reads it: NRRD, MetaImage or NIfTI by the file's extension; for a folder, its DICOM series.
struct ItkVolume {
  glm::ivec3 dims{0};
  glm::dvec3 spacing_mm{0.0};
  glm::dmat4 lps_from_voxel{1.0};
  std::vector<double> samples;  ///< x fastest
};

/// Throws std::runtime_error with ITK's reason.
ItkVolume read_by_itk(const std::filesystem::path& path);

}  // namespace octotomy::tests
