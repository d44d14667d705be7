// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

// Linear transforms of ITK, as 3D Slicer writes and reads them: .tfm, .txt and .h5, in LPS and millimetres.
namespace octotomy::planner {

/// A linear transform that a file holds, as a motion.
struct TransformFile {
  glm::dmat4 moved_from_still{1.0};   ///< LPS; affine: a file may scale
  std::vector<std::string> findings;  ///< the frame and direction, one rule for all files
};

/// Reads a linear transform: affine, rigid, Euler angles, versor, translation, identity, or a composite of them,
/// whose last one is applied first. ITK's transforms map a place after the motion to the one before, in LPS, so the
/// motion is the inverse; Slicer reads them in the same way. A file is text, or HDF5 by its first bytes. Throws
/// std::runtime_error with path, line and cause: another header, another kind of transform or a grid, several
/// transforms without a composite, numbers that are missing or not finite, no inverse, an HDF5 file that is damaged
/// or of a form that Hdf5File refuses. Source: itk::TxtTransformIO, itk::HDF5TransformIO,
/// itk::MatrixOffsetTransformBase, itk::Euler3DTransform, itk::CompositeTransform.
TransformFile read_itk_transform(const std::filesystem::path& path);

/// A file's format: text, .tfm, or HDF5, .h5.
enum class TransformFormat { Text, Hdf5 };

/// The text of a .tfm file. Reading it returns the same motion to rounding, 1e-12 mm on a head.
/// Precondition: the motion has an inverse.
std::string itk_transform_text(const glm::dmat4& moved_from_still);
/// The bytes of an .h5 file of the same transform, with its exact numbers. Its parameters have the names that
/// ITK itself writes and that all versions of ITK read: without the s of "Trans".
std::string itk_transform_hdf5(const glm::dmat4& moved_from_still);

}  // namespace octotomy::planner
