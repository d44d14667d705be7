// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/operation/picture/drawn_files.h"
#include "planner/plan/evaluate.h"
#include "voxel/view/render.h"

namespace octotomy::planner {

/// Bone of no piece in particular.
inline constexpr glm::vec3 bone_colour{0.91f, 0.87f, 0.79f};

/// A square picture and what its frame shows, for whoever draws scales or polygons over it.
struct ScenePicture {
  std::string view;  ///< as voxel::parse_view reads it
  voxel::View axes;
  glm::dvec2 centre_mm{0.0};  ///< in the view's millimetres
  double width_mm = 0.0;
  int size_px = 0;
  std::vector<std::uint8_t> png;
};

/// Pictures that belong together, and the colours of what they show.
struct PictureGroup {
  std::string name;   ///< a file name's beginning: "after"
  std::string title;  ///< for people
  std::vector<voxel::DrawnObject> objects;
  std::vector<ScenePicture> pictures;
  /// Numbers of places, from 1, written on the pictures.
  std::vector<glm::dvec3> marks_mm = {};
  double most_mm = 0.0;  ///< colours by distance end there; 0: colours name objects
};

/// The pieces a plan ends with and, in the same colours, what they were before they were moved.
struct FinalScene {
  std::vector<voxel::DrawnObject> before;
  std::vector<voxel::DrawnObject> after;
  bool moves = false;  ///< before and after differ
};

/// The last union of named pieces (`rest | advanced`), each piece in a colour of its own; where the plan has
/// none, its last object that is neither a mask nor empty, if any. Moved pieces keep their colour in
/// `before`; a piece that was cut from what an earlier step had moved is shown there as the bone that all of
/// it was made of, so that `before` is the untouched patient. Where a plan adds bone, a flap's or a mirrored
/// one, `before` is what the other pieces were made of.
FinalScene final_scene(const Plan& plan, const Evaluation& evaluation);

/// A picture before it is encoded, and its frame.
struct DrawnView {
  ScenePicture frame;  ///< without its png
  voxel::Picture pixels;
};
/// Draws objects in a view of the head as it is held, framed by what is seen of `framed`.
DrawnView draw_view(const std::vector<voxel::DrawnObject>& objects,
                    const std::vector<voxel::DrawnObject>& framed, const std::string& view,
                    const glm::dmat3& lps_from_head, int size_px);

/// Draws the group's objects from every view; all pictures of all groups that share `framed` are of one scale
/// and centre a view. Nothing is drawn where there are no objects.
void draw(PictureGroup& group, const std::vector<std::string>& views,
          const std::vector<voxel::DrawnObject>& framed, int size_px,
          const glm::dmat3& lps_from_head = glm::dmat3(1.0));

/// The six views along the axes and, last, two oblique ones.
std::vector<std::string> all_views();

}  // namespace octotomy::planner
