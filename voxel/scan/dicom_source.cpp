// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/dicom_source.h"

#include <algorithm>
#include <array>
#include <limits>

#include "voxel/scan/dicom_series.h"
#include "voxel/scan/slice_plan.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

struct SharedAttribute {
  DicomTag tag;
  const char* vr;
};
/// The attributes that images of one patient, study and frame of reference share (DICOM PS3.3, C.7.1 to
/// C.7.4), and those of the acquisition that an MR image must state (C.8.3.1).
constexpr std::array<SharedAttribute, 28> shared_attributes{
    {{0x00080005, "CS"}, {0x00080020, "DA"}, {0x00080030, "TM"}, {0x00080050, "SH"}, {0x00080090, "PN"},
     {0x00081030, "LO"}, {0x00100010, "PN"}, {0x00100020, "LO"}, {0x00100030, "DA"}, {0x00100040, "CS"},
     {0x00101010, "AS"}, {0x00101020, "DS"}, {0x00101030, "DS"}, {0x00180015, "CS"}, {0x00180020, "CS"},
     {0x00180021, "CS"}, {0x00180022, "CS"}, {0x00180023, "CS"}, {0x00180080, "DS"}, {0x00180081, "DS"},
     {0x00180083, "DS"}, {0x00180091, "IS"}, {0x00185100, "CS"}, {0x0020000d, "UI"}, {0x00200010, "SH"},
     {0x00200052, "UI"}, {0x00200060, "CS"}, {0x00201040, "LO"}}};

/// Files state positions to a hundredth of a millimetre or better. Planes closer than this count as one.
constexpr double same_plane_mm() {
  return 0.01;
}

/// A frame's identifier consists of its file's identifier, '#' and the frame's number.
std::string file_uid(const std::string& instance_uid) {
  return instance_uid.substr(0, instance_uid.find('#'));
}

}  // namespace

DicomSource dicom_source(const fs::path& path, const ReadOptions& options) {
  DicomSource source;
  const DicomStack stack = stack_of_series(path, options, source.audit);
  source.normal = stack.normal;
  source.identity = stack.first().identity;
  source.series_uid = stack.first().series_uid;
  source.series_number = stack.first().series_number;
  source.modality = stack.first().modality;
  for (const DicomSlice& slice : stack.slices)
    source.images.push_back(
        {slice.class_uid, file_uid(slice.instance_uid), glm::dot(slice.first_mm, stack.normal)});
  const SlicePlan plan = slice_plan(stack, path, source.audit);
  source.around = lattice_of(stack, plan);
  if (plan.is_copy()) source.lattice = source.around;
  std::string stored = file_bytes(stack.first().path);
  try {
    const std::string bytes = whole_dicom(std::move(stored));
    const DicomFile file(bytes, bytes.size(), true);
    for (const auto& [tag, vr] : shared_attributes)
      if (std::string value = file.text(tag); !value.empty())
        source.attributes.emplace(tag, DicomSource::Text{vr, std::move(value)});
  } catch (const DicomFile::NeedsMore&) {
    refuse(stack.first().path, "changed while it was read: read it again");
  }
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
