// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "voxel/scan/image_file_oiio.h"
#include "voxel/scan/read_raw.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// What one picture states: ImageJ's and OME's descriptions, and the format's own tags.
struct StatedPicture {
  std::string program;                             ///< "ImageJ" or "OME"; empty where neither is the writer
  std::array<std::optional<double>, 3> size_mm{};  ///< by the program: a pixel's, and from slice to slice
  std::string unit;                                ///< in the program's word
  std::string not_sizes;              ///< why the program's numbers are no lengths; empty where they are
  std::optional<glm::dvec2> page_mm;  ///< a pixel's size by the resolution of a page; none of print defaults
  std::string further_axis;           ///< "7 times"
  std::string calibration;            ///< of grey values, as ImageJ states it: "-1024 + 1 g, HU"
  bool has_origin = false;
  double images = 1.0;  ///< in the file
};
/// Source: ImageJ's FileSaver and TiffEncoder: pixels a unit are the resolution tags, `spacing` is left out
/// where it is 1 unit. The OME model: a size without a unit is in micrometres.
StatedPicture stated_by(const StoredImage& image);

/// Holds what the pictures of a stack state about themselves against how they are read.
class PictureStatements {
 public:
  /// Of a file's further pages only what they state themselves counts.
  void add(const StoredImage& image, bool is_first_of_file);

  /// The spacing that ImageJ or OME state. Throws Error, Input, naming `path` and what is missing. The
  /// resolution of a page is no spacing of a patient: programs write 72 dpi into anything.
  KnownSpacing spacing(const std::filesystem::path& path) const;

  /// Adds the audit's lines; `is_stated`: the scene's spacing is spacing().
  void report(Scene& scene, bool is_stated) const;

 private:
  std::size_t count_ = 0, white_zero_ = 0, lossy_ = 0;
  bool differs_ = false;
  StatedPicture first_;
};

}  // namespace octotomy::voxel
