// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/landmark/head_map.h"

#include <algorithm>
#include <cassert>

#include "voxel/view/render.h"

namespace octotomy::planner {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr int most_px = 1024;

/// A depth picture of a view: the depth along `look` at each pixel, over the axes (right, up).
HeadMap depths(const voxel::DrawnObject& bone, const voxel::View& view, double step_mm) {
  // The extent comes from a frame around the bone. The picture is then drawn with pixels of the stated width.
  const voxel::Frame about = voxel::frame_about({bone}, view, {256, 256});
  voxel::RenderOptions options;
  options.view = view;
  const int side = std::clamp(static_cast<int>(std::ceil(about.width_mm / step_mm)), 16, most_px);
  options.size_px = {side, side};
  options.centre_mm = about.centre_mm;
  options.width_mm = side * step_mm;
  options.algorithm = voxel::Algorithm::RayCast;
  options.shading = voxel::Shading::Silhouette;
  options.occlusion = options.antialias = false;
  const voxel::Picture picture = voxel::render({bone}, options);
  const double half_mm = (side - 1) * step_mm * 0.5;
  HeadMap map({side, side}, about.centre_mm - half_mm, step_mm);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const auto pixel = static_cast<std::size_t>(side - 1 - j) * static_cast<std::size_t>(side) +
                         static_cast<std::size_t>(i);
      if (std::isfinite(picture.depth_mm[pixel]))
        map.set(i, j) = picture.nearest_mm + static_cast<double>(picture.depth_mm[pixel]);
    }
  return map;
}

/// An empty map with the size and rows of another map.
template <typename Value>
HeadMap filled(const HeadMap& like, double first_x_mm, const Value& value) {
  HeadMap map(like.size(), {first_x_mm, like.y_mm(0)}, like.step_mm());
  for (int j = 0; j < map.size().y; ++j)
    for (int i = 0; i < map.size().x; ++i) map.set(i, j) = value(i, j);
  return map;
}

}  // namespace

HeadFrame head_frame(const glm::dvec3& point_mm, const glm::dvec3& normal, double pitch_deg) {
  assert(std::abs(glm::length(normal) - 1.0) < 1e-6 && std::abs(normal.z) < 0.9);
  const glm::dvec3 level = glm::normalize(glm::dvec3(0, 0, 1) - normal.z * normal);
  const glm::dvec3 behind = glm::cross(level, normal);
  const double turn = glm::radians(pitch_deg);
  HeadFrame frame;
  frame.left = normal;
  frame.up = std::cos(turn) * level + std::sin(turn) * behind;
  frame.back = glm::cross(frame.up, normal);
  frame.mid_mm = glm::dot(point_mm, normal);
  return frame;
}

HeadMap::HeadMap(const glm::ivec2& size, const glm::dvec2& first_mm, double step_mm)
    : size_(size),
      first_mm_(first_mm),
      step_mm_(step_mm),
      values_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), nothing) {}

double HeadMap::at(int i, int j) const {
  if (i < 0 || j < 0 || i >= size_.x || j >= size_.y) return nothing;
  return values_[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.x) +
                 static_cast<std::size_t>(i)];
}

double& HeadMap::set(int i, int j) {
  assert(i >= 0 && j >= 0 && i < size_.x && j < size_.y);
  return values_[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.x) +
                 static_cast<std::size_t>(i)];
}

HeadMaps map_head(const voxel::DrawnObject& bone, const HeadFrame& frame, double step_mm) {
  const HeadMap front = depths(bone, {frame.back, frame.up, frame.left}, step_mm);
  const HeadMap from_left = depths(bone, {-frame.left, frame.up, frame.back}, step_mm);
  const HeadMap from_right = depths(bone, {frame.left, frame.up, -frame.back}, step_mm);
  // Depths increase away from the observer: from the left view towards the patient's right, from the right
  // view towards the left. In the view from the right, back is on the left of the picture.
  const int last = from_right.size().x - 1;
  return {
      frame, filled(front, front.x_mm(0) - frame.mid_mm, [&](int i, int j) { return front.at(i, j); }),
      filled(from_left, from_left.x_mm(0), [&](int i, int j) { return -from_left.at(i, j) - frame.mid_mm; }),
      filled(from_right, -from_right.x_mm(last),
             [&](int i, int j) { return frame.mid_mm - from_right.at(last - i, j); })};
}

}  // namespace octotomy::planner
