// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 Find the places on the mesh at which a ball that touches from inside is smaller than the least wall and
//   touches the opposite side. 2 Put boxes around them, one about places that are near each other. 3 Within each
//   box keep what balls hold that are wider than the least wall. Balls are searched in the part of the solid in
//   a larger box, so that its sides do not count. 4 Repeat: the rest of a wall that begins beside a box shows
//   then.
#include "planner/operation/part/thin_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <tbb/parallel_for.h>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/measure/inscribed_balls.h"
#include "brep/shape/offset.h"
#include "brep/shape/prism.h"
#include "planner/operation/part/printed_part.h"
#include "planner/operation/table/number_format.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

/// Diameter of the balls that must fit, as a share of the least wall. What they reach stands off from the solid by
/// a tenth of their radius, more than triangles lie off it (a 16th of a cell), so that no films are left beside
/// the boxes. Where sides converge by 30 degrees, a wall then ends at 1.69 radii, 1.06 least walls.
constexpr double ball_share = 1.25, reach_share = 1.1, cell_share = 1.0;
/// A ray straight inward is longer than the ball's diameter where sides converge: at 30 degrees by 1.08.
constexpr double ray_share = 1.1;

struct PlaceBox {
  glm::dvec3 low_mm{0.0}, high_mm{0.0};

  bool meets(const PlaceBox& other) const {
    return glm::all(glm::lessThanEqual(low_mm, other.high_mm)) &&
           glm::all(glm::lessThanEqual(other.low_mm, high_mm));
  }
  void hold(const PlaceBox& other) {
    low_mm = glm::min(low_mm, other.low_mm);
    high_mm = glm::max(high_mm, other.high_mm);
  }
  brep::Solid solid(double margin_mm) const {
    const glm::dvec3 low = low_mm - margin_mm, high = high_mm + margin_mm;
    // Seen along y: right is x, up is z.
    brep::Prism prism;
    prism.polygons_mm = {{{low.x, low.z}, {high.x, low.z}, {high.x, high.z}, {low.x, high.z}}};
    prism.from_mm = low.y;
    prism.to_mm = high.y;
    return brep::solid_of(prism);
  }
};

/// Places on a triangle, at most about a distance apart: rows along its longest edge.
std::vector<glm::dvec3> places_on(std::array<glm::dvec3, 3> corners_mm, double apart_mm) {
  auto& [a, b, c] = corners_mm;
  for (int turn = 0; turn < 2; ++turn)
    if (glm::distance(a, b) < std::max(glm::distance(b, c), glm::distance(c, a)))
      std::rotate(corners_mm.begin(), corners_mm.begin() + 1, corners_mm.end());
  const double base_mm = glm::distance(a, b);
  if (!(base_mm > 0.0)) return {};
  const double height_mm = glm::length(glm::cross(b - a, c - a)) / base_mm;
  const auto count = [&](double length_mm) {
    return std::max(1, static_cast<int>(std::ceil(length_mm / apart_mm)));
  };
  const int rows = count(height_mm);
  std::vector<glm::dvec3> places;
  for (int row = 0; row < rows; ++row) {
    const double up = (row + 1.0 / 3.0) / rows;
    const int columns = count(base_mm * (1.0 - up));
    for (int column = 0; column < columns; ++column)
      places.push_back(glm::mix(glm::mix(a, b, (column + 0.5) / columns), c, up));
  }
  return places;
}

std::vector<glm::dvec3> thin_places(const brep::Triangles& surface, double least_mm) {
  const double least_cosine = std::cos(glm::radians(30.0)), opposite_rad = glm::radians(150.0);
  const brep::InscribedBalls inscribed(surface);
  std::vector<std::vector<glm::dvec3>> thin(surface.faces.size());
  tbb::parallel_for(std::size_t{0}, surface.faces.size(), [&](std::size_t f) {
    const auto& face = surface.faces[f];
    const glm::dvec3 &a = surface.points_mm[face[0]], &b = surface.points_mm[face[1]],
                     &c = surface.points_mm[face[2]];
    const glm::dvec3 across = glm::cross(b - a, c - a);
    if (!(glm::length(across) > 0.0)) return;
    const glm::dvec3 normal = glm::normalize(across);
    for (const glm::dvec3& p_mm : places_on({a, b, c}, least_mm)) {
      const double ray_mm = inscribed.ray_mm(p_mm, normal);
      if (!(ray_mm < ray_share * least_mm)) continue;
      const brep::Ball ball = inscribed.touching(p_mm, normal, ray_mm, least_cosine);
      if (2.0 * ball.radius_mm < least_mm && inscribed.touches_opposite(ball, p_mm, opposite_rad))
        thin[f].push_back(p_mm);
    }
  });
  std::vector<glm::dvec3> found;
  for (const std::vector<glm::dvec3>& of_face : thin)
    found.insert(found.end(), of_face.begin(), of_face.end());
  return found;
}

/// Boxes that stand off from places by a margin and do not meet.
std::vector<PlaceBox> boxes_about(const std::vector<glm::dvec3>& places_mm, double margin_mm) {
  std::vector<PlaceBox> boxes;
  for (const glm::dvec3& p_mm : places_mm) {
    PlaceBox box{p_mm - margin_mm, p_mm + margin_mm};
    // A box that grows may meet boxes that it did not meet before.
    for (bool has_grown = true; has_grown;) {
      has_grown = false;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!boxes[i].meets(box)) continue;
        box.hold(boxes[i]);
        boxes[i] = boxes.back();
        boxes.pop_back();
        has_grown = true;
        break;
      }
    }
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

brep::Solid without_thin_walls(const brep::Solid& solid, double least_mm, const MeshBench& bench,
                               MeshSide& made) {
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  const double radius_mm = 0.5 * ball_share * least_mm;
  brep::Solid whole = solid;
  constexpr int most_rounds = 3;
  for (int round = 0; round <= most_rounds && !whole.empty(); ++round) {
    const std::vector<glm::dvec3> places_mm = thin_places(whole.triangles(), least_mm);
    if (places_mm.empty()) return whole;
    if (round == most_rounds) {
      made.findings.push_back("walls thinner than " + three_figures(least_mm) + " mm are left, one at " +
                              voxel::rounded(places_mm.front()) +
                              " mm: printable names the thinnest, so move the cut or the screw beside it");
      break;
    }
    // Boxes grow, so that one does not end twice in the same narrow place.
    for (const PlaceBox& box : boxes_about(places_mm, (1.0 + 0.5 * round) * least_mm)) {
      const brep::Solid about = noted(brep::boolean(whole, brep::Operation::Intersection,
                                                    box.solid(4.0 * radius_mm), bench.progress.stop),
                                      made);
      if (about.empty()) continue;
      const double cell_mm = cell_share * radius_mm;
      const brep::Solid core = brep::offset(about, {-radius_mm, cell_mm, progress});
      brep::Solid cutter = box.solid(0.0);
      if (!core.empty())
        cutter = noted(brep::boolean(cutter, brep::Operation::Difference,
                                     brep::offset(core, {reach_share * radius_mm, cell_mm, progress}),
                                     bench.progress.stop),
                       made);
      if (cutter.empty()) continue;
      whole = noted(brep::boolean(whole, brep::Operation::Difference, cutter, bench.progress.stop), made);
    }
  }
  return whole;
}

voxel::Expression without_thin_walls(const voxel::Expression& solid, double least_mm,
                                     const VoxelBench& bench) {
  const double radius_mm = 0.5 * ball_share * least_mm;
  // A distance d is overstated by up to D^2 / (24 d), D a voxel's diagonal: a tenth of the radius at 1.5 radii.
  if (glm::length(bench.universe.lattice().spacing_mm()) > 1.5 * radius_mm) return solid;
  return rounded(solid, radius_mm, bench);
}

}  // namespace octotomy::planner
