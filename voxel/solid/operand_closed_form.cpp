// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "voxel/solid/operand.h"

// Closed forms of the operands. A cube of index space is a parallelepiped in a primitive's own frame.
//   Ball: the farthest point is a corner, because distance is convex. If the cube's edges are at right angles,
//     the nearest point is clamped edge by edge; otherwise its distance is the least of the minima over the
//     cube's 27 faces.
//   Half-space: the value at the centre is compared with its greatest change within the cube.
//   Box: the cube has a part outside if a corner is outside (convexity). It has a part inside unless one of 15
//     axes separates cube and box (Gottschalk, Lin, Manocha 1996); three axes suffice if the cube's edges run
//     along the box's.
//   Cylinder, region of a mask: the cube is clipped to the range along the axis and projected along the axis
//     to a convex polygon. As the solid is swept along the axis, the polygon meets the cross-section exactly
//     if the cube meets the solid.
//   Torus: the cube's ranges of distance from the axis and of position along the axis form a rectangle, which
//     is compared with the tube's disc. If the lattice is upright to the axis, the rectangle is the cube's
//     image. Otherwise it is a bound, and the cube's corners and centre are witnesses.

namespace octotomy::voxel {
namespace {

// A direction that is shorter than 2^-40 of the vectors from which it was computed is a rounding error.
constexpr double vanishing = 0x1p-40;

glm::dvec3 corner(int number) {
  return {number & 1 ? 1.0 : -1.0, number & 2 ? 1.0 : -1.0, number & 4 ? 1.0 : -1.0};
}

double square(double x) {
  return x * x;
}

// The least value of |c + columns t|^2 over all t with coordinates from -1 to 1.
double nearest_square(const glm::dmat3& columns, const glm::dvec3& c) {
  // Tries all combinations in which each coordinate is free or fixed at an end. The function is convex, so
  // its minimum is the least value at those stationary points that lie within the range.
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
    // The normal equations of the free coordinates, as a 3 x 3 system in which the other coordinates are
    // zero.
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

struct CornerSquares {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
};

// The squares of the least and of the largest distance of a parallelepiped's corners from the origin.
CornerSquares corner_squares(const glm::dmat3& columns, const glm::dvec3& c) {
  CornerSquares squares;
  for (int number = 0; number < 8; ++number) {
    const glm::dvec3 p = c + columns * corner(number);
    squares.least = std::min(squares.least, glm::dot(p, p));
    squares.most = std::max(squares.most, glm::dot(p, p));
  }
  return squares;
}

// Whether a point of the parallelepiped is nearer to the origin than a radius. The centre or a corner within
// the radius proves it; a plane across the direction to the centre disproves it. Other cases, and those too
// close to the radius for rounding, are decided by nearest_square().
bool comes_within(double radius, const glm::dmat3& columns, const glm::dvec3& c, double nearest_corner2) {
  const double centre2 = glm::dot(c, c), radius2 = square(radius);
  if (std::min(centre2, nearest_corner2) < radius2 * (1.0 - vanishing)) return true;
  // The least projection on the direction to the centre, multiplied by the centre's distance.
  double along = centre2;
  for (int i = 0; i < 3; ++i) along -= std::abs(glm::dot(columns[i], c));
  if (along > radius * std::sqrt(centre2) + vanishing * centre2) return false;
  return nearest_square(columns, c) < radius2;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

// A convex polygon, counter-clockwise. The capacity suffices for a cube clipped by two planes: at most 8
// corners lie between the planes, and at most 6 edges cross each plane.
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

// The limits of a solid along the third axis of its frame.
struct Range {
  double low_mm = -std::numeric_limits<double>::infinity();
  double high_mm = std::numeric_limits<double>::infinity();
};

// A cube in the solid's frame: its range along the third axis, and its outline along that axis. Only the part
// of the cube within the solid's range contributes to the outline, which is empty if that part has no volume.
struct SweptCube {
  double low = 0.0;
  double high = 0.0;
  Polygon outline;
};

SweptCube swept_cube(const LocalFrame& local, const Range& range, const Cube& cube) {
  const glm::dvec3 c = local(cube.centre);
  const glm::dmat3 columns = local.map * cube.half;
  std::array<glm::dvec3, 8> corners;
  for (int number = 0; number < 8; ++number)
    corners[static_cast<std::size_t>(number)] = c + columns * corner(number);
  const double reach = std::abs(columns[0].z) + std::abs(columns[1].z) + std::abs(columns[2].z);
  SweptCube result{c.z - reach, c.z + reach, {}};
  if (result.high <= range.low_mm || result.low >= range.high_mm) return result;
  Polygon cloud;
  for (const glm::dvec3& p : corners)
    if (p.z >= range.low_mm && p.z <= range.high_mm) cloud.add(glm::dvec2(p));
  if (cloud.count < 8)
    for (int a = 0; a < 8; ++a)
      for (const int step : {1, 2, 4}) {
        if ((a & step) != 0) continue;
        const glm::dvec3& p = corners[static_cast<std::size_t>(a)];
        const glm::dvec3& q = corners[static_cast<std::size_t>(a | step)];
        for (const double plane : {range.low_mm, range.high_mm})
          if ((p.z < plane) != (q.z < plane))
            cloud.add(glm::dvec2(p + (q - p) * ((plane - p.z) / (q.z - p.z))));
      }
  if (cloud.count >= 3) result.outline = hull_of(cloud);
  return result;
}

// The distance of the origin from a convex polygon; zero inside.
double nearest(const Polygon& hull) {
  assert(hull.count >= 3);
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

// Visits all edges that may cross the outline's interior, and some others. The rounding error of
// runs_through() is a few units in the last place of the largest coordinate; the outline's box is widened by
// far more.
template <typename Visit>
void visit_about(const EdgeTree& edges, const Polygon& outline, const Visit& visit) {
  glm::dvec2 low = outline[0], high = low;
  for (int i = 1; i < outline.count; ++i) {
    low = glm::min(low, outline[i]);
    high = glm::max(high, outline[i]);
  }
  const glm::dvec2 farthest = glm::max(glm::abs(low), glm::abs(high));
  const double slack = vanishing * std::max({farthest.x, farthest.y, edges.farthest_mm()});
  edges.visit(low - slack, high + slack, visit);
}

bool strictly_within(const glm::dvec2& p, const Polygon& hull) {
  for (int i = 0, last = hull.count - 1; i < hull.count; last = i++)
    if (cross(hull[i] - hull[last], p - hull[last]) <= 0.0) return false;
  return hull.count >= 3;
}

glm::dvec2 middle(const Polygon& hull) {
  assert(hull.count > 0);
  glm::dvec2 sum(0.0);
  for (int i = 0; i < hull.count; ++i) sum += hull[i];
  return sum / static_cast<double>(hull.count);
}

// A solid ends at two planes across `axis` of its frame. Adds the planes that cut the cube, in index space.
void add_ends(const LocalFrame& local, int axis, const Range& range, const Cube& cube, Sheets& sheets) {
  const glm::dvec3 gradient(local.map[0][axis], local.map[1][axis], local.map[2][axis]);
  const double along = local(cube.centre)[axis];
  const double reach = cube.half * (std::abs(gradient.x) + std::abs(gradient.y) + std::abs(gradient.z));
  for (const int side : {-1, 1}) {
    const double value = side < 0 ? range.low_mm - along : along - range.high_mm;
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

// A surface deviates from its tangent plane by d^2 / 2r at distance d. The tangent point lies nearest to the
// cube's centre, so d is the radius of the sphere around the cube. The result is in voxels.
double off_tangent(const glm::dmat3& map, const Cube& cube, double radius_of_curvature) {
  return square(cube.half * radius_of(map)) / (2.0 * radius_of_curvature) / shortest(map);
}

// A right-handed frame whose third axis is the given one. For an axis of the lattice, all axes are the
// lattice's.
glm::dmat3 frame_along(const glm::dvec3& axis) {
  const glm::dvec3 size = glm::abs(axis);
  glm::dvec3 other(0.0);
  other[size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2] = 1.0;
  const glm::dvec3 v = glm::normalize(glm::cross(axis, other));
  return {glm::cross(v, axis), v, axis};
}

LocalFrame frame_of(const glm::dmat3& local_from_still, const glm::dvec3& origin_mm,
                    const glm::dmat4& still_from_target) {
  return {local_from_still * glm::dmat3(still_from_target),
          local_from_still * (glm::dvec3(still_from_target[3]) - origin_mm)};
}

LocalFrame frame_of(const Ellipsoid& ellipsoid, const glm::dmat4& still_from_target) {
  glm::dmat3 unit_from_still = glm::transpose(ellipsoid.lps_from_axes);
  for (int column = 0; column < 3; ++column) unit_from_still[column] /= ellipsoid.radii_mm;
  return frame_of(unit_from_still, ellipsoid.centre_mm, still_from_target);
}

// The unit vector from a cylinder's first end to its second.
glm::dvec3 axis_of(const Cylinder& cylinder) {
  return (cylinder.to_mm - cylinder.from_mm) / glm::distance(cylinder.from_mm, cylinder.to_mm);
}

}  // namespace

double share_below(const Tangent& tangent, double half) {
  assert(half > 0.0);
  glm::dvec3 m = glm::abs(tangent.gradient);
  const double sum = m.x + m.y + m.z;
  if (sum == 0.0) return tangent.value <= 0.0 ? 1.0 : 0.0;
  // The plane's position on the way from the innermost corner, 0, to the opposite corner, 1.
  const double alpha = 0.5 - tangent.value / (2.0 * half * sum);
  if (alpha <= 0.0) return 0.0;
  if (alpha >= 1.0) return 1.0;
  m /= sum;
  if (m.x > m.y) std::swap(m.x, m.y);
  if (m.y > m.z) std::swap(m.y, m.z);
  if (m.x > m.y) std::swap(m.x, m.y);
  // In the cubic cases a difference in which digits cancel is divided by m.x. If m.x is below the square root
  // of the machine's epsilon, the plane counts as parallel to that axis, which changes the share by less than
  // m.x.
  if (m.x < 0x1p-26) m.x = 0.0;
  const double a = std::min(alpha, 1.0 - alpha);
  const double pair = m.x + m.y;
  const double volume = 6.0 * m.x * m.y * m.z;
  const auto beyond = [&](double edge) { return edge * edge * (edge - 3.0 * a); };
  double below = 0.0;
  if (a < m.x)
    below = a * a * a / volume;
  else if (a < m.y)
    below = (3.0 * a * (a - m.x) + m.x * m.x) / (6.0 * m.y * m.z);
  else if (a < std::min(pair, m.z))
    below = (a * a * (3.0 * pair - a) + beyond(m.x) + beyond(m.y)) / volume;
  else if (m.z < pair)
    below = (a * a * (3.0 - 2.0 * a) + beyond(m.x) + beyond(m.y) + beyond(m.z)) / volume;
  else
    below = (2.0 * a - pair) / (2.0 * m.z);
  below = std::clamp(below, 0.0, 0.5);
  return alpha <= 0.5 ? below : 1.0 - below;
}

BallOperand::BallOperand(const Sphere& sphere, const glm::dmat4& still_from_target)
    : BallOperand(frame_of(glm::dmat3(1.0), sphere.centre_mm, still_from_target), sphere.radius_mm) {}

BallOperand::BallOperand(const Ellipsoid& ellipsoid, const glm::dmat4& still_from_target)
    : BallOperand(frame_of(ellipsoid, still_from_target), 1.0) {}

BallOperand::BallOperand(const LocalFrame& local, double radius) : local_(local), radius_(radius) {
  const glm::dmat3& edges = local.map;
  const double slack = vanishing * square(radius_of(edges));
  orthogonal_ = std::abs(glm::dot(edges[0], edges[1])) <= slack &&
                std::abs(glm::dot(edges[0], edges[2])) <= slack &&
                std::abs(glm::dot(edges[1], edges[2])) <= slack;
  edge_lengths_ = {glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])};
  edges_from_local_ = glm::transpose(
      glm::dmat3(edges[0] / edge_lengths_.x, edges[1] / edge_lengths_.y, edges[2] / edge_lengths_.z));
}

Meets BallOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  const glm::dvec3 c = local_(cube.centre);
  if (orthogonal_) {
    const glm::dvec3 away = glm::abs(edges_from_local_ * c);
    const glm::dvec3 reach = cube.half * edge_lengths_;
    const glm::dvec3 nearest = glm::max(away - reach, 0.0);
    const glm::dvec3 farthest = away + reach;
    return Meets::exactly(glm::dot(nearest, nearest) < square(radius_),
                          glm::dot(farthest, farthest) > square(radius_));
  }
  const glm::dmat3 columns = local_.map * cube.half;
  const CornerSquares corners = corner_squares(columns, c);
  return Meets::exactly(comes_within(radius_, columns, c, corners.least), corners.most > square(radius_));
}

Sheets BallOperand::sheets(const Cube& cube) const {
  const glm::dvec3 c = local_(cube.centre);
  const double length = glm::length(c);
  const glm::dvec3 way = length > 0.0 ? c / length : glm::dvec3(0, 0, 1);
  return {1, {glm::transpose(local_.map) * way, length - radius_}, off_tangent(local_.map, cube, radius_)};
}

HalfSpaceOperand::HalfSpaceOperand(const HalfSpace& half_space, const glm::dmat4& still_from_target)
    : gradient_(glm::transpose(glm::dmat3(still_from_target)) * half_space.normal),
      constant_(glm::dot(half_space.normal, glm::dvec3(still_from_target[3])) - half_space.offset_mm) {}

Meets HalfSpaceOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  const double value = glm::dot(gradient_, cube.centre) + constant_;
  const double reach = cube.half * (std::abs(gradient_.x) + std::abs(gradient_.y) + std::abs(gradient_.z));
  return Meets::exactly(value - reach<0.0, value + reach> 0.0);
}

Sheets HalfSpaceOperand::sheets(const Cube& cube) const {
  return {1, {gradient_, glm::dot(gradient_, cube.centre) + constant_}, 0.0};
}

BoxOperand::BoxOperand(const Box& box, const glm::dmat4& still_from_target)
    : BoxOperand(frame_of(glm::dmat3(1.0), 0.5 * (box.low_mm + box.high_mm), still_from_target),
                 0.5 * (box.high_mm - box.low_mm)) {}

BoxOperand::BoxOperand(const OrientedBox& box, const glm::dmat4& still_from_target)
    : BoxOperand(frame_of(glm::transpose(box.lps_from_axes), box.centre_mm, still_from_target), box.half_mm) {
}

BoxOperand::BoxOperand(const LocalFrame& local, const glm::dvec3& half_mm)
    : local_(local),
      half_mm_(half_mm),
      reach_mm_(glm::abs(local.map[0]) + glm::abs(local.map[1]) + glm::abs(local.map[2])),
      straight_(true) {
  for (int edge = 0; edge < 3; ++edge) {
    const glm::dvec3 size = glm::abs(local.map[edge]);
    const double longest = std::max({size.x, size.y, size.z});
    straight_ = straight_ && size.x + size.y + size.z - longest <= vanishing * longest;
  }
}

Meets BoxOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  const glm::dvec3 c = local_(cube.centre);
  const glm::dvec3 reach_mm = cube.half * reach_mm_;
  const glm::dvec3 away_mm = glm::abs(c);
  if (glm::any(glm::greaterThanEqual(away_mm, half_mm_ + reach_mm))) return Meets::exactly(false, true);
  if (glm::all(glm::lessThanEqual(away_mm + reach_mm, half_mm_))) return Meets::exactly(true, false);
  if (straight_) return Meets::exactly(true, true);
  const glm::dmat3 columns = local_.map * cube.half;
  const auto separates = [&](const glm::dvec3& way, double size) {
    // The cross product of parallel edges is zero and defines no axis.
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
    if (separates(glm::cross(a, b), glm::length(a) * glm::length(b))) return Meets::exactly(false, true);
    for (int edge = 0; edge < 3; ++edge)
      if (separates(glm::cross(own, columns[edge]), glm::length(columns[edge])))
        return Meets::exactly(false, true);
  }
  return Meets::exactly(true, true);
}

Sheets BoxOperand::sheets(const Cube& cube) const {
  Sheets sheets;
  for (int axis = 0; axis < 3; ++axis)
    add_ends(local_, axis, {-half_mm_[axis], half_mm_[axis]}, cube, sheets);
  return sheets;
}

CylinderOperand::CylinderOperand(const Cylinder& cylinder, const glm::dmat4& still_from_target)
    : local_(frame_of(glm::transpose(frame_along(axis_of(cylinder))), cylinder.from_mm, still_from_target)),
      length_mm_(glm::distance(cylinder.from_mm, cylinder.to_mm)),
      radius_mm_(cylinder.radius_mm) {}

Meets CylinderOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  const SweptCube swept = swept_cube(local_, {0.0, length_mm_}, cube);
  if (swept.outline.count < 3 || nearest(swept.outline) >= radius_mm_) return Meets::exactly(false, true);
  const bool out = swept.low < 0.0 || swept.high > length_mm_ || farthest(swept.outline) > radius_mm_;
  return Meets::exactly(true, out);
}

Sheets CylinderOperand::sheets(const Cube& cube) const {
  Sheets sheets;
  const glm::dvec3 c = local_(cube.centre);
  const double across = std::hypot(c.x, c.y);
  if (std::abs(across - radius_mm_) < cube.half * radius_of(local_.map)) {
    const glm::dvec3 way = across > 0.0 ? glm::dvec3(c.x / across, c.y / across, 0.0) : glm::dvec3(1, 0, 0);
    sheets = {1,
              {glm::transpose(local_.map) * way, across - radius_mm_},
              off_tangent(local_.map, cube, radius_mm_)};
  }
  add_ends(local_, 2, {0.0, length_mm_}, cube, sheets);
  return sheets;
}

// A region is the cross-section of an unbounded solid, so positions along the frame's third axis are all 0.
LocalFrame MaskOperand::Projected::frame() const {
  LocalFrame frame{glm::dmat3(0.0), glm::dvec3(u.constant, v.constant, 0.0)};
  for (int axis = 0; axis < 3; ++axis) frame.map[axis] = {u.gradient[axis], v.gradient[axis], 0.0};
  return frame;
}

Meets MaskOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  Meets all = Meets::exactly(true, false);
  for (const Projected& projected : regions_) {
    const Polygon outline = swept_cube(projected.frame(), {}, cube).outline;
    bool cut = false;
    visit_about(projected.edges, outline, [&](const glm::dvec2& a, const glm::dvec2& b, std::uint32_t) {
      cut = cut || runs_through(a, b, outline);
    });
    if (cut)
      all = all & Meets::exactly(true, true);
    else if (!projected.edges.contains(middle(outline)))
      return Meets::exactly(false, true);
  }
  return all;
}

bool MaskOperand::contains(const glm::dvec3& p_voxel) const {
  return std::all_of(regions_.begin(), regions_.end(), [&](const Projected& projected) {
    return projected.edges.contains({projected.u(p_voxel), projected.v(p_voxel)});
  });
}

Sheets MaskOperand::sheets(const Cube& cube) const {
  Sheets sheets;
  for (const Projected& projected : regions_) {
    const LocalFrame local = projected.frame();
    const Polygon outline = swept_cube(local, {}, cube).outline;
    std::optional<std::uint32_t> taken;
    visit_about(projected.edges, outline,
                [&](const glm::dvec2& a, const glm::dvec2& b, std::uint32_t number) {
                  if (!runs_through(a, b, outline)) return;
                  // If an end of an edge is inside the outline, a corner of the region is, and the
                  // neighbouring edge adds another surface.
                  sheets.count += 1 + strictly_within(a, outline) + strictly_within(b, outline);
                  // If several edges qualify, the last in the polygons' order supplies the tangent.
                  if (taken && *taken > number) return;
                  taken = number;
                  const glm::dvec2 way = glm::normalize(glm::dvec2(b.y - a.y, a.x - b.x));
                  // The inner side of the edge is determined by whether the outline's middle is inside the
                  // region.
                  const glm::dvec2 probe = middle(outline);
                  const double at_probe = glm::dot(way, probe - a);
                  const double sign = (at_probe <= 0.0) == projected.edges.contains(probe) ? 1.0 : -1.0;
                  sheets.first = {sign * (glm::transpose(local.map) * glm::dvec3(way, 0.0)),
                                  sign * glm::dot(way, glm::dvec2(local(cube.centre)) - a)};
                });
  }
  return sheets;
}

TorusOperand::TorusOperand(const Torus& torus, const glm::dmat4& still_from_target)
    : local_(frame_of(glm::transpose(frame_along(torus.axis)), torus.centre_mm, still_from_target)),
      ring_radius_mm_(torus.ring_radius_mm),
      tube_radius_mm_(torus.tube_radius_mm),
      upright_(true) {
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3& column = local_.map[axis];
    const double slack = vanishing * glm::length(column);
    upright_ = upright_ && (std::abs(column.z) <= slack || std::hypot(column.x, column.y) <= slack);
  }
}

Meets TorusOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  const SweptCube swept = swept_cube(local_, {}, cube);
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
    const double at = value(local_(p_voxel));
    meets.sure_in = meets.sure_in || at < 0.0;
    meets.sure_out = meets.sure_out || at > 0.0;
  };
  witness(cube.centre);
  for (int number = 0; number < 8 && !meets.decided(); ++number)
    witness(cube.centre + cube.half * corner(number));
  return meets;
}

Sheets TorusOperand::sheets(const Cube& cube) const {
  const glm::dvec3 c = local_(cube.centre);
  const double across = std::hypot(c.x, c.y);
  const glm::dvec2 from_ring(across - ring_radius_mm_, c.z);
  const double length = glm::length(from_ring);
  glm::dvec3 way(0, 0, 1);
  if (length > 0.0 && across > 0.0)
    way = glm::dvec3(c.x / across * from_ring.x, c.y / across * from_ring.x, from_ring.y) / length;
  // The smallest radius of curvature is the tube's radius or that of the hole.
  const double bend_mm = std::min(tube_radius_mm_, ring_radius_mm_ - tube_radius_mm_);
  return {1,
          {glm::transpose(local_.map) * way, length - tube_radius_mm_},
          off_tangent(local_.map, cube, bend_mm)};
}

}  // namespace octotomy::voxel
