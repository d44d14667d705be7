// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 find the volume, the box and the probe of each shell; 2 for each probe find the shells whose boxes
// contain it; 3 if there are any, cast a ray along x to the end of their boxes and count its crossings with
// their triangles. A closed shell whose box does not contain the probe does not wind around it.
#include "brep/mesh/shell_places.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tbb/parallel_for.h>

#include "brep/mesh/equal_points.h"
#include "brep/mesh/ray_passing.h"

namespace octotomy::brep {
namespace {

/// A shell's place among the others, with the point and the box from which the place is computed.
struct Probe {
  ShellPlace place;
  /// The shell's point of largest x; if possible, one that no other shell shares.
  glm::dvec3 p_mm{-std::numeric_limits<double>::infinity()};
  bool touches = true;
  glm::dvec3 low_mm{std::numeric_limits<double>::infinity()};    ///< lower end of the shell's box
  glm::dvec3 high_mm{-std::numeric_limits<double>::infinity()};  ///< upper end of the shell's box

  void add(const glm::dvec3& corner_mm, bool is_shared) {
    low_mm = glm::min(low_mm, corner_mm);
    high_mm = glm::max(high_mm, corner_mm);
    if (is_shared != touches ? touches : corner_mm.x > p_mm.x) {
      p_mm = corner_mm;
      touches = is_shared;
    }
  }
  bool box_holds(const glm::dvec3& at_mm) const {
    return glm::all(glm::lessThanEqual(low_mm, at_mm)) && glm::all(glm::lessThanEqual(at_mm, high_mm));
  }
};

/// The number of each triangle's shell, counted in order of the shells' first triangles.
std::vector<std::uint32_t> number_shells(const std::vector<std::uint32_t>& shell) {
  std::vector<std::uint32_t> number(shell.size());
  std::uint32_t count = 0;
  // A shell is identified by its first triangle.
  for (std::uint32_t f = 0; f < shell.size(); ++f) number[f] = shell[f] == f ? count++ : number[shell[f]];
  return number;
}

/// The probe of each shell, in order of the shells' first triangles.
std::vector<Probe> probes_of(const ShelledSurface& surface, const std::vector<std::uint32_t>& number) {
  const auto& [triangles, first, shell] = surface;
  const bool is_single = std::all_of(number.begin(), number.end(), [](std::uint32_t n) { return n == 0; });
  const std::vector<std::uint8_t> touching =
      is_single ? std::vector<std::uint8_t>(first.size(), 0) : shared_points(triangles, first, shell);
  std::vector<Probe> probes;
  for (std::uint32_t f = 0; f < shell.size(); ++f) {
    if (shell[f] == f) probes.push_back({.place = {.shell = f}});
    Probe& probe = probes[number[f]];
    for (const std::uint32_t v : triangles.faces[f]) probe.add(triangles.points_mm[v], touching[v] != 0);
    const auto point = [&, &triangles = triangles](std::size_t k) {
      return triangles.points_mm[triangles.faces[f][k]];
    };
    // Sums relative to the shell's first point, which preserves digits far from the origin.
    const glm::dvec3 origin = triangles.points_mm[triangles.faces[shell[f]][0]];
    probe.place.volume_mm3 +=
        glm::dot(point(0) - origin, glm::cross(point(1) - origin, point(2) - origin)) / 6.0;
  }
  return probes;
}

/// A tree of the shells' boxes, each stored as a triangle between its opposite corners.
MortonTree tree_of_boxes(const std::vector<Probe>& probes) {
  Triangles boxes;
  for (std::uint32_t i = 0; i < probes.size(); ++i) {
    boxes.points_mm.insert(boxes.points_mm.end(), {probes[i].low_mm, probes[i].high_mm});
    boxes.faces.push_back({2 * i, 2 * i + 1, 2 * i});
  }
  return MortonTree(boxes);
}

class Windings {
 public:
  Windings(const Triangles& triangles, const std::vector<std::uint32_t>& number,
           const std::vector<Probe>& probes, const MortonTree& tree)
      : triangles_(triangles), number_(number), probes_(probes), tree_(tree), boxes_(tree_of_boxes(probes)) {}

  /// The winding number of all other shells around a probe.
  int about(std::uint32_t own) const {
    const glm::dvec3& p = probes_[own].p_mm;
    const double reach = reach_mm(own);
    int winding = 0;
    tree_.visit(
        [&](const OuterBox& box) {
          return !(box.low.x > reach || box.high.x < p.x || box.low.y > p.y || box.high.y < p.y ||
                   box.low.z > p.z || box.high.z < p.z);
        },
        [&](std::uint32_t f) {
          if (number_[f] == own || !probes_[number_[f]].box_holds(p)) return;
          const auto& [a, b, c] = triangles_.faces[f];
          const RayPassing passing =
              passing_of(p, triangles_.points_mm[a], triangles_.points_mm[b], triangles_.points_mm[c]);
          winding += passing == RayPassing::Leaving ? 1 : passing == RayPassing::Entering ? -1 : 0;
        });
    return winding;
  }

 private:
  /// The largest x of the other shells whose boxes contain a probe.
  double reach_mm(std::uint32_t own) const {
    const glm::dvec3& p = probes_[own].p_mm;
    double reach = -std::numeric_limits<double>::infinity();
    boxes_.visit(
        [&](const OuterBox& box) {
          return box.low.x <= p.x && p.x <= box.high.x && box.low.y <= p.y && p.y <= box.high.y &&
                 box.low.z <= p.z && p.z <= box.high.z;
        },
        [&](std::uint32_t i) {
          if (i != own && probes_[i].box_holds(p)) reach = std::max(reach, probes_[i].high_mm.x);
        });
    return reach;
  }

  const Triangles& triangles_;
  const std::vector<std::uint32_t>& number_;
  const std::vector<Probe>& probes_;
  const MortonTree& tree_;
  MortonTree boxes_;
};

}  // namespace

std::vector<ShellPlace> shell_places(const ShelledSurface& surface, const MortonTree* tree) {
  assert(surface.shell.size() == surface.triangles.faces.size());
  assert(surface.first.size() == surface.triangles.points_mm.size());
  const std::vector<std::uint32_t> number = number_shells(surface.shell);
  const std::vector<Probe> probes = probes_of(surface, number);
  std::vector<ShellPlace> places;
  places.reserve(probes.size());
  for (const Probe& probe : probes) places.push_back(probe.place);
  if (places.size() < 2) return places;
  assert(tree != nullptr);
  const Windings windings(surface.triangles, number, probes, *tree);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(places.size()),
                    [&](std::uint32_t i) { places[i].winding = windings.about(i); });
  return places;
}

}  // namespace octotomy::brep
