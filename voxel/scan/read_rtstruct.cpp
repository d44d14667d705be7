// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_rtstruct.h"

#include <algorithm>
#include <fstream>

#include "voxel/scan/dicom_file.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr const char* structure_set_storage = "1.2.840.10008.5.1.4.1.1.481.3";

/// An integer string; 0 if it is absent, no integer, or beyond what any program numbers regions with.
int number_of(const DicomFile& item, DicomTag tag) {
  const double number = item.decimal(tag).value_or(0.0);
  constexpr double most = 1e9;
  return number >= 1.0 && number <= most ? static_cast<int>(number) : 0;
}

void add_contours(const fs::path& path, const DicomFile& of_region, Structure& structure) {
  for (const DicomFile& contour : of_region.items(0x30060040)) {
    const std::string kind = trimmed(contour.text(0x30060042));
    if (kind != "CLOSED_PLANAR" && kind != "CLOSEDPLANAR_XOR") {
      ++structure.others;
      continue;
    }
    const auto numbers = contour.decimals(0x30060050);
    if (!numbers || numbers->size() % 3 != 0 || numbers->size() < 9)
      refuse(path, "a contour of '" + structure.name + "' has no three or more points x, y, z");
    std::vector<glm::dvec3> points;
    for (std::size_t i = 0; i < numbers->size(); i += 3)
      points.emplace_back((*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]);
    structure.contours_mm.push_back(std::move(points));
  }
}

}  // namespace

bool is_rtstruct(const fs::path& path) {
  // The class stands among the first attributes.
  std::string bytes(4096, '\0');
  std::ifstream in = opened(path);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return DicomFile::begins(bytes) && bytes.find(structure_set_storage) != std::string::npos;
}

std::vector<Structure> read_rtstruct(const fs::path& path) {
  const std::string bytes = file_bytes(path);
  try {
    const DicomFile file(bytes, bytes.size());
    std::vector<Structure> structures;
    for (const DicomFile& region : file.items(0x30060020))
      structures.push_back({number_of(region, 0x30060022), trimmed(region.readable_text(0x30060026)), {}, 0});
    if (structures.empty()) refuse(path, "a structure set without regions of interest");
    for (const DicomFile& contours : file.items(0x30060039)) {
      const int number = number_of(contours, 0x30060084);
      const auto found = std::find_if(structures.begin(), structures.end(),
                                      [&](const Structure& each) { return each.number == number; });
      if (found == structures.end())
        refuse(path, "a structure set whose contours belong to region " + std::to_string(number) +
                         ", which it does not name");
      add_contours(path, contours, *found);
    }
    return structures;
  } catch (const DicomFile::Deflated&) {
    refuse(path, "a deflated structure set: inflate it first");
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "a structure set that is cut short");
  } catch (const Error& error) {
    if (std::string(error.what()).find(path.string()) != std::string::npos) throw;
    refuse(path, error.what());
  }
}

}  // namespace octotomy::voxel
