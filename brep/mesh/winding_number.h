// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Winding numbers of a surface of arbitrary triangles around points in LPS millimetres: 1 inside a closed
/// surface, 0 outside, in between near holes. Triangles far from a point are evaluated by the first two
/// moments of their clusters, with a total error of up to about 0.05.
class WindingTree {
 public:
  /// Precondition: triangles refer to finite points. Cost: n log n, about 150 bytes per triangle; parallel.
  explicit WindingTree(const Triangles& surface);
  ~WindingTree();
  WindingTree(WindingTree&&) noexcept;
  WindingTree& operator=(WindingTree&&) noexcept;

  /// Points near each other share a descent, so a result may depend on the other points, within the error
  /// above. The same bits on any number of threads. Cost: about log n per point, 2 us at 500k triangles;
  /// parallel. Source: Barill, Dickson, Schmidt, Levin, Jacobson, "Fast winding numbers for soups and
  /// clouds", SIGGRAPH 2018, with its second order; single triangles after Van Oosterom and Strackee, 1983.
  std::vector<double> at(const std::vector<glm::dvec3>& points_mm) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace octotomy::brep
