// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "voxel/scan/image_file.h"
#include "voxel/space/view.h"
#include "voxel/view/camera.h"

// The position of a picture's pixels in its view. PNG files in true scale that the program writes store it,
// so that a region can be stated in their pixels.
namespace octotomy::planner {

struct PictureFrame {
  glm::ivec2 size_px{0};
  glm::dmat4 lps_from_pixel{1.0};  ///< of (column, row, 0, 1); whole numbers are pixels' centres

  /// Looking at the picture.
  voxel::View view() const;
  /// Maps (column, row, 1) to (u, v, 1) in the view's millimetres.
  glm::dmat3 view_mm_from_pixel() const;
};

/// The frame of an orthographic picture, in the plane of depth 0.
PictureFrame frame_of(const voxel::ImagePlane& plane);

/// The frame as text for a PNG; `size_px` is that of the whole picture, with a grid's margin.
std::optional<voxel::ImageText> image_text(const std::optional<PictureFrame>& frame);

/// The frame stored in a PNG's bytes. Throws std::runtime_error beginning with `where` if they are no PNG,
/// hold no frame, or have another size than when they were drawn.
PictureFrame read_frame(std::string_view png, const std::string& where);
PictureFrame read_frame(const std::filesystem::path& path);

/// The name from which parse_view() makes this view, or "AZ,EL" if the view has no name. Empty if
/// parse_view() cannot make it, such as a view that is rotated in its own plane.
std::string name_of(const voxel::View& view);

}  // namespace octotomy::planner
