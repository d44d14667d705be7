// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_rtstruct.h"

#include <algorithm>
#include <fstream>
#include <optional>

#include "voxel/dicom/dicom_file.h"
#include "voxel/dicom/identity.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr const char* structure_set_storage = "1.2.840.10008.5.1.4.1.1.481.3";

/// The value of an integer string; 0 if it is absent, not an integer, or larger than programs number regions.
int number_of(const DicomFile& item, DicomTag tag) {
  const double number = item.decimal(tag).value_or(0.0);
  constexpr double most = 1e9;
  return number >= 1.0 && number <= most ? static_cast<int>(number) : 0;
}

/// The offset of a contour's plane from its points (DICOM PS3.3, C.8.8.6); zero if the contour states none,
/// none if it is not a vector.
std::optional<glm::dvec3> offset_of(const DicomFile& contour) {
  if (trimmed(contour.text(0x30060045)).empty()) return glm::dvec3(0.0);
  const auto numbers = contour.decimals(0x30060045);
  if (!numbers || numbers->size() != 3) return std::nullopt;
  return glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

void add_contours(const DicomFile& of_region, Structure& structure) {
  bool is_slab = true;
  for (const DicomFile& contour : of_region.items(0x30060040)) {
    const std::string kind = trimmed(contour.text(0x30060042));
    if (kind != "CLOSED_PLANAR" && kind != "CLOSEDPLANAR_XOR" && kind != "INTERPOLATED_PLANAR") {
      ++structure.others;
      continue;
    }
    structure.is_interpolated |= kind == "INTERPOLATED_PLANAR";
    const auto numbers = contour.decimals(0x30060050);
    if (!numbers || numbers->size() % 3 != 0) {
      structure.flaw = "a contour's points are not triples of numbers x, y, z";
      continue;
    }
    if (const int stated = number_of(contour, 0x30060046);
        stated > 0 && static_cast<std::size_t>(stated) != numbers->size() / 3 &&
        structure.miscounted++ == 0) {
      structure.stated_points = static_cast<std::size_t>(stated);
      structure.held_points = numbers->size() / 3;
    }
    if (numbers->size() < 9) {
      ++structure.degenerate;
      continue;
    }
    const double slab_mm = contour.decimal(0x30060044).value_or(0.0);
    is_slab &= slab_mm > 0.0;
    structure.slab_mm = !is_slab                  ? 0.0
                        : structure.slab_mm > 0.0 ? std::min(structure.slab_mm, slab_mm)
                                                  : slab_mm;
    const std::optional<glm::dvec3> offset_mm = offset_of(contour);
    if (!offset_mm) {
      structure.flaw =
          "a contour's ContourOffsetVector is not three numbers, so that the contour's place is unknown";
      continue;
    }
    structure.moved += *offset_mm != glm::dvec3(0.0);
    if (glm::length(*offset_mm) > glm::length(structure.farthest_offset_mm))
      structure.farthest_offset_mm = *offset_mm;
    std::vector<glm::dvec3> points;
    for (std::size_t i = 0; i < numbers->size(); i += 3)
      points.push_back(glm::dvec3((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]) + *offset_mm);
    structure.contours_mm.push_back(std::move(points));
    structure.slabs_mm.push_back(std::max(slab_mm, 0.0));
  }
}

void add_uid(std::vector<std::string>& uids, std::string uid) {
  uid = trimmed(uid);
  if (!uid.empty() && std::find(uids.begin(), uids.end(), uid) == uids.end()) uids.push_back(std::move(uid));
}

/// The identity of the file, with the studies, series and frames of reference to which it refers.
Identity identity_of_set(const DicomFile& file) {
  Identity identity = identity_of(file);
  for (const DicomFile& frame : file.items(0x30060010)) {
    add_uid(identity.frame_uids, frame.text(0x00200052));
    for (const DicomFile& study : frame.items(0x30060012)) {
      add_uid(identity.study_uids, study.text(0x00081155));
      for (const DicomFile& series : study.items(0x30060014))
        add_uid(identity.referred_series_uids, series.text(0x0020000e));
    }
  }
  return identity;
}

}  // namespace

bool is_rtstruct(const fs::path& path) {
  // The storage class is among the first attributes, so the beginning of the file suffices.
  std::string bytes(4096, '\0');
  std::ifstream in = opened(path);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return DicomFile::begins(bytes) && bytes.find(structure_set_storage) != std::string::npos;
}

StructureSet read_rtstruct(const fs::path& path) {
  std::string stored = file_bytes(path);
  try {
    const std::string bytes = whole_dicom(std::move(stored));
    const DicomFile file(bytes, bytes.size(), true);
    StructureSet set{{}, identity_of_set(file)};
    std::vector<Structure>& structures = set.structures;
    for (const DicomFile& region : file.items(0x30060020)) {
      Structure& structure = structures.emplace_back();
      structure.number = number_of(region, 0x30060022);
      structure.name = trimmed(region.readable_text(0x30060026));
      add_uid(structure.frame_uids, region.text(0x30060024));
    }
    if (structures.empty()) refuse(path, "a structure set without regions of interest");
    for (const DicomFile& contours : file.items(0x30060039)) {
      const int number = number_of(contours, 0x30060084);
      const auto found = std::find_if(structures.begin(), structures.end(),
                                      [&](const Structure& each) { return each.number == number; });
      if (found == structures.end())
        refuse(path, "a structure set whose contours belong to region " + std::to_string(number) +
                         ", which it does not define");
      add_contours(contours, *found);
    }
    return set;
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "a structure set that is cut short");
  } catch (const Error& error) {
    if (std::string(error.what()).find(path.string()) != std::string::npos) throw;
    refuse(path, error.what());
  }
}

}  // namespace octotomy::voxel
