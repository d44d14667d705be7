// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "voxel/scan/image_file.h"
#include "voxel/space/view.h"
#include "voxel/view/camera.h"

// Positions of a picture's pixels in space. PNG files in true scale that the program writes store them, so
// that users can state a region in pixels.
namespace octotomy::planner {

struct PictureFrame {
  glm::ivec2 size_px{0};
  glm::dmat4 lps_from_pixel{1.0};  ///< from (column, row, 0, 1) to LPS millimetres; whole numbers are pixels'
                                   ///< centres

  /// Looking at the picture.
  voxel::View view() const;
  /// The map from (column, row, 1) to (u, v, 1) in the view's millimetres.
  glm::dmat3 view_mm_from_pixel() const;
};

/// The frame of an orthographic picture. Its pixels lie in the plane of depth 0.
PictureFrame frame_of(const voxel::ImagePlane& plane);

/// The frame as text for a PNG; none without a frame. The frame's `size_px` must be the size of the whole
/// picture, including margins of a grid.
std::optional<voxel::ImageText> image_text(const std::optional<PictureFrame>& frame);

/// Reads the frame from a PNG's bytes. Throws std::runtime_error that begins with `where` if the bytes are
/// not a PNG, contain no frame, or have another size than the picture had when it was drawn.
PictureFrame read_frame(std::string_view png, const std::string& where);
PictureFrame read_frame(const std::filesystem::path& path);

/// The name that parse_view() reads as this view: a named direction or "AZ,EL". Empty if there is none, for
/// example of a view that is rotated in its plane.
std::string name_of(const voxel::View& view);

}  // namespace octotomy::planner
