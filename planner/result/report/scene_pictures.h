// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/picture/drawn_files.h"
#include "planner/plan/evaluate.h"
#include "voxel/view/render.h"

namespace octotomy::planner {

/// Colour of bone that belongs to no piece.
inline constexpr glm::vec3 bone_colour{0.91f, 0.87f, 0.79f};

/// A square picture and its frame, for drawing scales or polygons over it.
struct ScenePicture {
  std::string view;  ///< in the form of voxel::parse_view()
  voxel::View axes;
  glm::dvec2 centre_mm{0.0};  ///< in the view's millimetres
  double width_mm = 0.0;
  int size_px = 0;
  std::vector<std::uint8_t> png;
};

/// Pictures that belong together, and the colours of their objects.
struct PictureGroup {
  std::string name;   ///< prefix of file names: "after"
  std::string title;  ///< title to show to readers
  std::vector<voxel::DrawnObject> objects;
  std::vector<ScenePicture> pictures;
  /// Positions at which numbers, from 1, are written on the pictures.
  std::vector<glm::dvec3> marks_mm = {};
  /// The largest distance of the colour scale; none: colours identify objects.
  std::optional<double> most_mm = std::nullopt;
};

/// The final pieces of a plan and, in the same colours, their originals before they were moved.
struct FinalScene {
  std::vector<voxel::DrawnObject> before;
  std::vector<voxel::DrawnObject> after;
  bool moves = false;  ///< before and after differ
};

/// The last union of named pieces (`rest | advanced`), each piece in a colour of its own; if the plan has
/// none, its last object that is neither a mask nor empty, if any. Moved pieces have the same colour in
/// `before`. A piece that was cut from an object that an earlier step had moved is shown there as the
/// original bone, so that `before` is the untouched patient. If a plan adds bone of a flap or mirrored bone,
/// `before` shows the originals of the other pieces.
FinalScene final_scene(const Plan& plan, const Evaluation& evaluation);

/// A picture before it is encoded, and its frame.
struct DrawnView {
  ScenePicture frame;  ///< frame, without its png
  voxel::Picture pixels;
};
/// Draws objects in a view relative to the head's orientation, framed by the visible parts of `framed`.
DrawnView draw_view(const std::vector<voxel::DrawnObject>& objects,
                    const std::vector<voxel::DrawnObject>& framed, const std::string& view,
                    const glm::dmat3& lps_from_head, int size_px);

/// Draws the group's objects from every view. In each view, pictures of all groups with the same `framed`
/// have the same scale and centre. Draws nothing if there are no objects.
void draw(PictureGroup& group, const std::vector<std::string>& views,
          const std::vector<voxel::DrawnObject>& framed, int size_px,
          const glm::dmat3& lps_from_head = glm::dmat3(1.0));

/// The six views along the axes and, last, two oblique ones.
std::vector<std::string> all_views();

}  // namespace octotomy::planner
