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

/// Told of a scan that is being read: the first `count` slices of the scene, which passes check(), have their
/// samples.
using SlicesFinal = std::function<void(const Scene& scene, int count)>;

struct ReadOptions {
  /// The DICOM series: its choice in list_series() ("2", or "2.1" of a series that holds several stacks), its
  /// UID, or a part of its description or of the attributes that tell its stacks apart. Empty: the series
  /// with most slices.
  std::string series;
  /// Joins the images of all DICOM series of a folder, and those of several studies and frames of reference
  /// in one series, as if they were one: for exports that give each image identifiers of its own. Their
  /// patient and modality must be one. The audit has a Fail that says so.
  bool join = false;
  /// Of the chosen DICOM series: the images to keep, counted from 1 at the lowest along the normal. Empty:
  /// all.
  std::vector<SliceRange> slices;
  /// Along x, y, z, for files that do not state it: image stacks and raw files.
  std::optional<glm::dvec3> spacing_mm;
  std::optional<RawLayout> raw;  ///< set: the path is a raw file
  /// Of a volume file, an image stack or a raw file: the patient's directions along which the axes of its
  /// coordinates grow, whatever the file states. DICOM states its own; read_scene() refuses another.
  std::optional<PatientFrame> frame = {};
  /// Of a volume file: the unit of its spacing and positions, whatever the file states. Refused as `frame`,
  /// and for image stacks and raw files, whose spacing is in mm.
  std::optional<LengthUnit> unit = {};
  Progress progress;
  /// Called on the reading thread with growing counts, for work on the first slices beside the reading; may
  /// be empty. The last call has all slices, or none if reading fails: work on the scene must be over when it
  /// returns. Never called where reading is more than unpacking samples of 16 bits: of NIfTI, NRRD and
  /// MetaImage.
  SlicesFinal slices_final = {};
};

/// Reads "1:40" or "1:40,45:60" or "7", as images are counted by ReadOptions::slices. Throws
/// std::invalid_argument with an example.
std::vector<SliceRange> parse_slices(const std::string& text);
/// The text that parse_slices() reads back.
std::string to_string(const std::vector<SliceRange>& slices);

/// Reads a scan: a folder or a file of DICOM; NIfTI (.nii, or .hdr beside .img), NRRD or MetaImage; a stack
/// of images (a TIFF of several pages, a folder of images, or a pattern with * and ? in its last part); a raw
/// file. Applies the file's rescale and holds the values as int16 if all are integers in its range, otherwise
/// as float. Geometry is in LPS millimetres for any frame of the file. The scene's audit lists every check
/// and every doubt: missing or repeated slices, uneven spacing, gantry tilt, absent rescale, stray files.
/// Throws Error, Input, with path and reason if nothing sound can be read; Error, Resource; Stopped. Memory:
/// the samples once, and one slice or the decoder's own copy; twice if slices are resampled; bounded by a
/// multiple of the file's size.
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options = {});

/// A DICOM series found in a folder, or one of several stacks in it.
struct SeriesEntry {
  std::string uid, description, modality;
  int number = 0;  ///< the scanner's
  std::size_t slices = 0;
  glm::ivec2 size_px{0};
  std::string choice = {};  ///< for ReadOptions::series
  std::string stack = {};   ///< the attributes that tell it from the series' other stacks: "kernel H60s"
};
/// The series of a folder and its subfolders, most slices first. A series in which several images lie at one
/// place is listed by its stacks, which a kernel, an acquisition or a phase tells apart. Throws as
/// read_scene() if there is none.
std::vector<SeriesEntry> list_series(const std::filesystem::path& path);

}  // namespace octotomy::voxel
