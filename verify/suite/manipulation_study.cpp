// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/manipulation_study.h"

#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "verify/phantom/solid_phantom.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"
#include "voxel/space/view.h"
#include "voxel/view/render.h"
#include "voxel/view/visits.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;
using voxel::LevelCount;
using voxel::Octree;

std::uint64_t node_count(const Octree& octree) {
  std::uint64_t nodes = 1;
  for (const LevelCount& level : level_counts(octree)) nodes += level.partial + level.full + level.empty;
  return nodes;
}

/// The number of full voxels: the sum of the Full nodes' volumes.
std::uint64_t voxel_count(const Octree& octree) {
  const std::vector<LevelCount> levels = level_counts(octree);
  std::uint64_t voxels = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) voxels += levels[i].full << (3 * (levels.size() - 1 - i));
  return voxels;
}

std::uint64_t visits_back_to_front(const Octree& octree) {
  voxel::RenderOptions options;
  options.view = voxel::parse_view("anterior");
  options.size_px = {256, 256};
  options.width_mm = 256.0;
  options.centre_mm = glm::dvec2(0.0);
  options.algorithm = voxel::Algorithm::BackToFront;
  options.shading = voxel::Shading::Depth;
  options.count = true;
  std::uint64_t visits = 0;
  const voxel::Picture picture = voxel::render({{"object", octree}}, options);
  for (const LevelCount& level : picture.visits->direct.octree)
    visits += level.partial + level.full + level.empty;
  return visits;
}

/// The numbers of Partial nodes of level 7, and of Full and Empty nodes of level 8.
std::array<std::uint64_t, 3> finest_of(const Octree& octree) {
  const std::vector<LevelCount> levels = level_counts(octree);
  return {levels[6].partial, levels[7].full, levels[7].empty};
}

const char* sameness(bool is_same) {
  return is_same ? "same" : "different";
}

}  // namespace

RepresentationStudy manipulation_study() {
  RepresentationStudy study;
  const Octree sphere = digitise(solid_phantom("sphere"), voxel::Digitisation::Centre);
  const voxel::Universe& universe = sphere.universe();
  // A wedge of the sphere, like the part that the thesis cuts out; its faces do not lie on the borders of
  // blocks.
  const Octree mask = combine(universe, voxel::Box{{-17.0, -70.0, -23.0}, {70.0, 11.0, 70.0}});
  const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), glm::dvec3(20.0, 30.0, 40.0));
  const Expression a(sphere), b(mask);
  const auto made = [&](const Expression& expression) { return combine(universe, expression); };

  const Octree inside = made(a & b), outside = made(a - b);
  const Octree moved_inside = made(voxel::moved(Expression(inside), moved));
  const Octree moved_outside = made(voxel::moved(Expression(outside), moved));
  const Octree merged = made(Expression(outside) | Expression(moved_inside));

  study.entries.push_back({"table 7.2", "the four operations, and Translate_Intersection with Union_Diff",
                           "same", sameness(made(voxel::moved(a & b, moved) | (a - b)) == merged)});
  study.entries.push_back({"table 7.6", "intersection: created and moved, and Translate_Boolean", "same",
                           sameness(made(voxel::moved(a & b, moved)) == moved_inside)});
  study.entries.push_back({"table 7.6", "difference: created and moved, and Translate_Boolean", "same",
                           sameness(made(voxel::moved(a - b, moved)) == moved_outside)});
  // A motion by even steps moves blocks of two voxels onto such blocks, so the counts do not change. The
  // thesis prints 7,660, 30,010 and 31,270 before and after.
  study.entries.push_back({"table 7.7",
                           "intersection moved by (20, 30, 40): P of level 7, F and E of level 8", "same",
                           sameness(finest_of(inside) == finest_of(moved_inside))});

  const auto count = [](std::uint64_t n) { return std::to_string(n); };
  study.beside.push_back({"table 7.2",
                          "intersection, difference, translation, union: printed s; ours Full voxels",
                          "35 50 280 51",
                          count(voxel_count(inside)) + " " + count(voxel_count(outside)) + " " +
                              count(voxel_count(moved_inside)) + " " + count(voxel_count(merged))});
  study.beside.push_back(
      {"table 7.4", "display of intersection, difference back to front: printed s; ours visits", "106 103",
       count(visits_back_to_front(inside)) + " " + count(visits_back_to_front(outside))});
  study.beside.push_back({"table 7.6", "intersection before, after translation: printed s; ours nodes",
                          "35 280", count(node_count(inside)) + " " + count(node_count(moved_inside))});
  study.beside.push_back({"table 7.6", "difference before, after translation: printed s; ours nodes",
                          "55 144", count(node_count(outside)) + " " + count(node_count(moved_outside))});
  const auto finest = finest_of(inside);
  study.beside.push_back({"table 7.7", "intersection: P of level 7, F and E of level 8", "7660 30010 31270",
                          count(finest[0]) + " " + count(finest[1]) + " " + count(finest[2])});
  return study;
}

}  // namespace octotomy::verify
