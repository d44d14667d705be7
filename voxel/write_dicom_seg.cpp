// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/write_dicom_seg.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <dlfcn.h>
#include <stdexcept>

#include "voxel/dicom_seg_dcmtk.h"
#include "voxel/dicom_values.h"
#include "voxel/program_folder.h"
#include "voxel/slice_bits.h"
#include "voxel/staging.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;
using Write = decltype(&octotomy_write_dicom_seg);

/// Loads the library once, on first use: linked in, DCMTK would cost every start of the program 13 ms.
Write library() {
  const fs::path path = program_folder() / "octotomy_dicom_seg.so";
  void* loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* symbol = loaded == nullptr ? nullptr : dlsym(loaded, "octotomy_write_dicom_seg");
  if (symbol == nullptr)
    throw std::runtime_error(path.string() + ": DICOM segmentations cannot be written: " + dlerror() +
                             "; the library belongs beside the program, and DCMTK must be installed");
  return reinterpret_cast<Write>(symbol);
}

void check_text(const std::string& text, const char* name) {
  if (text.empty() || text.size() > 64 || text.find('\\') != std::string::npos)
    throw std::invalid_argument(std::string(name) + " '" + text +
                                "' must have 1 to 64 characters and no backslash");
}

/// The planes that hold a voxel, and the smallest rectangle that holds all of theirs.
struct Extent {
  std::vector<int> planes;
  glm::ivec2 low{0};
  glm::ivec2 high{-1};  ///< inclusive
};

/// Puts every plane's words into the digest on the way.
Extent extent_of(const Octree& object, const std::stop_token& stop, DicomDigest& digest) {
  const int side = object.universe().side();
  Extent extent;
  extent.low = glm::ivec2(side);
  SliceBits slice;
  for (int z = 0; z < side; ++z) {
    if (stop.stop_requested()) throw Stopped("stopped before the segmentation was written");
    read_slice(object, z, slice);
    bool held = false;
    for (int y = 0; y < side; ++y)
      for (int word = 0; word < slice.words_per_row; ++word) {
        const std::uint64_t bits = slice.row(y)[word];
        if (bits == 0) continue;
        held = true;
        extent.low = glm::min(extent.low, glm::ivec2(64 * word + std::countr_zero(bits), y));
        extent.high = glm::max(extent.high, glm::ivec2(64 * word + 63 - std::countl_zero(bits), y));
      }
    if (!held) continue;
    extent.planes.push_back(z);
    digest.add(&z, sizeof z);
    digest.add(slice.words.data(), slice.words.size() * sizeof slice.words[0]);
  }
  if (extent.planes.empty())
    throw std::invalid_argument("the object is empty: a segmentation of nothing says nothing");
  return extent;
}

/// A patient and a study of its own where there is no source.
std::map<DicomTag, DicomSource::Text> attributes_of(const DicomSegOptions& options,
                                                    const DicomDigest& digest) {
  std::map<DicomTag, DicomSource::Text> attributes;
  if (options.source) attributes = options.source->attributes;
  const auto fall_back = [&](DicomTag tag, const char* vr, const std::string& value) {
    attributes.emplace(tag, DicomSource::Text{vr, value});
  };
  if (!options.source) {
    fall_back(0x00100010, "PN", "Phantom^Octotomy");
    fall_back(0x00100020, "LO", "OCTOTOMY");
    fall_back(0x00080020, "DA", "20000101");
    fall_back(0x00080030, "TM", "000000");
  }
  fall_back(0x0020000d, "UI", digest.uid("study"));
  fall_back(0x00200052, "UI", digest.uid("frame"));
  return attributes;
}

SegmentFile segment_file(const Octree& object, const DicomSegOptions& options) {
  const Universe& universe = object.universe();
  const Lattice lattice = universe.lattice();
  SegmentFile file;
  const glm::dvec3 edge_mm = lattice.spacing_mm();
  const auto axis = [&](int i) { return glm::dvec3(universe.lps_from_voxel[i]) / edge_mm[i]; };
  // Decimal strings keep 13 digits at worst; what single precision rounds off is no right angle lost.
  for (int i = 0; i < 3; ++i)
    if (std::abs(glm::dot(axis(i), axis((i + 1) % 3))) > 1e-6)
      throw std::invalid_argument("a segmentation's rows, columns and planes must be perpendicular");
  DicomDigest digest;
  digest.add(&universe.lps_from_voxel, sizeof universe.lps_from_voxel);
  digest.add(options.label);
  digest.add(options.series_description);
  if (options.source) digest.add(options.source->series_uid);
  const Extent extent = extent_of(object, options.stop, digest);
  file.size_px = extent.high - extent.low + 1;
  file.spacing_mm = glm::dvec2(edge_mm);
  file.step_mm = edge_mm.z;
  file.along_row = axis(0);
  file.along_column = axis(1);
  for (const int z : extent.planes) {
    file.frames.push_back({lattice.lps_mm(glm::dvec3(extent.low, z)), {}});
    if (options.source) file.frames.back().images = images_behind(*options.source, lattice, z);
  }
  file.fill = [&object, extent, stop = options.stop, slice = SliceBits()](std::size_t frame,
                                                                          std::uint8_t* pixels) mutable {
    if (stop.stop_requested()) throw Stopped("stopped before the segmentation was written");
    read_slice(object, extent.planes[frame], slice);
    for (int y = extent.low.y; y <= extent.high.y; ++y)
      for (int x = extent.low.x; x <= extent.high.x; ++x)
        *pixels++ = static_cast<std::uint8_t>((slice.row(y)[x / 64] >> (x % 64)) & 1);
  };
  file.attributes = attributes_of(options, digest);
  if (options.source) file.source_series_uid = options.source->series_uid;
  file.instance_uid = digest.uid("segmentation");
  file.series_uid = digest.uid("series");
  file.dimensions_uid = digest.uid("dimensions");
  file.label = options.label;
  file.series_description = options.series_description;
  return file;
}

}  // namespace

void write_dicom_seg(const Octree& object, const fs::path& path, const DicomSegOptions& options) {
  check_text(options.label, "label");
  check_text(options.series_description, "series_description");
  const SegmentFile file = segment_file(object, options);
  static const Write write = library();
  Staging staging(path.parent_path());
  std::string error;
  const bool written = write(&file, (staging.folder() / path.filename()).c_str(), &error);
  if (options.stop.stop_requested()) throw Stopped("stopped before the segmentation was written");
  if (!written)
    throw std::runtime_error(path.string() + ": cannot be written as a DICOM segmentation: " + error);
  staging.commit();
}

}  // namespace octotomy::voxel
