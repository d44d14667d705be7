// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/render_text.h"

#include <cstdio>

#include "planner/cli/numbers.h"

namespace octotomy::planner::cli {

glm::ivec2 size_of(const RenderText& render) {
  const std::string& text = render.size;
  int width = 0, height = 0;
  char cross = 0, rest = 0;
  const bool read =
      std::sscanf(text.c_str(), "%d%c%d%c", &width, &cross, &height, &rest) == 3 && cross == 'x';
  constexpr int most = 8192;
  if (!read || width < 1 || height < 1 || width > most || height > most)
    throw CLI::ValidationError(
        "--size", "'" + text + "' is no size: give WxH of 1 to 8192 pixels, for example 512x512");
  return {width, height};
}

std::vector<voxel::Cutaway> cuts_of(const RenderText& text) {
  std::vector<voxel::Cutaway> cuts;
  for (const std::string& plane : text.cut_planes) {
    const auto n = numbers_of<4>("--cut-plane", plane, "1,0,0,12.5");
    const glm::dvec3 normal(n[0], n[1], n[2]);
    if (!(glm::length(normal) > 0.0))
      throw CLI::ValidationError("--cut-plane", "'" + plane + "' has a normal without length");
    cuts.emplace_back(voxel::HalfSpace{glm::normalize(normal), n[3]});
  }
  for (const std::string& box : text.cut_boxes) {
    const auto n = numbers_of<6>("--cut-box", box, "0,-100,0,80,0,90");
    const voxel::Box removed{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (!glm::all(glm::lessThan(removed.low_mm, removed.high_mm)))
      throw CLI::ValidationError("--cut-box", "'" + box + "' holds nothing: give the lower corner first");
    cuts.emplace_back(removed);
  }
  return cuts;
}

voxel::Annotation annotation_of(const RenderText& text, const std::vector<voxel::DrawnObject>& objects) {
  voxel::Annotation annotation;
  annotation.title = text.title.empty() ? text.view : text.title;
  for (const voxel::DrawnObject& object : objects)
    if (object.opacity > 0.0f && !object.scalar) annotation.legend.push_back({object.name, object.colour});
  return annotation;
}

}  // namespace octotomy::planner::cli
