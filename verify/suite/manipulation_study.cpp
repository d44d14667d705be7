// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/manipulation_study.h"

#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "verify/phantom/solid_phantom.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"
#include "voxel/solid/region_mask.h"
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

/// The number of Full voxels: the sum over levels of the Full nodes' volumes.
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

/// A printed tree of 8 levels, with "Partial Full Empty" for each level.
using PrintedTree = std::array<const char*, 8>;

void push_levels(const char* table, const char* tree, const PrintedTree& printed, const Octree& octree,
                 RepresentationStudy& study) {
  const std::vector<LevelCount> levels = level_counts(octree);
  for (std::size_t i = 0; i < printed.size(); ++i) {
    const LevelCount ours = i < levels.size() ? levels[i] : LevelCount{};
    study.beside.push_back(
        {table, std::string(tree) + ", level " + std::to_string(i + 1) + ", Partial Full Empty", printed[i],
         (i + 1 == printed.size() ? "-" : std::to_string(ours.partial)) + " " + std::to_string(ours.full) +
             " " + std::to_string(ours.empty)});
  }
}

/// The points of the universe that a view projects into a polygon. The thesis's polygons were drawn by hand
/// and are not printed.
Octree cylinder(const voxel::Universe& universe, const char* view,
                const std::vector<glm::dvec2>& polygon_mm) {
  return combine(universe, voxel::RegionMask{{{voxel::parse_view(view), {polygon_mm}}}});
}

/// Two cylinders behind polygons, one seen from the front and one from the left, and their Booleans.
void table_7_3(const voxel::Universe& universe, RepresentationStudy& study) {
  const Octree a = cylinder(universe, "anterior", {{-30, -70}, {75, -60}, {70, 55}, {10, 75}, {-45, 20}});
  const Octree b = cylinder(universe, "left", {{-70, -25}, {20, -75}, {65, -10}, {40, 70}, {-55, 60}});
  const std::array<std::tuple<const char*, PrintedTree, Octree>, 4> trees{
      {{"A",
        {"8 0 -", "48 0 16", "216 24 144", "928 480 320", "3616 1472 2366", "12096 7680 9152",
         "27520 35968 33280", "- 106496 113664"},
        a},
       {"B",
        {"8 0 -", "52 0 12", "240 40 136", "992 336 592", "3680 2016 2240", "12032 7232 10176",
         "30720 32896 32640", "- 124672 121088"},
        b},
       {"A n B",
        {"8 0 -", "40 0 24", "167 1 152", "773 119 444", "2880 967 2337", "9323 5389 8328",
         "23473 24722 26389", "- 92314 95470"},
        combine(universe, Expression(a) & b)},
       {"A - B",
        {"8 0 -", "48 0 16", "196 7 181", "902 242 424", "3359 1395 2462", "1098 7176 8715",
         "27479 30183 30186", "- 106078 113754"},
        combine(universe, Expression(a) - b)}}};
  for (const auto& [name, printed, octree] : trees) push_levels("table 7.3", name, printed, octree, study);
}

/// The parts of the sphere, before and after their translation.
void table_7_7(const std::array<Octree, 4>& trees, RepresentationStudy& study) {
  static constexpr std::array<std::pair<const char*, PrintedTree>, 4> printed{
      {{"intersection",
        {"8 0 -", "8 0 56", "52 0 12", "235 16 165", "906 219 755", "2922 1476 2850", "7660 7255 8461",
         "- 30010 31270"}},
       {"intersection, translated",
        {"8 0 -", "21 0 43", "65 0 103", "238 18 264", "880 196 828", "2854 1572 2614", "7660 6935 8237",
         "- 30010 31270"}},
       {"difference",
        {"8 0 -", "40 0 24", "156 0 164", "699 83 466", "2618 777 2197", "8938 4511 7495",
         "24453 22255 24796", "- 85568 110056"}},
       {"difference, translated",
        {"8 0 -", "32 0 32", "141 0 115", "628 65 435", "2411 859 1754", "8328 4865 6095",
         "23088 20978 25558", "- 80296 104408"}}}};
  for (std::size_t i = 0; i < trees.size(); ++i)
    push_levels("table 7.7", printed[i].first, printed[i].second, trees[i], study);
}

const char* sameness(bool is_same) {
  return is_same ? "same" : "different";
}

}  // namespace

RepresentationStudy manipulation_study() {
  RepresentationStudy study;
  const Octree sphere = digitise(solid_phantom("sphere"), voxel::Digitisation::Centre);
  const voxel::Universe& universe = sphere.universe();
  // The box cuts a wedge out of the sphere, like the part that the thesis cuts out. Its faces do not lie on
  // borders of blocks.
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
  // A motion by even numbers of voxels maps blocks of two voxels a side onto such blocks, so the counts do
  // not change. The thesis prints 7,660, 30,010 and 31,270 before and after.
  study.entries.push_back({"table 7.7",
                           "intersection, before and after a motion by (20, 30, 40) voxels: Partial of level "
                           "7, Full and Empty of level 8",
                           "same", sameness(finest_of(inside) == finest_of(moved_inside))});

  const auto count = [](std::uint64_t n) { return std::to_string(n); };
  study.beside.push_back({"table 7.2",
                          "intersection, difference, translation, union: printed: seconds; ours: Full voxels",
                          "35 50 280 51",
                          count(voxel_count(inside)) + " " + count(voxel_count(outside)) + " " +
                              count(voxel_count(moved_inside)) + " " + count(voxel_count(merged))});
  study.beside.push_back(
      {"table 7.4", "display of intersection, difference back to front: printed: seconds; ours: visits",
       "106 103", count(visits_back_to_front(inside)) + " " + count(visits_back_to_front(outside))});
  study.beside.push_back({"table 7.6",
                          "intersection before, after translation: printed: seconds; ours: nodes", "35 280",
                          count(node_count(inside)) + " " + count(node_count(moved_inside))});
  study.beside.push_back({"table 7.6", "difference before, after translation: printed: seconds; ours: nodes",
                          "55 144", count(node_count(outside)) + " " + count(node_count(moved_outside))});
  table_7_3(universe, study);
  table_7_7({inside, moved_inside, outside, moved_outside}, study);
  return study;
}

}  // namespace octotomy::verify
