// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <vector>

#include "voxel/scene.h"
#include "voxel/stored_samples.h"

namespace octotomy::voxel {

/// Samples of a file without a header, x fastest.
struct RawLayout {
  glm::ivec3 dims{0};
  SampleType type = SampleType::Int16;
  bool big_endian = false;
  std::uint64_t offset = 0;  ///< bytes before the first sample
};

struct ReadOptions {
  /// Which DICOM series: its number in the list (from 1), its UID, or a part of its description; empty: the
  /// one with most slices.
  std::string series;
  /// Of what does not say it: image stacks and raw files. Millimetres along x, y, z.
  std::optional<glm::dvec3> spacing_mm;
  std::optional<RawLayout> raw;  ///< the path is a raw file
  std::stop_token stop;
  std::function<void(double fraction)> progress;  ///< called from the reading thread only
};

/// A stop token was set.
struct Stopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a scan: a folder or a file of DICOM; NIfTI, NRRD or MetaImage; a stack of images (a TIFF of several
/// pages, a folder of images, or a pattern with * and ? in its last part); a raw file. Values are rescaled as
/// the file says and held as int16 where every one of them is an integer of its range, otherwise as float;
/// geometry comes out in LPS millimetres whatever frame the file speaks. The scene's audit lists every check
/// made and every doubt: missing or repeated slices, uneven spacing, gantry tilt, absent rescale, stray
/// files. Throws std::runtime_error with path and reason where nothing sound can be read; Stopped. Memory:
/// bounded by a multiple of the file's size; the samples once, and one slice or the decoder's own copy beside
/// them; twice where slices have to be resampled.
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options = {});

/// A DICOM series as it stands in a folder.
struct SeriesEntry {
  std::string uid, description, modality;
  int number = 0;  ///< the scanner's
  std::size_t slices = 0;
  glm::ivec2 size_px{0};
};
/// The series of a folder and its subfolders, most slices first, as ReadOptions::series counts them. Throws
/// as read_scene() where there is none.
std::vector<SeriesEntry> list_series(const std::filesystem::path& path);

}  // namespace octotomy::voxel
