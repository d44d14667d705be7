// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

namespace octotomy::tests {

using Point = std::array<double, 3>;

/// A surface in the form that VTK reads.
struct FlatSurface {
  std::vector<Point> points;
  std::vector<std::array<unsigned, 3>> faces;
};

/// vtkImplicitPolyDataDistance at points: negative inside.
std::vector<double> vtk_signed_distances(const FlatSurface& surface, const std::vector<Point>& points);

/// vtkDistancePolyDataFilter's signed distances of the vertices of `from`, in their order.
std::vector<double> vtk_vertex_distances(const FlatSurface& from, const FlatSurface& to);

}  // namespace octotomy::tests
