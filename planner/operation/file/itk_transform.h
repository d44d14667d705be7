// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

// Reads and writes linear transforms of ITK, which 3D Slicer also uses: .tfm, .txt and .h5, in LPS and
// millimetres.
namespace octotomy::planner {

/// A linear transform that a file holds, as a motion.
struct TransformFile {
  glm::dmat4 moved_from_still{1.0};   ///< LPS to LPS; affine, because a file may scale
  std::vector<std::string> findings;  ///< states the frame and direction that ITK's files have
};

/// Reads a linear transform: affine, rigid, Euler angles, versor, translation, identity, or a composite of
/// these, whose last transform is applied first. ITK's transforms map a position after the motion to the
/// position before it, in LPS. The motion is therefore the inverse; Slicer reads the files in the same way.
/// The first bytes decide whether a file is HDF5 or text. Throws std::runtime_error with path, line and
/// cause: another header, another kind of transform or a grid, several transforms without a composite,
/// numbers that are missing or not finite, no inverse, an HDF5 file that is damaged or of a form that
/// Hdf5File refuses. Source: itk::TxtTransformIO, itk::HDF5TransformIO, itk::MatrixOffsetTransformBase,
/// itk::Euler3DTransform, itk::CompositeTransform.
TransformFile read_itk_transform(const std::filesystem::path& path);

/// The format of a transform's file: text (.tfm) or HDF5 (.h5).
enum class TransformFormat { Text, Hdf5 };

/// The text of a .tfm file. The motion that is read from it differs by rounding only, 1e-12 mm on a head.
/// Precondition: the motion has an inverse.
std::string itk_transform_text(const glm::dmat4& moved_from_still);
/// The bytes of an .h5 file of the same transform, with exact numbers. Its members have the misspelled names
/// "Tranform..." that ITK writes and all versions of ITK read.
std::string itk_transform_hdf5(const glm::dmat4& moved_from_still);

}  // namespace octotomy::planner
