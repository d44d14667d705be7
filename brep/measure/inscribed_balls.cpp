// SPDX-License-Identifier: AGPL-3.0-or-later
// A ball that touches a plane at one point lies within every larger ball that touches there. So one pass
// through the tree suffices: the ball shrinks at each triangle of which it contains a point, and a node that
// the ball does not reach is out of reach of the smaller balls too.
#include "brep/measure/inscribed_balls.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/distance.h"
#include "brep/mesh/halving.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t leaf_size = 4;
/// Shares of a radius. `rounding`: a thousand times the rounding of distances. `coarse`: the largest excess
/// of a radius after `exact_nodes` nodes. All triangles of a sphere touch its largest ball, so excluding each
/// of them exactly would cost n for each ball.
constexpr double rounding = 1e-12, coarse = 5e-3;
constexpr int exact_nodes = 128;
constexpr double touching_share = 0.025;
constexpr double no_larger = 1.0 + 1e-3;

/// A stack of nodes; trees that are halved have at most 32 levels.
class Pending {
 public:
  explicit Pending(std::uint32_t root) { push(root); }
  bool empty() const { return count_ == 0; }
  void push(std::uint32_t node) {
    assert(count_ < nodes_.size());
    nodes_[count_++] = node;
  }
  std::uint32_t pop() { return nodes_[--count_]; }

 private:
  std::array<std::uint32_t, 72> nodes_{};
  std::size_t count_ = 0;
};

double squared(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// The distance from `p` at which a line passes a triangle, by Cramer's rule; 0 if the line misses it.
/// Triangles are widened by more than rounding, so that a ray passes at least one on a closed surface.
double passes(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& p,
              const glm::dvec3& along) {
  constexpr double widened = 1e-9;  // of a triangle's sides
  const glm::dvec3 u = b - a, v = c - a, across = glm::cross(along, v);
  const double volume = glm::dot(u, across);
  if (volume == 0.0) return 0.0;
  const glm::dvec3 from = p - a, turned = glm::cross(from, u);
  const double at_u = glm::dot(from, across) / volume, at_v = glm::dot(along, turned) / volume;
  if (!(at_u >= -widened && at_v >= -widened && at_u + at_v <= 1.0 + widened)) return 0.0;
  return glm::dot(v, turned) / volume;
}

double squared_distance_to_box(const glm::dvec3& p, const glm::dvec3& low, const glm::dvec3& high) {
  return squared(glm::max(glm::max(low - p, p - high), glm::dvec3(0.0)));
}

}  // namespace

double InscribedBalls::Node::squared_distance(const glm::dvec3& p_mm) const {
  const double along = glm::dot(p_mm, across);
  const double to_slab = std::max({slab_low_mm - along, along - slab_high_mm, 0.0});
  return std::max(squared_distance_to_box(p_mm, low_mm, high_mm), to_slab * to_slab);
}

void InscribedBalls::add_slab(Node& node) const {
  glm::dvec3 sum(0.0);
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    sum += glm::cross(triangles_[i].b_mm - triangles_[i].a_mm, triangles_[i].c_mm - triangles_[i].a_mm);
  const double length = glm::length(sum);
  if (!(length > 0.0))
    return;  // `across` stays 0: then the slab is ignored, because its distance from any
             // point is 0
  node.across = sum / length;
  node.slab_low_mm = std::numeric_limits<double>::infinity();
  node.slab_high_mm = -node.slab_low_mm;
  for (std::uint32_t i = node.begin; i < node.end; ++i)
    for (const glm::dvec3& corner : {triangles_[i].a_mm, triangles_[i].b_mm, triangles_[i].c_mm}) {
      const double along = glm::dot(corner, node.across);
      node.slab_low_mm = std::min(node.slab_low_mm, along);
      node.slab_high_mm = std::max(node.slab_high_mm, along);
    }
}

InscribedBalls::InscribedBalls(const Triangles& surface) {
  const auto count = static_cast<std::uint32_t>(surface.faces.size());
  assert(count > 0);
  const auto corners_of = [&](std::uint32_t face) {
    const auto& [a, b, c] = surface.faces[face];
    return Corners{surface.points_mm[a], surface.points_mm[b], surface.points_mm[c]};
  };
  std::vector<Centred> items(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Corners t = corners_of(i);
    items[i] = {(t.a_mm + t.b_mm + t.c_mm) / 3.0, i};
  }
  triangles_.resize(count);
  nodes_.resize(halving_nodes(count, leaf_size));
  const auto leaf = [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
    Node& node = nodes_[self];
    node.begin = begin;
    node.end = end;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Corners& t = triangles_[i] = corners_of(items[i].number);
      const glm::dvec3 low = glm::min(glm::min(t.a_mm, t.b_mm), t.c_mm),
                       high = glm::max(glm::max(t.a_mm, t.b_mm), t.c_mm);
      node.low_mm = i == begin ? low : glm::min(node.low_mm, low);
      node.high_mm = i == begin ? high : glm::max(node.high_mm, high);
    }
  };
  const auto inner = [&](std::uint32_t self, std::uint32_t second) {
    const Node &one = nodes_[self + 1], &other = nodes_[second];
    Node& node = nodes_[self];
    node.low_mm = glm::min(one.low_mm, other.low_mm);
    node.high_mm = glm::max(one.high_mm, other.high_mm);
    node.begin = one.begin;
    node.end = other.end;
    node.second = second;
  };
  halve(items, leaf_size, leaf, inner, 0, 0, count);
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) { add_slab(nodes_[i]); });
  step_mm_ = 0x1p-30 * glm::length(nodes_[0].high_mm - nodes_[0].low_mm);
}

double InscribedBalls::ray_mm(const glm::dvec3& p_mm, const glm::dvec3& normal) const {
  const glm::dvec3 along = -normal;
  double nearest = std::numeric_limits<double>::infinity();
  // Whether the ray enters a box before the nearest triangle so far, by slabs.
  const auto enters = [&](const Node& node) {
    double from = 0.0, to = nearest;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = node.low_mm[axis] - step_mm_ - p_mm[axis],
                   high = node.high_mm[axis] + step_mm_ - p_mm[axis];
      if (along[axis] == 0.0) {
        if (low > 0.0 || high < 0.0) return false;
        continue;
      }
      const auto [near, far] = std::minmax({low / along[axis], high / along[axis]});
      from = std::max(from, near);
      to = std::min(to, far);
    }
    return from <= to;
  };
  Pending pending(0);
  while (!pending.empty()) {
    const std::uint32_t number = pending.pop();
    const Node& node = nodes_[number];
    if (!enters(node)) continue;
    if (node.second != 0) {
      pending.push(node.second);
      pending.push(number + 1);
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (const double t = passes(triangles_[i].a_mm, triangles_[i].b_mm, triangles_[i].c_mm, p_mm, along);
          t > step_mm_)
        nearest = std::min(nearest, t);
  }
  return nearest;
}

Ball InscribedBalls::touching(const glm::dvec3& p_mm, const glm::dvec3& normal, double ray_mm,
                              double least_cosine) const {
  double radius = 0.5 * ray_mm;
  glm::dvec3 centre = p_mm - radius * normal;
  // Triangles of the point's own sheet. For a smaller ball they may belong to another sheet.
  std::vector<std::uint32_t> own_sheet;
  const auto shrink = [&](std::uint32_t triangle, double slack) {
    const Corners& t = triangles_[triangle];
    // The nearest point moves as the ball shrinks; on a plane the rounds converge like Newton's.
    for (int round = 0; round < 64; ++round) {
      const glm::dvec3 foot = nearest_of_triangle(centre, t.a_mm, t.b_mm, t.c_mm);
      const double distance = glm::distance(foot, centre);
      if (distance >= radius * (1.0 - slack)) return;
      const glm::dvec3 to_point = p_mm - foot;
      const double depth = glm::dot(to_point, normal);
      if (!(depth > 0.0)) return;
      const double cosine = glm::dot(normal, foot - centre) / std::max(distance, rounding * radius);
      if (cosine > least_cosine) {
        own_sheet.push_back(triangle);
        return;
      }
      const double smaller = 0.5 * squared(to_point) / depth;
      if (!(smaller < radius)) return;
      radius = smaller;
      centre = p_mm - radius * normal;
    }
  };
  Pending pending(0);
  for (int visited = 0; !pending.empty(); ++visited) {
    const double slack = visited < exact_nodes ? rounding : coarse;
    const std::uint32_t number = pending.pop();
    const Node& node = nodes_[number];
    const double reach = radius * (1.0 - slack);
    if (node.squared_distance(centre) >= reach * reach) continue;
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) shrink(i, slack);
      continue;
    }
    // The half nearer to the point comes first, because it shrinks the ball most.
    std::uint32_t near = number + 1, far = node.second;
    if (nodes_[far].squared_distance(p_mm) < nodes_[near].squared_distance(p_mm)) std::swap(near, far);
    pending.push(far);
    pending.push(near);
  }
  for (double before = 2.0 * radius; !own_sheet.empty() && radius < before * (1.0 - rounding);) {
    before = radius;
    for (const std::uint32_t triangle : std::exchange(own_sheet, {})) shrink(triangle, rounding);
  }
  return {centre, radius};
}

bool InscribedBalls::touches_opposite(const Ball& ball, const glm::dvec3& p_mm, double least_rad) const {
  const glm::dvec3 to_point = p_mm - ball.centre_mm, opposite = ball.centre_mm - to_point;
  const double reach = (1.0 + touching_share) * ball.radius_mm;
  // A point of the touched surface is within `reach` of the centre. If its direction is at least `least_rad`
  // from that of `p_mm`, it lies within this distance of the point opposite to `p_mm`.
  const double from_opposite = (2.0 * std::sin(0.5 * (std::acos(-1.0) - least_rad)) + touching_share) * reach;
  const double most_cosine = std::cos(least_rad);
  Pending pending(0);
  while (!pending.empty()) {
    const std::uint32_t number = pending.pop();
    const Node& node = nodes_[number];
    if (node.squared_distance(ball.centre_mm) > reach * reach ||
        node.squared_distance(opposite) > from_opposite * from_opposite)
      continue;
    if (node.second != 0) {
      std::uint32_t near = number + 1, far = node.second;
      if (nodes_[far].squared_distance(opposite) < nodes_[near].squared_distance(opposite))
        std::swap(near, far);
      pending.push(far);
      pending.push(near);
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const Corners& t = triangles_[i];
      const glm::dvec3 to_foot = nearest_of_triangle(ball.centre_mm, t.a_mm, t.b_mm, t.c_mm) - ball.centre_mm;
      const double distance = glm::length(to_foot);
      if (distance <= reach && glm::dot(to_foot, to_point) <= most_cosine * distance * glm::length(to_point))
        return true;
    }
  }
  return false;
}

LargestBall::LargestBall(std::vector<Ball> balls) : balls_(balls.size()) {
  const auto count = static_cast<std::uint32_t>(balls.size());
  if (count == 0) return;
  std::vector<Centred> items(count);
  for (std::uint32_t i = 0; i < count; ++i) items[i] = {balls[i].centre_mm, i};
  nodes_.resize(halving_nodes(count, leaf_size));
  const auto leaf = [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
    Node& node = nodes_[self];
    node.begin = begin;
    node.end = end;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Ball& ball = balls_[i] = balls[items[i].number];
      node.low_mm = i == begin ? ball.centre_mm : glm::min(node.low_mm, ball.centre_mm);
      node.high_mm = i == begin ? ball.centre_mm : glm::max(node.high_mm, ball.centre_mm);
      node.largest_mm = std::max(node.largest_mm, ball.radius_mm);
    }
  };
  const auto inner = [&](std::uint32_t self, std::uint32_t second) {
    const Node &one = nodes_[self + 1], &other = nodes_[second];
    nodes_[self] = {glm::min(one.low_mm, other.low_mm),
                    glm::max(one.high_mm, other.high_mm),
                    std::max(one.largest_mm, other.largest_mm),
                    0,
                    0,
                    second};
  };
  halve(items, leaf_size, leaf, inner, 0, 0, count);
}

Ball LargestBall::about(const glm::dvec3& p_mm, const Ball& known) const {
  Ball best = known;
  if (nodes_.empty()) return best;
  // The largest radius that a node can still contribute: its largest ball's radius if that ball could reach
  // the point, else 0.
  const auto offers = [&](std::uint32_t number) {
    const Node& node = nodes_[number];
    const double square = squared_distance_to_box(p_mm, node.low_mm, node.high_mm);
    return square <= node.largest_mm * node.largest_mm ? node.largest_mm : 0.0;
  };
  Pending pending(0);
  while (!pending.empty()) {
    const std::uint32_t number = pending.pop();
    const Node& node = nodes_[number];
    if (offers(number) <= best.radius_mm * no_larger) continue;
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        if (const double radius = balls_[i].radius_mm;
            radius > best.radius_mm && squared(balls_[i].centre_mm - p_mm) <= radius * radius)
          best = balls_[i];
      continue;
    }
    std::uint32_t better = number + 1, worse = node.second;
    if (offers(worse) > offers(better)) std::swap(better, worse);
    pending.push(worse);
    pending.push(better);
  }
  return best;
}

}  // namespace octotomy::brep
