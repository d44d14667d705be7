// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "voxel/scan/dicom_source.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// How the voxels of several objects are stored.
enum class DicomSegKind {
  /// A frame of bits for each object and plane; objects may share voxels, and every reader supports it.
  Binary,
  /// A frame of object numbers for each plane (Supplement 243); for many objects that share no voxel.
  LabelMap
};

struct DicomSegOptions {
  DicomSegKind kind = DicomSegKind::Binary;
  std::string label = "Object";  ///< label of the file, and of the segment of a single object: 1 to 64
                                 ///< characters
  std::string series_description = "Octotomy";  ///< 1 to 64 characters
  /// The series that the object was made from. The segmentation copies its patient, study and frame of
  /// reference, and each frame refers to the images from which it was made. None, as for a phantom: a new
  /// study.
  std::optional<DicomSource> source = std::nullopt;
  Progress progress = {};
};

/// An object of a segmentation; several may share voxels.
struct DicomSegment {
  std::string label;  ///< 1 to 64 characters
  Octree object;      ///< not empty
};

/// Writes an object as a DICOM segmentation (PS3.3, A.51): one binary segment; one frame for each plane of
/// voxels along the universe's third axis that contains a voxel of the object, cropped to the object. The
/// frames have the octree's voxels and are not resampled to the source's lattice. Unique identifiers are
/// computed from the content: the same object and options produce the same bytes. Written to a temporary file
/// and renamed into place. Throws std::invalid_argument if the object is empty, the universe's axes are not
/// perpendicular or a text is too long; Error (Geometry) if the frames take more than DICOM's 4 GB; Error
/// (Resource or Input) with path and reason; Stopped. Cost: one pass over the planes' pixels; memory: two
/// bits a pixel.
void write_dicom_seg(const Octree& object, const std::filesystem::path& path,
                     const DicomSegOptions& options = {});

/// Writes a segmentation of several named objects of one universe: segment i + 1 is segments[i], each with
/// separate frames, cropped to the rectangle around all objects. A label map has one frame for each plane
/// that contains a voxel of any object. On universe_on() of a scan's lattice each frame lies on a slice of
/// the scan. Also throws std::invalid_argument for no segments, more than 65535 segments, or different
/// universes; Error (Geometry) with both names, if objects of a label map share voxels.
void write_dicom_seg(std::span<const DicomSegment> segments, const std::filesystem::path& path,
                     const DicomSegOptions& options = {});

/// The share of each sample's voxel that an object fills.
struct DicomFractions {
  std::string label;  ///< 1 to 64 characters
  /// One for each sample of the lattice, x fastest; 255: the object fills the whole voxel.
  std::vector<std::uint8_t> fractions;
};

/// Writes shares of voxels as a FRACTIONAL segmentation of the type OCCUPANCY, one byte a pixel. Its frames
/// lie on the planes of the lattice and are chosen as by write_dicom_seg(). Throws as write_dicom_seg() does;
/// also std::invalid_argument if a segment's number of fractions differs from the number of samples, or all
/// fractions are zero.
void write_dicom_fractions(const Lattice& lattice, std::span<const DicomFractions> segments,
                           const std::filesystem::path& path, const DicomSegOptions& options = {});

}  // namespace octotomy::voxel
