// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <tuple>

#include "brep/mesh/error.h"
#include "brep/mesh/orientation.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

using Corner = std::uint32_t;

Corner checked_corner(const Triangles& triangles, long long corner) {
  if (corner < 0 || corner >= static_cast<long long>(triangles.points_mm.size()))
    throw Error(ErrorCode::Input, "triangle " + std::to_string(triangles.faces.size()) + " refers to point " +
                                      std::to_string(corner) + " of " +
                                      std::to_string(triangles.points_mm.size()));
  return static_cast<Corner>(corner);
}

/// The normal times twice the area (Newell). Zero if it is no larger than rounding produces for corners on a
/// line: the error of each product is less than four rounding errors of the longest distance squared.
glm::dvec3 area_vector(const std::vector<glm::dvec3>& p) {
  glm::dvec3 sum(0.0);
  double longest_square = 0.0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const glm::dvec3 a = p[i] - p[0], b = p[i + 1] - p[0];
    sum += glm::cross(a, b);
    longest_square = std::max({longest_square, glm::dot(a, a), glm::dot(b, b)});
  }
  const double rounding =
      4.0 * static_cast<double>(p.size()) * std::numeric_limits<double>::epsilon() * longest_square;
  return glm::length(sum) <= rounding ? glm::dvec3(0.0) : sum;
}

/// Projects along the normal's main axis: the other two coordinates, unchanged, in the order that preserves
/// the winding.
std::vector<glm::dvec2> projected(const std::vector<glm::dvec3>& p, const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(u, v);
  std::vector<glm::dvec2> flat;
  flat.reserve(p.size());
  for (const glm::dvec3& each : p) flat.emplace_back(each[u], each[v]);
  return flat;
}

/// Whether the triangles from corner 0 all face forward and turn around it less than once. Then they fill the
/// polygon without overlap.
bool is_fan(const std::vector<glm::dvec2>& p) {
  double angle = 0.0;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    if (orientation(p[0], p[i], p[i + 1]) <= 0) return false;
    const glm::dvec2 a = p[i] - p[0], b = p[i + 1] - p[0];
    angle += std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b));
  }
  // A fan of two triangles turns by less than a full circle. If more triangles turn by nearly one, ears are
  // cut instead.
  return p.size() == 4 || angle < 2.0 * std::numbers::pi - 1e-6;
}

bool cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

/// Whether two sides cross in the interior of both. Sides that touch or overlap do not count.
bool crosses_itself(const std::vector<glm::dvec2>& p) {
  struct Side {
    double low, high;
    std::size_t from, to;
  };
  std::vector<Side> sides;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t j = (i + 1) % p.size();
    sides.push_back({std::min(p[i].x, p[j].x), std::max(p[i].x, p[j].x), i, j});
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::tie(a.low, a.from) < std::tie(b.low, b.from); });
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size() && sides[j].low <= sides[i].high; ++j)
      if (cross(p[sides[i].from], p[sides[i].to], p[sides[j].from], p[sides[j].to])) return true;
  return false;
}

/// Triangulates a polygon that does not cross itself by cutting ears.
class Ears {
 public:
  Ears(const std::vector<glm::dvec3>& points, const std::vector<glm::dvec2>& flat)
      : points_(points), p_(flat), next_(flat.size()), before_(flat.size()), version_(flat.size(), 0) {
    const std::size_t n = flat.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      before_[i] = (i + n - 1) % n;
    }
    find_blocking();
  }

  /// The triangles as triples of corners; empty if no ear is left before the polygon is used up.
  std::vector<std::array<std::size_t, 3>> run() {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::size_t left = p_.size(), at = 0;
    while (left > 3) {
      if (ears_.empty() && !push_all(at)) return {};
      const Ear ear = ears_.top();
      ears_.pop();
      if (ear.version != version_[ear.at]) continue;
      const std::size_t b = before_[ear.at], n = next_[ear.at];
      triangles.push_back({b, ear.at, n});
      next_[b] = n;
      before_[n] = b;
      version_[ear.at] = gone;
      --left;
      at = b;
      for (const std::size_t changed : {b, n}) {
        ++version_[changed];
        push(changed);
      }
    }
    triangles.push_back({before_[at], at, next_[at]});
    return triangles;
  }

 private:
  static constexpr std::uint32_t gone = ~std::uint32_t{0};
  struct Ear {
    double roundness;
    std::size_t at;
    std::uint32_t version;
    bool operator<(const Ear& other) const {
      return roundness != other.roundness ? roundness < other.roundness : at > other.at;
    }
  };

  /// Collects corners that may lie within an ear: those that are not convex, and those that coincide with
  /// another. Cutting ears can make a corner convex, never the reverse.
  void find_blocking() {
    std::vector<std::size_t> order(p_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::tie(p_[a].x, p_[a].y, a) < std::tie(p_[b].x, p_[b].y, b);
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::size_t i = order[k];
      const bool is_double =
          (k > 0 && p_[order[k - 1]] == p_[i]) || (k + 1 < order.size() && p_[order[k + 1]] == p_[i]);
      if (is_double || orientation(p_[before_[i]], p_[i], p_[next_[i]]) <= 0) blocking_.push_back(i);
    }
  }

  bool blocks(std::size_t i, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) const {
    const glm::dvec2& q = p_[i];
    // If another corner coincides with the ear's tip, the sides at that corner must not run through the ear.
    if (q == b) return cross(a, c, q, p_[next_[i]]) || cross(a, c, q, p_[before_[i]]);
    if (q == a || q == c) return false;
    return orientation(a, b, q) >= 0 && orientation(b, c, q) >= 0 && orientation(c, a, q) >= 0;
  }

  bool is_ear(std::size_t i) const {
    const glm::dvec2 &a = p_[before_[i]], &b = p_[i], &c = p_[next_[i]];
    if (orientation(a, b, c) <= 0) return false;
    const double low = std::min({a.x, b.x, c.x}), high = std::max({a.x, b.x, c.x});
    for (auto at = std::lower_bound(blocking_.begin(), blocking_.end(), low,
                                    [&](std::size_t k, double x) { return p_[k].x < x; });
         at != blocking_.end() && p_[*at].x <= high; ++at)
      if (*at != i && *at != before_[i] && *at != next_[i] && version_[*at] != gone && blocks(*at, a, b, c))
        return false;
    return true;
  }

  bool push(std::size_t i) {
    if (!is_ear(i)) return false;
    const glm::dvec3 &a = points_[before_[i]], &b = points_[i], &c = points_[next_[i]];
    const auto square = [](const glm::dvec3& side) { return glm::dot(side, side); };
    const double longest = std::max({square(b - a), square(c - b), square(a - c)});
    ears_.push({glm::length(glm::cross(b - a, c - a)) / longest, i, version_[i]});
    return true;
  }

  /// Adds all remaining corners again, because a corner also becomes an ear when the corner that blocked it
  /// is gone.
  bool push_all(std::size_t from) {
    bool any = false;
    std::size_t i = from;
    do {
      any = push(i) || any;
      i = next_[i];
    } while (i != from);
    return any;
  }

  const std::vector<glm::dvec3>& points_;
  const std::vector<glm::dvec2>& p_;
  std::vector<std::size_t> next_, before_;
  std::vector<std::uint32_t> version_;
  std::vector<std::size_t> blocking_;  ///< sorted by x
  std::priority_queue<Ear> ears_;
};

}  // namespace

void PolygonSplitter::add_fan(const std::vector<std::uint32_t>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i)
    triangles_.faces.push_back({corners[0], corners[i - 1], corners[i]});
}

/// Many programs print six digits, which changes a coordinate by at most 5e-6 of its value; single precision
/// changes it less. Twice that still counts as planar.
void PolygonSplitter::note_bent(const std::vector<std::uint32_t>& corners, const glm::dvec3& normal) {
  glm::dvec3 middle(0.0);
  double largest = 0.0, away = 0.0;
  for (const std::uint32_t corner : corners) {
    const glm::dvec3& p = triangles_.points_mm[corner];
    middle += p / static_cast<double>(corners.size());
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  for (const std::uint32_t corner : corners)
    away = std::max(away, std::abs(glm::dot(triangles_.points_mm[corner] - middle, glm::normalize(normal))));
  if (away <= 1e-5 * largest) return;
  if (counts_.bent++ == 0) counts_.first_bent = counts_.faces - 1;
  counts_.most_bent = std::max(counts_.most_bent, away);
}

void PolygonSplitter::add(std::span<const long long> given) {
  if (given.size() < 3)
    throw Error(ErrorCode::Input, "a polygon of " + std::to_string(given.size()) +
                                      " corners after triangle " + std::to_string(triangles_.faces.size()));
  const std::size_t number = counts_.faces++;
  std::vector<std::uint32_t> corners;
  corners.reserve(given.size());
  for (const long long each : given) corners.push_back(checked_corner(triangles_, each));
  if (corners.size() == 3) return add_fan(corners);

  ++counts_.polygons;
  const auto& points = triangles_.points_mm;
  const auto is_same = [&](std::uint32_t a, std::uint32_t b) { return a == b || points[a] == points[b]; };
  corners.erase(std::unique(corners.begin(), corners.end(), is_same), corners.end());
  while (corners.size() > 1 && is_same(corners.front(), corners.back())) corners.pop_back();
  if (corners.size() < given.size()) ++counts_.repeating;
  const auto note = [number](std::size_t& count, std::size_t& first) {
    if (count++ == 0) first = number;
  };
  if (corners.size() < 3) return note(counts_.without_area, counts_.first_without_area);

  std::vector<glm::dvec3> places;
  places.reserve(corners.size());
  for (const std::uint32_t corner : corners) places.push_back(points[corner]);
  const glm::dvec3 normal = area_vector(places);
  const double length = glm::length(normal);
  if (!std::isfinite(length)) return add_fan(corners);  // read_mesh() refuses its points later
  const std::vector<glm::dvec2> flat = projected(places, normal);
  const bool fits_fan = corners.size() == 3 || is_fan(flat);
  const bool crosses = !fits_fan && crosses_itself(flat);
  if (length == 0.0 && !crosses) {
    // Adds the polygon even without area, so that its neighbours' sides have partners.
    note(counts_.without_area, counts_.first_without_area);
    return add_fan(corners);
  }
  if (length > 0.0) note_bent(corners, normal);
  if (fits_fan) return add_fan(corners);
  const auto ears = crosses ? std::vector<std::array<std::size_t, 3>>{} : Ears(places, flat).run();
  if (ears.empty()) {
    note(counts_.crossing, counts_.first_crossing);
    return add_fan(corners);
  }
  for (const auto& ear : ears)
    triangles_.faces.push_back({corners[ear[0]], corners[ear[1]], corners[ear[2]]});
}

void PolygonSplitter::add_strip(std::span<const long long> corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    std::array<std::uint32_t, 3> face{checked_corner(triangles_, corners[i - 2]),
                                      checked_corner(triangles_, corners[i - 1]),
                                      checked_corner(triangles_, corners[i])};
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
    if (i % 2 == 1) std::swap(face[0], face[1]);
    triangles_.faces.push_back(face);
    ++counts_.faces;
  }
}

std::vector<MeshFinding> PolygonCounts::findings(double unit_mm) const {
  std::vector<MeshFinding> made;
  const auto count = [](std::size_t n, const char* one, const char* many) {
    return std::to_string(n) + " " + (n == 1 ? one : many);
  };
  const auto warn = [&](const std::string& detail) {
    made.push_back({"polygons", MeshVerdict::Warn, detail});
  };
  const auto first = [](std::size_t number) { return " (the first is face " + std::to_string(number) + ")"; };
  std::string all = count(faces - polygons, "triangle", "triangles");
  if (polygons > 0)
    all += " and " + count(polygons, "polygon", "polygons") +
           " with more corners, which became triangles without new points";
  if (repeating > 0) all += "; " + count(repeating, "polygon repeats", "polygons repeat") + " a corner";
  made.push_back({"polygons", MeshVerdict::Pass, all});
  if (bent > 0)
    warn(count(bent, "polygon is", "polygons are") + " not planar, by up to " +
         short_text(most_bent * unit_mm) + " mm" + first(first_bent) +
         ": the file does not state where the surface between the corners lies");
  if (crossing > 0)
    warn(count(crossing, "polygon crosses itself", "polygons cross themselves") + first(first_crossing) +
         ": no triangulation fills it, so the fan from its first corner is used; mend it in the program that "
         "made it");
  if (without_area > 0)
    warn(count(without_area, "polygon has", "polygons have") + " no area" + first(first_without_area));
  return made;
}

}  // namespace octotomy::brep
