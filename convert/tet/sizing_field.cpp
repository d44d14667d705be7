// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/sizing_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <utility>

#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::convert {
namespace {

constexpr std::size_t most_triangles = std::size_t{1} << 22;

/// The longest side that is not halved, in multiples of the size. This side of 4/3 and its halves of 2/3 are
/// equally far from the size.
constexpr double longest_share() {
  return 4.0 / 3.0;
}

[[noreturn]] void refuse_number() {
  throw voxel::Error(voxel::ErrorCode::Resource, "refinement would take a surface of more than " +
                                                     std::to_string(most_triangles) +
                                                     " triangles: request larger elements");
}

/// The least number of triangles into which a surface is divided. A part has at most the area of an
/// equilateral triangle of the longest side. The size at a part is at most that at the whole triangle's
/// middle plus the growth over the distance from there.
double least_count(const brep::Triangles& surface, const SizingField& sizes) {
  const auto& p = surface.points_mm;
  std::vector<glm::dvec3> middles_mm;
  middles_mm.reserve(surface.faces.size());
  for (const auto& [a, b, c] : surface.faces) middles_mm.push_back((p[a] + p[b] + p[c]) / 3.0);
  const std::vector<double> sizes_mm = sizes.at_mm(middles_mm);
  double count = 0.0;
  for (std::size_t f = 0; f < surface.faces.size(); ++f) {
    const auto& [a, b, c] = surface.faces[f];
    const double reach_mm = std::max({glm::distance(p[a], middles_mm[f]), glm::distance(p[b], middles_mm[f]),
                                      glm::distance(p[c], middles_mm[f])});
    const double side_mm = longest_share() * (sizes_mm[f] + sizing_growth() * reach_mm);
    const double area_mm2 = 0.5 * glm::length(glm::cross(p[b] - p[a], p[c] - p[a]));
    count += area_mm2 / (std::sqrt(3.0) / 4.0 * side_mm * side_mm);
  }
  return count;
}

using Side = std::pair<std::uint32_t, std::uint32_t>;  // the lower end first
using Face = std::array<std::uint32_t, 3>;

/// One round of halving: sides that are too long, and the longest ones of triangles that have any.
class Round {
 public:
  Round(brep::Triangles& surface, const SizingField& sizes) : surface_(surface) {
    mark_long(sizes);
    mark_longest();
  }

  /// False if no side is too long.
  bool split() {
    if (middle_.empty()) return false;
    for (auto& [side, middle] : middle_) {
      middle = static_cast<std::uint32_t>(surface_.points_mm.size());
      surface_.points_mm.push_back(0.5 * (at(side.first) + at(side.second)));
    }
    std::vector<Face> faces;
    for (const Face& face : surface_.faces) add(face, faces);
    surface_.faces = std::move(faces);
    return true;
  }

 private:
  const glm::dvec3& at(std::uint32_t v) const { return surface_.points_mm[v]; }
  static Side side_of(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }
  double length_mm(const Side& side) const { return glm::distance(at(side.first), at(side.second)); }

  void mark_long(const SizingField& sizes) {
    std::vector<Side> sides;
    for (const Face& face : surface_.faces)
      for (std::size_t i = 0; i < 3; ++i) {
        const Side side = side_of(face.at(i), face.at((i + 1) % 3));
        if (length_mm(side) > longest_share() * sizes.least_mm()) sides.push_back(side);
      }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    std::vector<glm::dvec3> middles_mm;
    middles_mm.reserve(sides.size());
    for (const Side& side : sides) middles_mm.push_back(0.5 * (at(side.first) + at(side.second)));
    const std::vector<double> sizes_mm = sizes.at_mm(middles_mm);
    for (std::size_t i = 0; i < sides.size(); ++i)
      if (length_mm(sides[i]) > longest_share() * sizes_mm[i]) middle_.emplace(sides[i], 0);
  }

  /// The side across which a triangle is halved: its longest; of equally long sides, one that both of its
  /// triangles choose.
  std::size_t longest(const Face& face) const {
    std::size_t best = 0;
    const auto key = [&](std::size_t i) {
      const Side side = side_of(face.at(i), face.at((i + 1) % 3));
      return std::pair(length_mm(side), side);
    };
    for (std::size_t i = 1; i < 3; ++i)
      if (key(i) > key(best)) best = i;
    return best;
  }

  bool is_marked(std::uint32_t a, std::uint32_t b) const { return middle_.contains(side_of(a, b)); }

  void mark_longest() {
    for (bool any = !middle_.empty(); any;) {
      any = false;
      for (const Face& face : surface_.faces) {
        if (!is_marked(face[0], face[1]) && !is_marked(face[1], face[2]) && !is_marked(face[2], face[0]))
          continue;
        const std::size_t i = longest(face);
        any = middle_.emplace(side_of(face.at(i), face.at((i + 1) % 3)), 0).second || any;
      }
    }
  }

  /// Halves a triangle whose longest side is marked; then halves each half that contains another marked side
  /// of the triangle.
  void add(const Face& face, std::vector<Face>& faces) const {
    const std::size_t i = longest(face);
    const std::uint32_t a = face.at(i), b = face.at((i + 1) % 3), c = face.at((i + 2) % 3);
    const auto middle = middle_.find(side_of(a, b));
    if (middle == middle_.end()) {
      faces.push_back(face);
      return;
    }
    add_half({middle->second, b, c}, faces);
    add_half({c, a, middle->second}, faces);
  }

  /// In a half, only the side that was a side of the triangle can be marked.
  void add_half(const Face& half, std::vector<Face>& faces) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = half.at(i), b = half.at((i + 1) % 3), c = half.at((i + 2) % 3);
      const auto middle = middle_.find(side_of(a, b));
      if (middle == middle_.end()) continue;
      faces.push_back({middle->second, b, c});
      faces.push_back({c, a, middle->second});
      return;
    }
    faces.push_back(half);
  }

  brep::Triangles& surface_;
  std::map<Side, std::uint32_t> middle_;  ///< of the sides to halve, and their new points
};

glm::dvec3 middle_mm(const Tetrahedra& tetrahedra, std::size_t tet) {
  const TetCorners corners = corners_mm(tetrahedra, tet);
  return 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
}

double mean_side_mm(const Tetrahedra& tetrahedra, std::size_t tet) {
  const TetCorners corners = corners_mm(tetrahedra, tet);
  double sum_mm = 0.0;
  for (const auto& [a, b] : sides_of_tet) sum_mm += glm::distance(corners.at(a), corners.at(b));
  return sum_mm / static_cast<double>(sides_of_tet.size());
}

/// The element whose middle is nearest, of equals the first.
std::size_t nearest_tet(const Tetrahedra& tetrahedra, const glm::dvec3& p_mm) {
  using Nearest = std::pair<double, std::size_t>;
  return tbb::parallel_reduce(
             tbb::blocked_range<std::size_t>(0, tetrahedra.tets.size()),
             Nearest{std::numeric_limits<double>::infinity(), 0},
             [&](const tbb::blocked_range<std::size_t>& range, Nearest nearest) {
               for (std::size_t t = range.begin(); t < range.end(); ++t)
                 nearest = std::min(nearest, {glm::distance(middle_mm(tetrahedra, t), p_mm), t});
               return nearest;
             },
             [](const Nearest& a, const Nearest& b) { return std::min(a, b); })
      .second;
}

/// A refinement's points, and some of its surface's.
std::vector<glm::dvec3> places_mm(const Refinement& refinement) {
  constexpr std::size_t most = 100;
  std::vector<glm::dvec3> places = refinement.points_mm;
  const std::vector<glm::dvec3>& surface = refinement.surface.points_mm;
  const std::size_t step = std::max<std::size_t>(1, surface.size() / most);
  for (std::size_t i = 0; i < surface.size(); i += step) places.push_back(surface[i]);
  return places;
}

}  // namespace

SizingField::SizingField(const std::vector<Refinement>& finer) {
  for (const Refinement& where : finer) {
    if (!(where.size_mm > 0.0) || !std::isfinite(where.size_mm))
      throw voxel::InvalidInput("a refinement's size must be above zero");
    if (where.points_mm.empty() && where.surface.faces.empty())
      throw voxel::InvalidInput("a refinement needs a place: points or a surface with triangles");
    SizeSource place{where.points_mm, nullptr, where.size_mm};
    if (!where.surface.faces.empty()) place.surface = std::make_shared<brep::SurfaceTree>(where.surface);
    places_.push_back(std::move(place));
    least_mm_ = std::min(least_mm_, where.size_mm);
  }
}

std::vector<double> SizingField::at_mm(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<double> sizes_mm(points_mm.size(), std::numeric_limits<double>::infinity());
  for (const SizeSource& place : places_) {
    std::vector<double> ways_mm(points_mm.size(), std::numeric_limits<double>::infinity());
    if (place.surface) ways_mm = place.surface->distances_mm(points_mm);
    tbb::parallel_for(std::size_t{0}, points_mm.size(), [&](std::size_t i) {
      for (const glm::dvec3& p_mm : place.points_mm)
        ways_mm[i] = std::min(ways_mm[i], glm::distance(points_mm[i], p_mm));
      sizes_mm[i] = std::min(sizes_mm[i], place.size_mm + sizing_growth() * ways_mm[i]);
    });
  }
  return sizes_mm;
}

brep::Triangles refined_surface(const brep::Triangles& surface, const SizingField& sizes) {
  brep::Triangles finer = surface;
  do {
    // Checked every round, because the estimate improves as triangles become smaller.
    if (finer.faces.size() > most_triangles ||
        least_count(finer, sizes) > static_cast<double>(most_triangles))
      refuse_number();
  } while (Round(finer, sizes).split());
  return finer;
}

std::optional<std::string> coarse_place(const Tetrahedra& tetrahedra, const std::vector<Refinement>& finer) {
  constexpr double far_larger = 3.0;
  if (finer.empty() || tetrahedra.tets.empty()) return std::nullopt;
  const SizingField sizes(finer);
  double worst = far_larger, side_mm = 0.0, asked_mm = 0.0;
  glm::dvec3 at_mm(0.0);
  std::size_t count = 0;
  for (const Refinement& refinement : finer)
    for (const glm::dvec3& place_mm : places_mm(refinement)) {
      const std::size_t tet = nearest_tet(tetrahedra, place_mm);
      const double own_mm = mean_side_mm(tetrahedra, tet);
      const double share = own_mm / sizes.at_mm({middle_mm(tetrahedra, tet)}).front();
      if (share <= far_larger) continue;
      ++count;
      if (share <= worst) continue;
      worst = share;
      side_mm = own_mm;
      asked_mm = refinement.size_mm;
      at_mm = place_mm;
    }
  if (count == 0) return std::nullopt;
  return "elements at " + voxel::rounded(at_mm) + " mm have sides of " + voxel::rounded(side_mm) +
         " mm where " + voxel::rounded(asked_mm) + " mm were requested" +
         (count > 1 ? ", the worst of " + std::to_string(count) + " such places" : "") +
         ": fine elements grow inward from the surface only: choose a place on the surface, or bound the "
         "volume of all elements";
}

}  // namespace octotomy::convert
