// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/volume/frame_words.h"
#include "voxel/volume/stored_samples.h"

namespace octotomy::voxel {

/// The layout of samples in a file without a header, x fastest.
struct RawLayout {
  glm::ivec3 dims{0};
  SampleType type = SampleType::Int16;
  bool big_endian = false;
  std::uint64_t offset = 0;  ///< bytes before the first sample
};

/// Receives a scene while it is being read. The first `count` slices then have their final samples, and the
/// scene passes check().
using SlicesFinal = std::function<void(const Scene& scene, int count)>;

struct ReadOptions {
  /// Selects the DICOM series: by its number in list_series() ("2", or "2.1" for a stack of a series with
  /// several), by its UID, or by a part of its description or of the attributes in which its stacks differ.
  /// Empty: the series with most slices. For a DICOM segmentation: the label or number of the segment whose
  /// fractions, 0 to 1, are the samples; empty: all segments as labels.
  std::string series;
  /// Joins the images of all DICOM series of a folder, and the images of several studies and frames of
  /// reference in one series, into one series: for exports in which each image has its own identifiers. The
  /// images must have the same patient and modality. The audit reports the join as a Fail.
  bool join = false;
  /// The images of the chosen DICOM series that are read, counted from 1 at the lowest along the normal.
  /// Empty: all images.
  std::vector<SliceRange> slices;
  /// The spacing along x, y, z, for image stacks and raw files, which may not state one.
  std::optional<glm::dvec3> spacing_mm;
  std::optional<RawLayout> raw;  ///< set: the path is a raw file
  /// For a volume file, an image stack or a raw file: the patient's directions along which its coordinates
  /// grow. Overrides the file's own statement. read_scene() refuses it for DICOM, which always states its
  /// frame.
  std::optional<PatientFrame> frame = {};
  /// For a volume file: the unit of its spacing and positions. Overrides the file's own statement. Refused
  /// for DICOM, and for image stacks and raw files, whose spacing is in mm.
  std::optional<LengthUnit> unit = {};
  Progress progress;
  /// Called on the reading thread with growing counts, so that work on the first slices can begin during
  /// reading; may be empty. The count of the last call is the number of all slices, or 0 if reading failed.
  /// Before this call returns, work on the scene must have ended. Called only for NIfTI, NRRD and MetaImage
  /// whose 16-bit samples need no conversion.
  SlicesFinal slices_final = {};
};

/// Parses a text such as "1:40", "1:40,45:60" or "7" for ReadOptions::slices. Throws std::invalid_argument
/// with an example.
std::vector<SliceRange> parse_slices(const std::string& text);
/// The text from which parse_slices() returns the same ranges.
std::string to_string(const std::vector<SliceRange>& slices);

/// Reads a scan: a folder or a file of DICOM; NIfTI (.nii, or .hdr beside .img), NRRD or MetaImage; a stack
/// of images (a TIFF of several pages, a folder of images, or a pattern with * and ? in its last part); a raw
/// file. Applies the file's rescale and stores the values as int16 if all are integers in the range of int16,
/// otherwise as float. Geometry is in LPS millimetres for any frame of the file. The scene's audit lists
/// every check and every doubt: missing or repeated slices, uneven spacing, gantry tilt, absent rescale,
/// stray files. Throws Error (Input) with path and reason if no valid scan can be read; Error, Resource;
/// Stopped. Memory: the samples, and one slice or the decoder's copy; twice the samples if slices are
/// resampled. The memory is bounded by a multiple of the file's size.
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options = {});

/// A DICOM series in a folder, or one stack of a series that has several.
struct SeriesEntry {
  std::string uid, description, modality;
  int number = 0;  ///< the scanner's series number
  std::size_t slices = 0;
  glm::ivec2 size_px{0};
  std::string choice = {};  ///< for ReadOptions::series
  /// The attributes in which a stack differs from the series' other stacks: "kernel H60s".
  std::string stack = {};
  glm::dvec2 spacing_mm{0.0};           ///< between columns, between rows
  std::optional<double> slice_mm = {};  ///< mean distance of neighbouring images; none for a single image
  std::string study_date = {};          ///< as the header states it: "20240131"; may be empty
};
/// The series of a folder and its subfolders, most slices first. For a series with several images at one
/// position, its stacks are listed, which differ in kernel, acquisition or phase. Throws as read_scene() does
/// if there is none.
std::vector<SeriesEntry> list_series(const std::filesystem::path& path);

}  // namespace octotomy::voxel
