// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::tests {

/// One DICOM file of a series, put together attribute by attribute.
struct SpoiledImage {
  std::string name;
  /// Value representation and value by tag; numbers of US, SS and OW little-endian.
  std::map<std::uint32_t, std::pair<std::string, std::string>> elements;
  std::string syntax = "1.2.840.10008.1.2.1";
  bool implicit = false, big_endian = false, has_preamble = true;
  std::string pixels_end = {};    ///< with it, the pixels have no length: these bytes end them
  std::string open_unknown = {};  ///< items and end of an open sequence of unknown representation
  std::function<std::string(std::string)> damage = {};

  void text(std::uint32_t tag, const std::string& vr, const std::string& value) {
    elements[tag] = {vr, value};
  }
  void number(std::uint32_t tag, std::uint16_t value);
  void place(double x_mm, double y_mm, double z_mm);
  std::string bytes() const;
};

/// A sound series of a ball in air: 12 slices of 24 x 20 pixels of 0.5 mm, 2 mm apart, named a00 to a11 from
/// the lowest on.
std::vector<SpoiledImage> sound_series(int count = 12, const std::string& prefix = "a");

/// A kind of doubtful or faulty DICOM folder, and the lines that its audit must contain.
struct SpoiledKind {
  std::string name;
  std::string check;  ///< the audit's line; "refused": reading throws
  voxel::Verdict verdict = voxel::Verdict::Warn;
  std::string says;                ///< a part of the line's or of the refusal's text
  std::vector<std::string> files;  ///< that the line names, in any order
  std::function<void(std::vector<SpoiledImage>&)> spoil;
  std::map<std::string, std::string> others = {};  ///< further files by name

  /// Writes the folder.
  void write(const std::filesystem::path& folder) const;
};

/// All kinds. Their folders hold no patient's data.
const std::vector<SpoiledKind>& spoiled_kinds();

}  // namespace octotomy::tests
