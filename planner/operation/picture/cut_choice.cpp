// SPDX-License-Identifier: AGPL-3.0-or-later
// The size and the cuts of pictures, and the samples that cut faces and surfaces show.
#include <algorithm>
#include <cstdio>
#include <limits>

#include "planner/operation/picture/render.h"

namespace octotomy::planner {
namespace {

/// The samples, with the grey tones of --tones; by default from the smallest sample to the largest.
voxel::CutTones tones_of(const Render& render, voxel::GreyOwners samples) {
  if (render.tones.empty()) {
    double black = std::numeric_limits<double>::infinity(), white = -black;
    for (const voxel::Window& window : samples.windows()) {
      const voxel::GreyOctree& grey = window.grey;
      const voxel::MinMax range =
          grey.range(std::max(2, voxel::root_height(grey.universe().depth)), {0, 0, 0});
      black = std::min(black, range.low * grey.step());
      white = std::max(white, std::max<double>(range.high, range.low + 1.0) * grey.step());
    }
    return {std::move(samples), black, white};
  }
  const auto colon = render.tones.find(':');
  std::string numbers = render.tones;
  if (colon != std::string::npos) numbers[colon] = ',';
  const auto n = numbers_of<2>("--tones", numbers, "-500:1500");
  if (!(n[1] > n[0]))
    throw std::runtime_error("--tones: '" + render.tones +
                             "': the second number must be larger than the first");
  return {std::move(samples), n[0], n[1]};
}

}  // namespace

glm::ivec2 size_of(const Render& render) {
  const std::string& text = render.size;
  int width = 0, height = 0;
  char cross = 0, rest = 0;
  const bool read =
      std::sscanf(text.c_str(), "%d%c%d%c", &width, &cross, &height, &rest) == 3 && cross == 'x';
  constexpr int most = 8192;
  if (!read || width < 1 || height < 1 || width > most || height > most)
    throw std::runtime_error("--size: '" + text +
                             "' is not a size: write WxH, each from 1 to 8192 pixels, for example 512x512");
  return {width, height};
}

std::optional<voxel::CutTones> cut_tones_of(const Render& render,
                                            const std::vector<voxel::DrawnObject>& objects,
                                            const std::vector<const Object*>& made) {
  std::vector<voxel::SampleSource> sources;
  for (const Object* object : made)
    if (object->voxel.symbol) sources.push_back({*object->voxel.symbol, object->voxel.octree});
  // Parts that were filled or grown in an object of one scan have samples of that scan, too, moved with the
  // object.
  const auto first = std::find_if(objects.begin(), objects.end(),
                                  [](const voxel::DrawnObject& object) { return object.grey.has_value(); });
  for (const voxel::DrawnObject& object : objects)
    if (object.grey)
      sources.push_back({voxel::all_samples(*object.grey, object.moved_from_still.value_or(glm::dmat4(1.0))),
                         object.octree});
    else if (made.empty() && first != objects.end())
      sources.push_back({voxel::all_samples(*first->grey, first->moved_from_still.value_or(glm::dmat4(1.0))),
                         object.octree});
  voxel::GreyOwners samples(objects.front().octree.universe(), sources);
  if (samples.windows().empty()) return std::nullopt;
  return tones_of(render, std::move(samples));
}

std::vector<voxel::Cutaway> cuts_of(const Render& render) {
  std::vector<voxel::Cutaway> cuts;
  for (const std::string& plane : render.cut_planes) {
    const auto n = numbers_of<4>("--cut-plane", plane, "1,0,0,12.5");
    const glm::dvec3 normal(n[0], n[1], n[2]);
    if (!(glm::length(normal) > 0.0))
      throw std::runtime_error(std::string("--cut-plane: '") + plane +
                               "' has a normal without length: write a direction, for example 0,1,0");
    cuts.emplace_back(voxel::HalfSpace{glm::normalize(normal), n[3]});
  }
  for (const std::string& box : render.cut_boxes) {
    const auto n = numbers_of<6>("--cut-box", box, "0,-100,0,80,0,90");
    const voxel::Box removed{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (!glm::all(glm::lessThan(removed.low_mm, removed.high_mm)))
      throw std::runtime_error(std::string("--cut-box: '") + box +
                               "' is empty: write the lower corner first");
    cuts.emplace_back(removed);
  }
  return cuts;
}

}  // namespace octotomy::planner
