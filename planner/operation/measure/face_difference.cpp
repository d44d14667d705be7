// SPDX-License-Identifier: AGPL-3.0-or-later
//
//   1 The skin before the operation: the object whose triangles both predictions have, with displaced points.
//   2 A depth map from the front: the foremost corner or centre of a triangle in each square of 1 mm. A triangle is seen
//     if it faces the front and its centre is not deeper than that by more than a steep cheek drops over a square.
//   3 The difference of both displacements at the seen centres, and at the landmarks' feet on the skin.
#include "planner/operation/measure/face_difference.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

constexpr double square_mm = 1.0;
constexpr double behind_mm = 3.0;  // depth by which a surface at 70 degrees to the view may drop within one
                                   // square

using Face = std::array<std::uint32_t, 3>;

class DepthMap {
 public:
  DepthMap(const brep::Triangles& surface, const glm::dvec3& forward) : forward_(forward) {
    const glm::dvec3 other = std::abs(forward.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    right_ = glm::normalize(glm::cross(forward, other));
    up_ = glm::cross(right_, forward);
    for (const glm::dvec3& p_mm : surface.points_mm) add(p_mm);
    for (const Face& face : surface.faces) add(centre_of(surface, face));
  }

  static glm::dvec3 centre_of(const brep::Triangles& surface, const Face& face) {
    return (surface.points_mm[face[0]] + surface.points_mm[face[1]] + surface.points_mm[face[2]]) / 3.0;
  }
  bool is_seen(const glm::dvec3& p_mm) const {
    return glm::dot(p_mm, forward_) >= foremost_mm_.at(square_of(p_mm)) - behind_mm;
  }

 private:
  void add(const glm::dvec3& p_mm) {
    const auto [entry, is_new] = foremost_mm_.emplace(square_of(p_mm), glm::dot(p_mm, forward_));
    if (!is_new) entry->second = std::max(entry->second, glm::dot(p_mm, forward_));
  }
  std::pair<long, long> square_of(const glm::dvec3& p_mm) const {
    return {std::lround(glm::dot(p_mm, right_) / square_mm), std::lround(glm::dot(p_mm, up_) / square_mm)};
  }

  glm::dvec3 forward_, right_{0.0}, up_{0.0};
  std::map<std::pair<long, long>, double> foremost_mm_;
};

/// The skin before the operation, and two predictions of it afterwards.
struct Predictions {
  const Object* skin = nullptr;
  const brep::Triangles *still = nullptr, *a = nullptr, *b = nullptr;

  /// The displacements by prediction a and by prediction b of a point in a face, stated by the weights of the
  /// face's corners.
  std::pair<glm::dvec3, glm::dvec3> moved_mm(const Face& face, const glm::dvec3& weights) const {
    glm::dvec3 by_a(0.0), by_b(0.0);
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t point = face[static_cast<std::size_t>(corner)];
      by_a += weights[corner] * (a->points_mm[point] - still->points_mm[point]);
      by_b += weights[corner] * (b->points_mm[point] - still->points_mm[point]);
    }
    return {by_a, by_b};
  }
};

/// The two predictions; none if the objects are not displaced points of the same object.
std::optional<Predictions> predictions_of(const Object& a, const Object& b, const Objects& objects) {
  if (!a.mesh.whole || !b.mesh.whole) return std::nullopt;
  for (const Object* of : {&a, &b}) {
    if (of->bound.reshaped.size() != 1) continue;
    const Object& skin = objects.at(of->bound.reshaped.front());
    if (!skin.mesh.whole || skin.mesh.whole->empty()) continue;
    const Predictions found{&skin, &skin.mesh.whole->triangles(), &a.mesh.whole->triangles(),
                            &b.mesh.whole->triangles()};
    if (found.a->faces == found.still->faces && found.b->faces == found.still->faces) return found;
  }
  return std::nullopt;
}

/// The landmarks of both predictions, each with the distance over which its displacement fades.
std::vector<std::pair<RatioLandmark, double>> landmarks_of(const Object& a, const Object& b) {
  std::vector<std::pair<RatioLandmark, double>> all;
  for (const Object* object : {&a, &b}) {
    if (object->kind != "landmark_ratios") continue;
    const auto measured = record_of<MeasuredRatios>(object->mesh.details);
    for (const RatioLandmark& each : measured.landmarks) {
      const bool is_there =
          std::any_of(all.begin(), all.end(), [&](const auto& one) { return one.first.at_mm == each.at_mm; });
      if (!is_there) all.emplace_back(each, measured.fade_mm);
    }
  }
  return all;
}

void add_landmarks(const Predictions& skin, const std::vector<std::pair<RatioLandmark, double>>& landmarks,
                   FaceDifference& made) {
  std::vector<glm::dvec3> points_mm;
  for (const auto& [landmark, fade_mm] : landmarks) points_mm.push_back(landmark.at_mm);
  const std::vector<brep::Foot> feet = skin.skin->mesh.whole->tree().feet(points_mm);
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const auto [by_a, by_b] = skin.moved_mm(skin.still->faces[feet[i].face], feet[i].weights);
    made.landmarks.push_back({landmarks[i].first.name, points_mm[i], by_a, by_b, glm::distance(by_a, by_b)});
  }
}

void add_face(const Predictions& skin, const std::vector<std::pair<RatioLandmark, double>>& landmarks,
              const glm::dvec3& forward, FaceDifference& made) {
  const DepthMap depths(*skin.still, forward);
  double sum = 0.0;
  for (const Face& face : skin.still->faces) {
    const std::vector<glm::dvec3>& p = skin.still->points_mm;
    const glm::dvec3 centre_mm = DepthMap::centre_of(*skin.still, face);
    const glm::dvec3 normal = glm::cross(p[face[1]] - p[face[0]], p[face[2]] - p[face[0]]);
    const bool is_in_reach = std::any_of(landmarks.begin(), landmarks.end(), [&](const auto& each) {
      return glm::distance(each.first.at_mm, centre_mm) < each.second;
    });
    if (!is_in_reach || glm::dot(normal, forward) <= 0.0 || !depths.is_seen(centre_mm)) continue;
    const auto [by_a, by_b] = skin.moved_mm(face, glm::dvec3(1.0 / 3.0));
    const double off_mm = glm::distance(by_a, by_b), area_mm2 = 0.5 * glm::length(normal);
    made.area_mm2 += area_mm2;
    sum += area_mm2 * off_mm;
    if (off_mm < made.largest_mm) continue;
    made.largest_mm = off_mm;
    made.largest_at_mm = centre_mm;
  }
  if (made.area_mm2 > 0.0) made.mean_mm = sum / made.area_mm2;
}

}  // namespace

std::optional<FaceDifference> face_difference(const Object& a, const Object& b, const Objects& objects) {
  const auto landmarks = landmarks_of(a, b);
  if (landmarks.empty()) return std::nullopt;
  const std::optional<Predictions> skin = predictions_of(a, b, objects);
  if (!skin) return std::nullopt;
  FaceDifference made;
  made.skin = skin->skin->id;
  add_landmarks(*skin, landmarks, made);
  add_face(*skin, landmarks, -objects.lps_from_head[1], made);
  double reach_mm = 0.0;
  for (const auto& [landmark, fade_mm] : landmarks) reach_mm = std::max(reach_mm, fade_mm);
  made.definition =
      "length of the difference between the two displacements of a point of the skin; area-weighted mean "
      "over the skin that is visible from the front within " +
      plain(reach_mm) + " mm of a landmark";
  return made;
}

}  // namespace octotomy::planner
