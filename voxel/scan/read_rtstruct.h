// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace octotomy::voxel {

/// A region of interest of a DICOM structure set.
struct Structure {
  int number = 0;
  std::string name;                                  ///< as written, in UTF-8
  std::vector<std::vector<glm::dvec3>> contours_mm;  ///< closed and planar, LPS; the closing edge is implied
  std::size_t others = 0;                            ///< points and open lines, which enclose nothing
};

/// Whether a file is a DICOM structure set, by its storage class. False also of files that cannot be read.
bool is_rtstruct(const std::filesystem::path& path);

/// The regions of a structure set (PS3.3, A.19), in their order, those without contours too. Nothing is
/// promised of how contours lie to each other. Throws Error, Input, with path and reason. Memory: the file
/// and its points.
std::vector<Structure> read_rtstruct(const std::filesystem::path& path);

}  // namespace octotomy::voxel
