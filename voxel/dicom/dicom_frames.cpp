// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "voxel/space/printed.h"

namespace octotomy::voxel {
namespace {

constexpr DicomTag detector_vector_tag = 0x00540020;
constexpr DicomTag slice_vector_tag = 0x00540080;

struct NamedDistance {
  DicomTag tag;
  const char* name;
};

/// For a nuclear medicine image, the number of each frame in a frame vector, counted from 1 (DICOM PS3.3,
/// C.8.4.8). None unless the vector has exactly one number for each frame.
std::optional<std::vector<std::uint16_t>> numbers_of_frames(const DicomFile& file, DicomTag vector,
                                                            std::size_t frames) {
  std::vector<std::uint16_t> numbers = file.unsigned_shorts(vector);
  if (numbers.size() != frames || std::find(numbers.begin(), numbers.end(), 0) != numbers.end())
    return std::nullopt;
  return numbers;
}

/// The attribute that FrameIncrementPointer names if the frames follow each other in time; empty if they do
/// not.
std::string time_between_frames(const DicomFile& file) {
  const std::vector<std::uint16_t> pointers = file.unsigned_shorts(0x00280009);
  for (std::size_t i = 0; i + 1 < pointers.size(); i += 2) {
    const DicomTag tag = DicomTag{pointers[i]} << 16 | pointers[i + 1];
    if (tag == 0x00181063) return "FrameTime";
    if (tag == 0x00181065) return "FrameTimeVector";
  }
  return {};
}

}  // namespace

bool is_nuclear(const std::string& class_uid) {
  return class_uid == "1.2.840.10008.5.1.4.1.1.20";
}

std::optional<NoSlice> not_reconstructed(const DicomFile& file, std::size_t frames) {
  const std::string types = file.text(0x00080008);
  std::string kind = types;
  for (int bar = 0; bar < 2; ++bar)
    kind = kind.find('\\') == std::string::npos ? std::string() : kind.substr(kind.find('\\') + 1);
  kind = kind.substr(0, kind.find('\\'));
  if (kind.starts_with("RECON")) return std::nullopt;
  for (const char* projection : {"STATIC", "DYNAMIC", "GATED", "WHOLE BODY", "TOMO", "GATED TOMO"})
    if (kind == projection)
      return NoSlice{
          "a nuclear medicine image of the kind " + kind +
              ", whose frames are projections and not slices: export the reconstruction (RECON TOMO)",
          NoSlice::Kind::Unusable};
  if (numbers_of_frames(file, slice_vector_tag, frames)) return std::nullopt;
  return NoSlice{
      "a nuclear medicine image whose ImageType does not state RECON TOMO and that has no "
      "SliceVector: its frames may be projections; export the reconstruction",
      NoSlice::Kind::Unusable};
}

std::vector<DicomFile> detectors_of_frames(const DicomFile& file, std::size_t frames) {
  const std::vector<DicomFile> detectors = file.items(0x00540022);
  std::vector<DicomFile> found;
  if (detectors.empty()) return found;
  const auto numbers = numbers_of_frames(file, detector_vector_tag, frames);
  for (std::size_t i = 0; i < frames; ++i) {
    const std::size_t number = numbers ? (*numbers)[i] : 1;
    found.push_back(detectors[std::min(number, detectors.size()) - 1]);
  }
  return found;
}

void take_frame_vectors(const DicomFile& file, std::vector<DicomSlice>& slices) {
  struct Vector {
    DicomTag tag;
    const char* check;
    const char* words;
  };
  for (const Vector& vector :
       {Vector{0x00540010, "acquisition", "energy window"},
        Vector{detector_vector_tag, "acquisition", "detector"}, Vector{0x00540050, "acquisition", "rotation"},
        Vector{0x00540060, "phase", "R-R interval"}, Vector{0x00540070, "phase", "time slot"},
        Vector{0x00540030, "phase", "dynamic phase"}, Vector{0x00540100, "phase", "time slice"}}) {
    const auto numbers = numbers_of_frames(file, vector.tag, slices.size());
    if (!numbers || std::all_of(numbers->begin(), numbers->end(),
                                [&](std::uint16_t number) { return number == numbers->front(); }))
      continue;
    for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait)
      if (dicom_traits[trait].check == std::string_view(vector.check))
        for (std::size_t i = 0; i < slices.size(); ++i) {
          std::string& value = slices[i].traits[trait];
          value +=
              (value.empty() ? "" : ", ") + std::string(vector.words) + " " + std::to_string((*numbers)[i]);
        }
  }
}

std::optional<NoSlice> place_frames(const DicomFile& file, std::vector<DicomSlice>& slices) {
  const std::size_t frames = slices.size();
  if (const auto all = file.decimals(0x00200032); all && all->size() == 3 * frames) {
    for (DicomSlice& slice : slices)
      slice.assumed_place = "the positions that its one ImagePositionPatient lists";
    return std::nullopt;
  }
  const DicomSlice& first = slices.front();
  const double scale = glm::length(glm::cross(first.along_row, first.along_column));
  if (!(scale > 0.0))
    return NoSlice{
        "a multi-frame image without the directions of its rows and columns; export it as single frames",
        NoSlice::Kind::Unusable};
  const glm::dvec3 normal = glm::cross(first.along_row, first.along_column) / scale;
  std::vector<double> offsets_mm;
  std::string how;
  const std::string time = time_between_frames(file);
  const auto slice_numbers = numbers_of_frames(file, slice_vector_tag, frames);
  const auto place = [&](std::size_t i) {
    return slice_numbers ? static_cast<double>((*slice_numbers)[i]) : static_cast<double>(i);
  };
  for (const NamedDistance& named :
       {NamedDistance{0x3004000c, "GridFrameOffsetVector"}, NamedDistance{0x00182005, "SliceLocationVector"}})
    if (const auto vector = file.decimals(named.tag); vector && vector->size() == frames && how.empty()) {
      offsets_mm = *vector;
      how = std::string("the distances that ") + named.name + " lists";
    }
  for (const NamedDistance& named :
       {NamedDistance{0x00180088, "SpacingBetweenSlices"}, NamedDistance{0x00180050, "SliceThickness"}}) {
    const double step_mm =
        named.tag == 0x00180088 ? first.spacing_tag_mm.value_or(0.0) : first.thickness_mm.value_or(0.0);
    if (!how.empty() || step_mm == 0.0 || !(std::abs(step_mm) < 1e6)) continue;
    // In a time series of a single slice, SliceThickness is not a distance between frames.
    if (!time.empty() && named.tag == 0x00180050)
      return NoSlice{
          "a multi-frame image whose frames follow each other in time (FrameIncrementPointer names " + time +
              ") and have no distance: a film is not a volume. If its frames are slices, state "
              "SpacingBetweenSlices",
          NoSlice::Kind::Unusable};
    for (std::size_t i = 0; i < frames; ++i) offsets_mm.push_back(step_mm * place(i));
    how = (slice_numbers ? "SliceVector and " : "") + print("%s, %.6g mm", named.name, step_mm);
    if (!time.empty())
      how += ", although FrameIncrementPointer names " + time + ", as in a film, which is not a volume";
  }
  if (how.empty())
    return NoSlice{
        "a multi-frame image without the positions of its frames or their distance; export it as "
        "single frames",
        NoSlice::Kind::Unusable};
  for (std::size_t i = 0; i < frames; ++i) {
    slices[i].first_mm += (offsets_mm[i] - offsets_mm[0]) * normal;
    slices[i].assumed_place = how + ", along the normal from ImagePositionPatient on";
  }
  return std::nullopt;
}

}  // namespace octotomy::voxel
