// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/primitive_classifier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// Closed forms. A cube of index space is a parallelepiped in a primitive's own frame.
//   Ball: farthest point is a corner (distance is convex); nearest is the least of a quadratic over the cube,
//     clamped axis by axis where the map keeps right angles, otherwise the best of its 27 faces' minima.
//   Half-space: the value at the centre and its reach over the cube.
//   Box: outside parts at a corner (convexity); inside parts unless one of the 15 axes separates (Gottschalk,
//     Lin, Manocha 1996).
//   Cylinder, prism: the cube is clipped to the range along the axis and projected along it to a convex
//     polygon, which meets the cross-section or not: nothing is lost, as both are swept.
//   Torus: the cube's ranges of distance from the axis and of place along it make a rectangle that has to
//     meet a disc; where the lattice stands upright to the axis the rectangle is the cube's image, otherwise
//     it is a bound and the cube's corners and centre are witnesses.

namespace octotomy::voxel {
namespace {

// Directions shorter than 2^-40 of what they were made of are rounding.
constexpr double vanishing = 0x1p-40;

glm::dvec3 corner(int number) {
  return {number & 1 ? 1.0 : -1.0, number & 2 ? 1.0 : -1.0, number & 4 ? 1.0 : -1.0};
}

double square(double x) {
  return x * x;
}

// Least |c + columns t|^2 over -1 <= t <= 1.
double nearest_square(const glm::dmat3& columns, const glm::dvec3& c, bool orthogonal) {
  if (orthogonal) {
    glm::dvec3 t;
    for (int i = 0; i < 3; ++i)
      t[i] = std::clamp(-glm::dot(columns[i], c) / glm::dot(columns[i], columns[i]), -1.0, 1.0);
    const glm::dvec3 p = c + columns * t;
    return glm::dot(p, p);
  }
  // Each coordinate stays at an end or is free; the least over the feasible stationary points is the minimum,
  // as the function is convex.
  double least = std::numeric_limits<double>::infinity();
  for (int face = 0; face < 27; ++face) {
    const std::array<int, 3> state{face % 3 - 1, (face / 3) % 3 - 1, face / 9 - 1};
    glm::dvec3 fixed = c;
    std::array<int, 3> open{};
    int count = 0;
    for (int i = 0; i < 3; ++i) {
      if (state[static_cast<std::size_t>(i)] == 0)
        open[static_cast<std::size_t>(count++)] = i;
      else
        fixed += static_cast<double>(state[static_cast<std::size_t>(i)]) * columns[i];
    }
    // Normal equations of the free coordinates, solved as a 3 x 3 system with the others held at zero.
    glm::dmat3 normal(1.0);
    glm::dvec3 right(0.0);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j)
        normal[open[static_cast<std::size_t>(i)]][open[static_cast<std::size_t>(j)]] =
            glm::dot(columns[open[static_cast<std::size_t>(i)]], columns[open[static_cast<std::size_t>(j)]]);
      right[open[static_cast<std::size_t>(i)]] = -glm::dot(columns[open[static_cast<std::size_t>(i)]], fixed);
    }
    const glm::dvec3 t = count == 0 ? glm::dvec3(0.0) : glm::inverse(normal) * right;
    if (glm::any(glm::greaterThan(glm::abs(t), glm::dvec3(1.0)))) continue;
    const glm::dvec3 p = fixed + columns * t;
    least = std::min(least, glm::dot(p, p));
  }
  return least;
}

double farthest_square(const glm::dmat3& columns, const glm::dvec3& c) {
  double most = 0.0;
  for (int number = 0; number < 8; ++number) {
    const glm::dvec3 p = c + columns * corner(number);
    most = std::max(most, glm::dot(p, p));
  }
  return most;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

// A convex polygon, counter-clockwise. A cube clipped by two planes has at most 8 corners within and 2 x 6
// cuts.
struct Polygon {
  std::array<glm::dvec2, 48> points;
  int count = 0;
  void add(const glm::dvec2& p) { points[static_cast<std::size_t>(count++)] = p; }
  const glm::dvec2& operator[](int i) const { return points[static_cast<std::size_t>(i)]; }
};

// Andrew's monotone chain.
Polygon hull_of(Polygon cloud) {
  const auto begin = cloud.points.begin();
  std::sort(begin, begin + cloud.count,
            [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  Polygon hull;
  const auto grow = [&](const glm::dvec2& p, int keep) {
    while (hull.count >= keep + 2 &&
           cross(hull[hull.count - 1] - hull[hull.count - 2], p - hull[hull.count - 2]) <= 0.0)
      --hull.count;
    hull.add(p);
  };
  for (int i = 0; i < cloud.count; ++i) grow(cloud[i], 0);
  const int lower = hull.count - 1;
  for (int i = cloud.count - 2; i >= 0; --i) grow(cloud[i], lower);
  --hull.count;
  return hull;
}

// A cube in a swept frame: its range along, and the outline across of what of it lies in the range of the
// primitive, empty where that has no volume.
struct SweptCube {
  double low = 0.0;
  double high = 0.0;
  Polygon outline;
};

SweptCube swept_cube(const Swept& swept, const Cube& cube) {
  const glm::dvec3 c = swept.local(cube.centre);
  const glm::dmat3 columns = swept.map * cube.half;
  std::array<glm::dvec3, 8> corners;
  for (int number = 0; number < 8; ++number)
    corners[static_cast<std::size_t>(number)] = c + columns * corner(number);
  const double reach = std::abs(columns[0].z) + std::abs(columns[1].z) + std::abs(columns[2].z);
  SweptCube result{c.z - reach, c.z + reach, {}};
  if (result.high <= swept.low_mm || result.low >= swept.high_mm) return result;
  Polygon cloud;
  for (const glm::dvec3& p : corners)
    if (p.z >= swept.low_mm && p.z <= swept.high_mm) cloud.add(glm::dvec2(p));
  if (cloud.count < 8)
    for (int a = 0; a < 8; ++a)
      for (const int step : {1, 2, 4}) {
        if ((a & step) != 0) continue;
        const glm::dvec3& p = corners[static_cast<std::size_t>(a)];
        const glm::dvec3& q = corners[static_cast<std::size_t>(a | step)];
        for (const double plane : {swept.low_mm, swept.high_mm})
          if ((p.z < plane) != (q.z < plane))
            cloud.add(glm::dvec2(p + (q - p) * ((plane - p.z) / (q.z - p.z))));
      }
  if (cloud.count >= 3) result.outline = hull_of(cloud);
  return result;
}

// Least distance of the origin from a convex polygon; zero within.
double nearest(const Polygon& hull) {
  bool within = true;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0, last = hull.count - 1; i < hull.count; last = i++) {
    const glm::dvec2 edge = hull[i] - hull[last];
    within = within && cross(edge, -hull[last]) >= 0.0;
    const double t = std::clamp(-glm::dot(edge, hull[last]) / glm::dot(edge, edge), 0.0, 1.0);
    const glm::dvec2 p = hull[last] + t * edge;
    least = std::min(least, glm::dot(p, p));
  }
  return within ? 0.0 : std::sqrt(least);
}

double farthest(const Polygon& hull) {
  double most = 0.0;
  for (int i = 0; i < hull.count; ++i) most = std::max(most, glm::dot(hull[i], hull[i]));
  return std::sqrt(most);
}

// Whether a segment runs through the interior of a convex polygon, by clipping it to each side.
bool runs_through(const glm::dvec2& a, const glm::dvec2& b, const Polygon& hull) {
  double enter = 0.0;
  double leave = 1.0;
  for (int i = 0, last = hull.count - 1; i < hull.count; last = i++) {
    const glm::dvec2 edge = hull[i] - hull[last];
    const double at_a = cross(edge, a - hull[last]);
    const double at_b = cross(edge, b - hull[last]);
    if (at_a <= 0.0 && at_b <= 0.0) return false;
    if (at_a < 0.0) enter = std::max(enter, at_a / (at_a - at_b));
    if (at_b < 0.0) leave = std::min(leave, at_a / (at_a - at_b));
    if (enter >= leave) return false;
  }
  return true;
}

bool strictly_within(const glm::dvec2& p, const Polygon& hull) {
  for (int i = 0, last = hull.count - 1; i < hull.count; last = i++)
    if (cross(hull[i] - hull[last], p - hull[last]) <= 0.0) return false;
  return hull.count >= 3;
}

glm::dvec2 middle(const Polygon& hull) {
  glm::dvec2 sum(0.0);
  for (int i = 0; i < hull.count; ++i) sum += hull[i];
  return sum / static_cast<double>(hull.count);
}

// The ends of a swept primitive as planes of index space, those that cut the cube.
void add_ends(const Swept& swept, const Cube& cube, Sheets& sheets) {
  const glm::dvec3 gradient(swept.map[0].z, swept.map[1].z, swept.map[2].z);
  const double along = swept.local(cube.centre).z;
  const double reach = cube.half * (std::abs(gradient.x) + std::abs(gradient.y) + std::abs(gradient.z));
  for (const int side : {-1, 1}) {
    const double value = side < 0 ? swept.low_mm - along : along - swept.high_mm;
    if (std::abs(value) >= reach) continue;
    if (sheets.count++ == 0) sheets.first = {static_cast<double>(side) * gradient, value};
  }
}

double radius_of(const glm::dmat3& columns) {
  return std::sqrt(glm::dot(columns[0], columns[0]) + glm::dot(columns[1], columns[1]) +
                   glm::dot(columns[2], columns[2]));
}

double shortest(const glm::dmat3& columns) {
  return std::min({glm::length(columns[0]), glm::length(columns[1]), glm::length(columns[2])});
}

// A surface leaves its tangent plane by d^2 / 2r at distance d; the tangent is taken over the cube's centre,
// so that d is the radius of the ball around the cube.
double off_tangent(const glm::dmat3& map, const Cube& cube, double radius_of_curvature) {
  return square(cube.half * radius_of(map)) / (2.0 * radius_of_curvature) / shortest(map);
}

}  // namespace

BallClassifier::BallClassifier(const glm::dmat4& local_from_voxel, double radius)
    : map_(local_from_voxel), origin_(local_from_voxel[3]), radius_(radius) {
  const double slack = vanishing * square(radius_of(map_));
  orthogonal_ = std::abs(glm::dot(map_[0], map_[1])) <= slack &&
                std::abs(glm::dot(map_[0], map_[2])) <= slack &&
                std::abs(glm::dot(map_[1], map_[2])) <= slack;
}

Meets BallClassifier::meets(const Cube& cube) const {
  const glm::dvec3 c = map_ * cube.centre + origin_;
  const glm::dmat3 columns = map_ * cube.half;
  return Meets::exactly(nearest_square(columns, c, orthogonal_) < square(radius_),
                        farthest_square(columns, c) > square(radius_));
}

bool BallClassifier::contains(const glm::dvec3& p_voxel) const {
  const glm::dvec3 p = map_ * p_voxel + origin_;
  return glm::dot(p, p) <= square(radius_);
}

Sheets BallClassifier::sheets(const Cube& cube) const {
  const glm::dvec3 c = map_ * cube.centre + origin_;
  const double length = glm::length(c);
  const glm::dvec3 way = length > 0.0 ? c / length : glm::dvec3(0, 0, 1);
  return {1, {glm::transpose(map_) * way, length - radius_}, off_tangent(map_, cube, radius_)};
}

Meets HalfSpaceClassifier::meets(const Cube& cube) const {
  const double value = glm::dot(gradient_, cube.centre) + constant_;
  const double reach = cube.half * (std::abs(gradient_.x) + std::abs(gradient_.y) + std::abs(gradient_.z));
  return Meets::exactly(value - reach<0.0, value + reach> 0.0);
}

Sheets HalfSpaceClassifier::sheets(const Cube& cube) const {
  return {1, {gradient_, glm::dot(gradient_, cube.centre) + constant_}, 0.0};
}

BoxClassifier::BoxClassifier(const glm::dmat4& local_from_voxel, const glm::dvec3& half_mm)
    : map_(local_from_voxel), origin_(local_from_voxel[3]), half_mm_(half_mm) {}

Meets BoxClassifier::meets(const Cube& cube) const {
  const glm::dvec3 c = map_ * cube.centre + origin_;
  const glm::dmat3 columns = map_ * cube.half;
  bool out = false;
  for (int axis = 0; axis < 3; ++axis)
    out = out || std::abs(c[axis]) + std::abs(columns[0][axis]) + std::abs(columns[1][axis]) +
                         std::abs(columns[2][axis]) >
                     half_mm_[axis];
  if (!out) return Meets::exactly(true, false);
  const auto separates = [&](const glm::dvec3& way, double size) {
    // Parallel edges span no further axis.
    if (glm::dot(way, way) <= square(vanishing * size)) return false;
    const double box = glm::dot(half_mm_, glm::abs(way));
    const double reach = std::abs(glm::dot(columns[0], way)) + std::abs(glm::dot(columns[1], way)) +
                         std::abs(glm::dot(columns[2], way));
    return std::abs(glm::dot(c, way)) >= box + reach;
  };
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 own(0.0);
    own[axis] = 1.0;
    const glm::dvec3& a = columns[(axis + 1) % 3];
    const glm::dvec3& b = columns[(axis + 2) % 3];
    if (separates(own, 1.0) || separates(glm::cross(a, b), glm::length(a) * glm::length(b)))
      return Meets::exactly(false, true);
    for (int edge = 0; edge < 3; ++edge)
      if (separates(glm::cross(own, columns[edge]), glm::length(columns[edge])))
        return Meets::exactly(false, true);
  }
  return Meets::exactly(true, true);
}

bool BoxClassifier::contains(const glm::dvec3& p_voxel) const {
  return glm::all(glm::lessThanEqual(glm::abs(map_ * p_voxel + origin_), half_mm_));
}

Sheets BoxClassifier::sheets(const Cube& cube) const {
  Sheets sheets;
  const glm::dvec3 c = map_ * cube.centre + origin_;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 gradient(map_[0][axis], map_[1][axis], map_[2][axis]);
    const double reach = cube.half * (std::abs(gradient.x) + std::abs(gradient.y) + std::abs(gradient.z));
    for (const int side : {-1, 1}) {
      const double value = side * c[axis] - half_mm_[axis];
      if (std::abs(value) >= reach) continue;
      if (sheets.count++ == 0) sheets.first = {static_cast<double>(side) * gradient, value};
    }
  }
  return sheets;
}

Meets CylinderClassifier::meets(const Cube& cube) const {
  const SweptCube swept = swept_cube(swept_, cube);
  if (swept.outline.count < 3 || nearest(swept.outline) >= radius_mm_) return Meets::exactly(false, true);
  const bool out =
      swept.low < swept_.low_mm || swept.high > swept_.high_mm || farthest(swept.outline) > radius_mm_;
  return Meets::exactly(true, out);
}

bool CylinderClassifier::contains(const glm::dvec3& p_voxel) const {
  const glm::dvec3 p = swept_.local(p_voxel);
  return p.z >= swept_.low_mm && p.z <= swept_.high_mm && square(p.x) + square(p.y) <= square(radius_mm_);
}

Sheets CylinderClassifier::sheets(const Cube& cube) const {
  Sheets sheets;
  const glm::dvec3 c = swept_.local(cube.centre);
  const double across = std::hypot(c.x, c.y);
  if (std::abs(across - radius_mm_) < cube.half * radius_of(swept_.map)) {
    const glm::dvec3 way = across > 0.0 ? glm::dvec3(c.x / across, c.y / across, 0.0) : glm::dvec3(1, 0, 0);
    sheets = {1,
              {glm::transpose(swept_.map) * way, across - radius_mm_},
              off_tangent(swept_.map, cube, radius_mm_)};
  }
  add_ends(swept_, cube, sheets);
  return sheets;
}

Meets PrismClassifier::meets(const Cube& cube) const {
  const SweptCube swept = swept_cube(swept_, cube);
  if (swept.outline.count < 3) return Meets::exactly(false, true);
  for (const std::vector<glm::dvec2>& polygon : region_.polygons_mm)
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++)
      if (runs_through(polygon[last], polygon[i], swept.outline)) return Meets::exactly(true, true);
  if (!voxel::contains(region_, middle(swept.outline))) return Meets::exactly(false, true);
  return Meets::exactly(true, swept.low < swept_.low_mm || swept.high > swept_.high_mm);
}

bool PrismClassifier::contains(const glm::dvec3& p_voxel) const {
  const glm::dvec3 p = swept_.local(p_voxel);
  return p.z >= swept_.low_mm && p.z <= swept_.high_mm && voxel::contains(region_, glm::dvec2(p));
}

Sheets PrismClassifier::sheets(const Cube& cube) const {
  Sheets sheets;
  const SweptCube swept = swept_cube(swept_, cube);
  const glm::dvec3 c = swept_.local(cube.centre);
  for (const std::vector<glm::dvec2>& polygon : region_.polygons_mm)
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
      const glm::dvec2& a = polygon[last];
      const glm::dvec2& b = polygon[i];
      if (!runs_through(a, b, swept.outline)) continue;
      // An edge that ends within is a corner of the prism, and so is its neighbour.
      sheets.count += 1 + strictly_within(a, swept.outline) + strictly_within(b, swept.outline);
      const glm::dvec2 way = glm::normalize(glm::dvec2(b.y - a.y, a.x - b.x));
      // The side of the edge that is inside is the one where the outline's middle is, or is not.
      const glm::dvec2 probe = middle(swept.outline);
      const double at_probe = glm::dot(way, probe - a);
      const double sign = (at_probe <= 0.0) == voxel::contains(region_, probe) ? 1.0 : -1.0;
      sheets.first = {sign * (glm::transpose(swept_.map) * glm::dvec3(way, 0.0)),
                      sign * glm::dot(way, glm::dvec2(c) - a)};
    }
  add_ends(swept_, cube, sheets);
  return sheets;
}

TorusClassifier::TorusClassifier(const Swept& swept, double ring_radius_mm, double tube_radius_mm)
    : swept_(swept), ring_radius_mm_(ring_radius_mm), tube_radius_mm_(tube_radius_mm), upright_(true) {
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3& column = swept_.map[axis];
    const double slack = vanishing * glm::length(column);
    upright_ = upright_ && (std::abs(column.z) <= slack || std::hypot(column.x, column.y) <= slack);
  }
}

double TorusClassifier::value(const glm::dvec3& local_mm) const {
  return std::hypot(std::hypot(local_mm.x, local_mm.y) - ring_radius_mm_, local_mm.z) - tube_radius_mm_;
}

Meets TorusClassifier::meets(const Cube& cube) const {
  const SweptCube swept = swept_cube(swept_, cube);
  if (swept.outline.count < 3) return Meets::exactly(false, true);
  const double from = nearest(swept.outline) - ring_radius_mm_;
  const double to = farthest(swept.outline) - ring_radius_mm_;
  const glm::dvec2 closest(std::clamp(0.0, from, to), std::clamp(0.0, swept.low, swept.high));
  const glm::dvec2 remotest(std::max(std::abs(from), std::abs(to)),
                            std::max(std::abs(swept.low), std::abs(swept.high)));
  Meets meets = Meets::exactly(glm::dot(closest, closest) < square(tube_radius_mm_),
                               glm::dot(remotest, remotest) > square(tube_radius_mm_));
  if (upright_ || !meets.in || !meets.out) return meets;
  meets.sure_in = meets.sure_out = false;
  const auto witness = [&](const glm::dvec3& p_voxel) {
    const double at = value(swept_.local(p_voxel));
    meets.sure_in = meets.sure_in || at < 0.0;
    meets.sure_out = meets.sure_out || at > 0.0;
  };
  witness(cube.centre);
  for (int number = 0; number < 8 && !meets.decided(); ++number)
    witness(cube.centre + cube.half * corner(number));
  return meets;
}

Sheets TorusClassifier::sheets(const Cube& cube) const {
  const glm::dvec3 c = swept_.local(cube.centre);
  const double across = std::hypot(c.x, c.y);
  const glm::dvec2 from_ring(across - ring_radius_mm_, c.z);
  const double length = glm::length(from_ring);
  glm::dvec3 way(0, 0, 1);
  if (length > 0.0 && across > 0.0)
    way = glm::dvec3(c.x / across * from_ring.x, c.y / across * from_ring.x, from_ring.y) / length;
  // The tightest curve is the tube's, or the hole's rim.
  const double bend_mm = std::min(tube_radius_mm_, ring_radius_mm_ - tube_radius_mm_);
  return {1,
          {glm::transpose(swept_.map) * way, length - tube_radius_mm_},
          off_tangent(swept_.map, cube, bend_mm)};
}

}  // namespace octotomy::voxel
