// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::bench {

/// CGAL's own surface mesh with its corefinement and measures, called as its manual shows.
class CgalSurface {
 public:
  explicit CgalSurface(const brep::Triangles& triangles);
  ~CgalSurface();
  CgalSurface(CgalSurface&&) noexcept;

  enum class Operation { Union, Difference };
  /// The number of triangles of the result. Corefinement changes its operands, so callers pass copies.
  static std::size_t boolean(CgalSurface& a, CgalSurface& b, Operation operation);
  CgalSurface copy() const;

  double volume_and_area() const;

 private:
  struct Mesh;
  explicit CgalSurface(std::unique_ptr<Mesh> mesh);
  std::unique_ptr<Mesh> mesh_;
};

using Segments = std::vector<std::pair<glm::dvec3, glm::dvec3>>;
/// Counts the segments that meet a surface by CGAL's exact predicate, once with CGAL's own tree and once with
/// ours.
class SegmentQuestions {
 public:
  explicit SegmentQuestions(const brep::Triangles& triangles);
  ~SegmentQuestions();
  std::size_t met_by_cgal(const Segments& segments) const;
  std::size_t met_by_ours(const Segments& segments) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace octotomy::bench
