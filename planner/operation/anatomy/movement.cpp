// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/anatomy/movement.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/anatomy/measured_movement.h"
#include "planner/operation/table/deformation.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr double reach_mm = 3.0;

/// The displacement `by_mm` (LPS) along the head's directions, and the same in words.
MeasuredDisplacement measured(const glm::dvec3& by_mm, const glm::dmat3& lps_from_head) {
  const Displacement along = displacement_of(by_mm, lps_from_head);
  return {along.forward_mm, along.left_mm, along.up_mm, in_words(along)};
}

/// The bone of the scan that no step moves: all windows from which pieces were cut, minus the pieces. None if
/// nothing moves or nothing remains. Other windows are left out, because skin or an operated scan is not bone
/// that stays.
std::optional<voxel::Expression> staying_bone(const Objects& objects) {
  std::optional<voxel::Expression> staying, pieces;
  const auto add = [](std::optional<voxel::Expression>& all, const voxel::Octree& octree) {
    all = all ? *all | voxel::Expression(octree) : voxel::Expression(octree);
  };
  std::vector<Shown> cut;  // windows
  for (const Object& object : objects)
    if (object.moved && !objects.at(object.moved->object).moved) {
      const Object& piece = objects.at(object.moved->object);
      add(pieces, piece.voxel.octree);
      cut.insert(cut.end(), piece.bound.windows.begin(), piece.bound.windows.end());
    }
  const auto is_cut = [&](const Shown& window) {
    return cut.empty() || std::any_of(cut.begin(), cut.end(), [&](const Shown& each) {
             return each.scan == window.scan && each.threshold == window.threshold &&
                    each.high == window.high;
           });
  };
  for (const Object& object : objects)
    if (!object.is_tool && !object.moved && object.shown && is_cut(*object.shown))
      add(staying, object.voxel.octree);
  if (!staying || !pieces) return std::nullopt;
  return voxel::Expression(voxel::combine(objects.front().voxel.octree.universe(), *staying - *pieces));
}

/// Whether the landmark moves with the piece: in the smallest sphere around it that meets bone, the piece has
/// more than half as much bone as stays. `at_mm` is the landmark's position with the piece, `still_mm` its
/// position in the scan.
bool nearer(const voxel::Octree& piece, const std::optional<voxel::Expression>& staying,
            const glm::dvec3& at_mm, const glm::dvec3& still_mm) {
  for (const double radius_mm : {0.5, 1.0, 2.0, reach_mm}) {
    const auto in_reach = [&](const voxel::Expression& bone, const glm::dvec3& p_mm) {
      return voxel::measure(
                 voxel::combine(piece.universe(), bone & voxel::Expression(voxel::Sphere{p_mm, radius_mm})))
          .volume_mm3;
    };
    const double of_piece = in_reach(voxel::Expression(piece), at_mm),
                 of_others = staying ? in_reach(*staying, still_mm) : 0.0;
    // At a cut, the piece and the bone that stays fill about half of the sphere each. The landmark then moves
    // with the piece, because the cut was planned for the piece.
    if (of_piece > 0.0 || of_others > 0.0) return of_piece > 0.5 * of_others;
  }
  return false;
}

/// Gives the landmarks of the skin the motions that a landmark_ratios step predicts. Does nothing for other
/// objects.
void move_skin(const Object& prediction, std::vector<MovedLandmark>& moved) {
  if (prediction.kind != "landmark_ratios") return;
  const auto vector_of = [](const Json& row, const char* key) {
    glm::dvec3 vector(0.0);
    read_value(row.at(key), vector);
    return vector;
  };
  for (const Json& row : prediction.mesh.details.at("landmarks"))
    for (MovedLandmark& each : moved) {
      if (each.landmark.name != row.at("name").get<std::string>()) continue;
      each.moved_from_still = glm::translate(glm::dmat4(1.0), vector_of(row, "moved_mm"));
      each.is_predicted = true;
      const Json& deviation = row.at("deviation");
      each.deviation_mm =
          deviation.is_null() ? glm::dvec3(0.0) : deviation.get<double>() * vector_of(row, "bone_moved_mm");
    }
}

ObjectMovement movement_of(const Object& object, const Objects& objects,
                           const std::vector<NamedPoint>& landmarks,
                           const std::optional<voxel::Expression>& staying) {
  const glm::dmat3& head = objects.lps_from_head;
  const glm::dmat4& motion = object.moved->motion;
  const Object& still = objects.at(object.moved->object);
  const glm::dmat4 before = moved_since_made(objects, still.id);
  const Turns turns = turns_of(nearest_rotation(motion), head);
  ObjectMovement made{
      object.id, still.id, turns.pitch_deg, turns.yaw_deg, turns.roll_deg, in_words(turns), {}, {}, {}};
  if (const std::optional<glm::dvec3>& centre = still.voxel.measures.centroid_mm) {
    made.centroid = measured(carried(motion, *centre) - *centre, head);
    made.words = made.centroid->words + "; " + in_words(turns);
  }
  if (!is_rigid(motion)) made.words += "; " + in_words(deformation_of(glm::dmat3(motion)));
  for (const NamedPoint& landmark : landmarks) {
    const glm::dvec3 from_mm = carried(before, landmark.p_mm), to_mm = carried(motion, from_mm);
    if (!nearer(still.voxel.octree, staying, from_mm, landmark.p_mm)) continue;
    const auto [forward_mm, left_mm, up_mm, words] = measured(to_mm - from_mm, head);
    made.landmarks.push_back({landmark.name, forward_mm, left_mm, up_mm, words, to_mm, {}});
    if (still.moved) made.landmarks.back().since_scan = measured(to_mm - landmark.p_mm, head);
  }
  return made;
}

}  // namespace

std::vector<ObjectMovement> movements_of(const Objects& objects, const std::vector<NamedPoint>& landmarks) {
  const std::optional<voxel::Expression> staying = landmarks.empty() ? std::nullopt : staying_bone(objects);
  std::vector<ObjectMovement> all;
  for (const Object& object : objects)
    if (object.moved) all.push_back(movement_of(object, objects, landmarks, staying));
  return all;
}

Json movements_json(const Objects& objects, const std::vector<NamedPoint>& landmarks) {
  Json all = Json::array();
  for (const ObjectMovement& movement : movements_of(objects, landmarks)) {
    all.push_back(print_record(movement));
    all.back().update(objects.at(movement.object).moved->details);
  }
  return all;
}

std::vector<MovedLandmark> moved_landmarks(const Objects& objects, const std::vector<NamedPoint>& landmarks) {
  const std::optional<voxel::Expression> staying = staying_bone(objects);
  std::vector<MovedLandmark> moved;
  for (const NamedPoint& landmark : landmarks) {
    moved.push_back({landmark, glm::dmat4(1.0)});
    for (const Object& object : objects) {
      if (!object.moved) continue;
      const Object& still = objects.at(object.moved->object);
      const glm::dmat4 before = moved_since_made(objects, still.id);
      if (nearer(still.voxel.octree, staying, carried(before, landmark.p_mm), landmark.p_mm))
        moved.back().moved_from_still = object.moved->motion * before;
    }
  }
  for (const Object& object : objects) move_skin(object, moved);
  return moved;
}

}  // namespace octotomy::planner
