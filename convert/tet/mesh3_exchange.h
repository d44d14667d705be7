// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <CGAL/number_utils.h>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "convert/tet/mesher_child.h"

namespace octotomy::convert {

// Shared by both of Mesh_3's executables: reading a request and writing an answer in CGAL's types.

/// Appends the request's next points; false if there are fewer.
template <typename Point>
bool read_points(std::uint64_t count, std::vector<Point>& points) {
  if (count > std::numeric_limits<std::uint32_t>::max() / 3) return false;
  std::vector<double> coordinates(3 * count);
  if (!read_all(coordinates.data(), coordinates.size() * sizeof(double))) return false;
  for (std::size_t i = 0; i < coordinates.size(); i += 3)
    points.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
  return true;
}

/// A domain that is meshed from given start points. CGAL's own choice, the places where some rays meet the
/// surface, misses small parts. The caller keeps the points; the other arguments go to `Base`.
template <typename Base, typename Point>
class StartingFrom : public Base {
 public:
  template <typename... Arguments>
  explicit StartingFrom(const std::vector<Point>& start, Arguments&&... arguments)
      : Base(std::forward<Arguments>(arguments)...), start_(start) {}

  struct Construct_initial_points {  // NOLINT(readability-identifier-naming): CGAL asks for the name
    const StartingFrom& domain;
    template <typename Out>
    Out operator()(Out out, int = 0) const {
      for (const Point& p : domain.start_) *out++ = {p, domain.index_from_surface_patch_index({0, 1})};
      return out;
    }
  };
  Construct_initial_points construct_initial_points_object() const { return {*this}; }

 private:
  const std::vector<Point>& start_;
};

enum class AnswerLabels { none, of_each };

/// Writes elements and their nodes in the triangulation's order, and on request each element's region as its
/// label. False if they cannot be written.
template <typename Complex>
bool write_answer(int file, const Complex& complex, AnswerLabels with) {
  std::unordered_map<const void*, std::uint32_t> number;
  std::vector<double> points;
  std::vector<std::uint32_t> corners, labels;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    if (with == AnswerLabels::of_each)
      labels.push_back(static_cast<std::uint32_t>(complex.subdomain_index(cell)));
    for (int i = 0; i < 4; ++i) {
      const auto [at, is_new] =
          number.try_emplace(&*cell->vertex(i), static_cast<std::uint32_t>(number.size()));
      if (is_new) {
        const auto& p = cell->vertex(i)->point();
        points.insert(points.end(), {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
      }
      corners.push_back(at->second);
    }
  }
  MesherAnswer answer;
  answer.points = points.size() / 3;
  answer.tetrahedra = corners.size() / 4;
  answer.labels = labels.size();
  return write_all(file, &answer, sizeof answer) &&
         write_all(file, points.data(), points.size() * sizeof(double)) &&
         write_all(file, corners.data(), corners.size() * sizeof(std::uint32_t)) &&
         write_all(file, labels.data(), labels.size() * sizeof(std::uint32_t));
}

}  // namespace octotomy::convert
