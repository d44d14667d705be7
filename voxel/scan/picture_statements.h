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

/// Statements of one picture, from ImageJ's or OME's description and the format's own tags.
struct StatedPicture {
  std::string program;  ///< "ImageJ" or "OME"; empty if neither is the writer
  /// Stated by the program: a pixel's sizes and the distance between slices.
  std::array<std::optional<double>, 3> size_mm{};
  std::string unit;       ///< unit of size_mm as the program writes it
  std::string not_sizes;  ///< why the program's numbers are not lengths; empty if they are
  /// A pixel's size from the resolution of a page; none for default print resolutions.
  std::optional<glm::dvec2> page_mm;
  std::string further_axis;  ///< "7 times"
  std::string calibration;   ///< of grey values, as ImageJ states it: "-1024 + 1 g, HU"
  bool has_origin = false;
  double images = 1.0;  ///< number of images that the program states for the file
};
/// Reads the statements of a picture. Source: ImageJ's FileSaver and TiffEncoder: the resolution tags are in
/// pixels per unit, and `spacing` is omitted if it is 1 unit. The OME model: a size without a unit is in
/// micrometres.
StatedPicture stated_by(const StoredImage& image);

/// Collects the statements of a stack's pictures and reports where they differ from how the pictures are
/// read.
class PictureStatements {
 public:
  /// Adds a page's statements. A page after the first of its file counts as stating the same as the first
  /// page, unless it has its own description.
  void add(const StoredImage& image, bool is_first_of_file);

  /// The spacing that ImageJ or OME states. Throws Error (Input) with `path` and the missing statement. Does
  /// not use the resolution of a page, because programs write 72 dpi into any picture.
  KnownSpacing spacing(const std::filesystem::path& path) const;

  /// Adds lines to the scene's audit. `is_stated` is whether the scene's spacing is that of spacing().
  void report(Scene& scene, bool is_stated) const;

 private:
  std::size_t count_ = 0, white_zero_ = 0, lossy_ = 0;
  bool differs_ = false;
  StatedPicture first_;
};

}  // namespace octotomy::voxel
