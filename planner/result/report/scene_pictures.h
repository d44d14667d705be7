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

/// A square picture with its frame, so that scales and polygons can be drawn over it.
struct ScenePicture {
  std::string view;  ///< as voxel::parse_view() reads it
  voxel::View axes;
  glm::dvec2 centre_mm{0.0};  ///< in the view's millimetres
  double width_mm = 0.0;
  int size_px = 0;
  std::vector<std::uint8_t> png;
};

/// Pictures of the same objects from several views.
struct PictureGroup {
  std::string name;   ///< prefix of file names: "after"
  std::string title;  ///< title for readers
  std::vector<voxel::DrawnObject> objects;
  std::vector<ScenePicture> pictures;
  /// Points at which the pictures show the numbers 1, 2, ...
  std::vector<glm::dvec3> marks_mm = {};
  /// Distance at the ends of the colour scale. None: colours identify objects.
  std::optional<double> most_mm = std::nullopt;
};

/// The pieces at the end of a plan and, in the same colours, their originals before any motion.
struct FinalScene {
  std::vector<voxel::DrawnObject> before;
  std::vector<voxel::DrawnObject> after;
  bool moves = false;  ///< before and after differ
};

/// The scene at the end of a plan: the pieces of the last union of named pieces (`rest | advanced`), each in
/// another colour. If there is no such union, it is the last object that is neither a mask nor empty.
/// `before` shows each piece before its motion, in the same colour. A piece that was cut from an already
/// moved object is shown as the original bone, so that `before` is the untouched patient. Bone of a flap and
/// mirrored bone do not appear in `before`.
FinalScene final_scene(const Plan& plan, const Evaluation& evaluation);

/// A picture that is not encoded yet, with its frame.
struct DrawnView {
  ScenePicture frame;  ///< frame, without its png
  voxel::Picture pixels;
};
/// Draws objects in a view relative to the head's orientation. The frame is that of the visible parts of
/// `framed`.
DrawnView draw_view(const std::vector<voxel::DrawnObject>& objects,
                    const std::vector<voxel::DrawnObject>& framed, const std::string& view,
                    const glm::dmat3& lps_from_head, int size_px);

/// Draws the objects of a group from each view. Pictures of the same view have the same scale and centre in
/// all groups with the same `framed`. Draws nothing if there are no objects.
void draw(PictureGroup& group, const std::vector<std::string>& views,
          const std::vector<voxel::DrawnObject>& framed, int size_px,
          const glm::dmat3& lps_from_head = glm::dmat3(1.0));

/// The six views along the axes, followed by two oblique ones.
std::vector<std::string> all_views();

}  // namespace octotomy::planner
