// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom_source.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "voxel/dicom_series.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

/// What the images of one patient, study and frame of reference share (DICOM PS3.3, C.7.1 to C.7.4), and what
/// an MR image must say of its acquisition (C.8.3.1).
constexpr std::array<DicomTag, 28> shared_tags{
    0x00080005, 0x00080020, 0x00080030, 0x00080050, 0x00080090, 0x00081030, 0x00100010,
    0x00100020, 0x00100030, 0x00100040, 0x00101010, 0x00101020, 0x00101030, 0x00180020,
    0x00180021, 0x00180022, 0x00180023, 0x00180080, 0x00180081, 0x00180083, 0x00180091,
    0x00185100, 0x0020000d, 0x00200010, 0x00200052, 0x00201040, 0x00080060, 0x00200011};

/// Positions are printed to a hundredth of a millimetre at worst; nearer is the same plane.
constexpr double same_plane_mm() {
  return 0.01;
}

/// A frame's identifier is its file's, a mark and its number.
std::string file_uid(const std::string& instance_uid) {
  return instance_uid.substr(0, instance_uid.find('#'));
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

DicomSource dicom_source(const fs::path& path, const ReadOptions& options) {
  std::vector<Finding> ignored;  // reading the scan itself says them
  const DicomStack stack = stack_of_series(path, options, ignored);
  DicomSource source;
  source.normal = stack.normal;
  source.series_uid = stack.first().series_uid;
  source.modality = stack.first().modality;
  for (const DicomSlice& slice : stack.slices)
    source.images.push_back(
        {slice.class_uid, file_uid(slice.instance_uid), glm::dot(slice.first_mm, stack.normal)});
  const std::string bytes = bytes_of(stack.first().path);
  const auto take = [&](const DicomFile& file) {
    for (const DicomTag tag : shared_tags)
      if (std::string text = file.text(tag); !text.empty()) source.attributes.emplace(tag, std::move(text));
  };
  with_dicom_file(bytes, take);
  return source;
}

std::vector<DicomSource::Image> images_behind(const DicomSource& source, const Lattice& lattice, int k) {
  double low_mm = std::numeric_limits<double>::infinity();
  double high_mm = -low_mm;
  for (int corner = 0; corner < 4; ++corner) {
    const glm::dvec3 p_voxel((corner & 1) * (lattice.dims.x - 1), (corner >> 1) * (lattice.dims.y - 1), k);
    const double height_mm = glm::dot(lattice.lps_mm(p_voxel), source.normal);
    low_mm = std::min(low_mm, height_mm);
    high_mm = std::max(high_mm, height_mm);
  }
  const auto above = [](double height_mm) {
    return [height_mm](const DicomSource::Image& image) { return image.height_mm < height_mm; };
  };
  const auto begin = source.images.begin();
  const auto end = source.images.end();
  auto first = std::partition_point(begin, end, above(low_mm - same_plane_mm()));
  auto last = std::partition_point(begin, end, above(high_mm + same_plane_mm()));
  const bool starts_on_one = first != end && first->height_mm <= low_mm + same_plane_mm();
  const bool ends_on_one = last != begin && std::prev(last)->height_mm >= high_mm - same_plane_mm();
  if (!starts_on_one && first != begin) --first;
  if (!ends_on_one && last != end) ++last;
  std::vector<DicomSource::Image> images;
  for (auto image = first; image != last; ++image)
    if (images.empty() || images.back().instance_uid != image->instance_uid) images.push_back(*image);
  return images;
}

}  // namespace octotomy::voxel
