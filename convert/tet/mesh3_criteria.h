// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <CGAL/Mesh_cell_criteria_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_edge_criteria_3.h>
#include <CGAL/Mesh_facet_criteria_3.h>
#include <algorithm>

namespace octotomy::convert {

// Criteria of Mesh_3's elements, for the meshers' executables. On a surface that nearly touches itself, or
// has edges sharper than the requested angles, refinement never ends. So facets and cells whose sides are all
// shorter than a length count as good.

/// Angle of a facet and radius-edge ratio of a cell that are safe according to CGAL's manual.
inline constexpr double safe_facet_angle_deg = 25.0;
inline constexpr double safe_radius_edge = 2.5;

/// CGAL's criteria of facets or cells. They apply down to the length that `Least` returns for a point.
template <typename Base, typename Least>
class DownTo : public Base {
 public:
  DownTo(const Base& base, const Least& least) : Base(base), least_(least) {}

  template <typename Triangulation, typename Element>
  auto operator()(const Triangulation& triangulation, const Element& element) const {
    auto bad = Base::operator()(triangulation, element);
    if (bad && is_small(element)) bad = decltype(bad)();
    return bad;
  }

 private:
  /// A facet is given by a cell and the number of its corner opposite the facet.
  template <typename Cell>
  bool is_small(const std::pair<Cell, int>& facet) const {
    return is_small(facet.first, facet.second);
  }
  template <typename Cell>
  bool is_small(const Cell& cell) const {
    return is_small(cell, -1);
  }
  template <typename Cell>
  bool is_small(const Cell& cell, int without) const {
    double longest = 0.0;
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        if (i != without && j != without) {
          const auto& p = cell->vertex(i)->point().point();
          const auto& q = cell->vertex(j)->point().point();
          longest = std::max(longest, (p - q).squared_length());
        }
    const double least_mm = least_(cell->vertex(without == 0 ? 1 : 0)->point().point());
    return longest < least_mm * least_mm;
  }

  Least least_;
};

template <typename Triangulation, typename Least>
using FacetsDownTo = DownTo<CGAL::Mesh_facet_criteria_3<Triangulation>, Least>;
template <typename Triangulation, typename Least>
using CellsDownTo = DownTo<CGAL::Mesh_cell_criteria_3<Triangulation>, Least>;
template <typename Triangulation, typename Least>
using CriteriaDownTo =
    CGAL::internal::Mesh_criteria_3_impl<Triangulation, CGAL::Mesh_edge_criteria_3<Triangulation>,
                                         FacetsDownTo<Triangulation, Least>,
                                         CellsDownTo<Triangulation, Least>>;

}  // namespace octotomy::convert
