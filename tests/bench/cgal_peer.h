// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>

#include "brep/mesh/triangles.h"

namespace octotomy::bench {

/// CGAL's own surface mesh with its corefinement and measures called plainly, which is what its manual shows.
class CgalSurface {
 public:
  explicit CgalSurface(const brep::Triangles& triangles);
  ~CgalSurface();
  CgalSurface(CgalSurface&&) noexcept;

  enum class Operation { Union, Difference };
  /// Triangles of the result. Corefinement spoils its operands, so it is of copies, which the answer's caller
  /// makes beforehand.
  static std::size_t boolean(CgalSurface& a, CgalSurface& b, Operation operation);
  CgalSurface copy() const;

  double volume_and_area() const;

 private:
  struct Mesh;
  explicit CgalSurface(std::unique_ptr<Mesh> mesh);
  std::unique_ptr<Mesh> mesh_;
};

}  // namespace octotomy::bench
