// Steps: 1 build boxes over runs of each polygon's edges, halved along the polygon; 2 build boxes over whole
// polygons, halved across the longer side of the box around the polygons' middles. Queries examine only the
// boxes near the point. A run of edges that lies wholly beyond the ray's start is crossed an odd number of
// times if its ends lie on different sides of the ray. A whole polygon there is crossed an even number of
// times. Boxes include the rounding of points computed on the edges, so skipping a box cannot change a
// result.
#include "voxel/solid/edge_tree.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "voxel/solid/polygon.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::voxel {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Box {
  glm::dvec2 low{infinity}, high{-infinity};
  void add(const glm::dvec2& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

/// Extends the box by the points that square_to_segment() and crosses_ray_from() compute on an edge, with
/// their rounding. Both compute a + t * (b - a) for t from 0 to 1, and rounding keeps this monotone in t, so
/// the two ends bound all points between.
void add_edge(const glm::dvec2& a, const glm::dvec2& b, Box& box) {
  const glm::dvec2 along = b - a;
  box.add(a);
  box.add(b);
  box.add(a + along);
  if (a.y != b.y) box.add({along.x * along.y / along.y + a.x, b.y});
}

}  // namespace

EdgeTree::EdgeTree(const std::vector<std::vector<glm::dvec2>>& polygons_mm) {
  std::vector<Polygon> polygons;
  for (const std::vector<glm::dvec2>& polygon : polygons_mm) {
    if (polygon.empty()) continue;
    Box box;
    for (const glm::dvec2& p : polygon) box.add(p);
    const auto from = static_cast<std::uint32_t>(points_.size());
    points_.push_back(polygon.back());
    points_.insert(points_.end(), polygon.begin(), polygon.end());
    polygons.push_back(
        {from, static_cast<std::uint32_t>(points_.size() - 1), 0.5 * box.low + 0.5 * box.high});
  }
  if (!polygons.empty()) append(polygons.data(), polygons.data() + polygons.size());
}

void EdgeTree::append(Polygon* begin, Polygon* end) {
  assert(begin < end);
  if (end - begin == 1) return append_run(begin->from, begin->to);
  Box middles;
  for (const Polygon* polygon = begin; polygon < end; ++polygon) middles.add(polygon->middle);
  const glm::dvec2 size = middles.high - middles.low;
  const int axis = size.x >= size.y ? 0 : 1;
  Polygon* middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end,
                   [&](const Polygon& a, const Polygon& b) { return a.middle[axis] < b.middle[axis]; });
  const std::size_t number = nodes_.size();
  nodes_.emplace_back();
  append(begin, middle);
  const std::size_t second = nodes_.size();
  append(middle, end);
  join_children(number, second);
}

void EdgeTree::append_run(std::uint32_t from, std::uint32_t to) {
  assert(from < to);
  const std::size_t number = nodes_.size();
  nodes_.emplace_back();
  if (to - from <= leaf_size) {
    Box box;
    for (std::uint32_t i = from; i < to; ++i) add_edge(points_[i], points_[i + 1], box);
    nodes_[number] = {box.low, box.high, from, to, 0};
    return;
  }
  const std::uint32_t middle = from + (to - from) / 2;
  append_run(from, middle);
  const std::size_t second = nodes_.size();
  append_run(middle, to);
  join_children(number, second);
  nodes_[number].from = from;
  nodes_[number].to = to;
}

void EdgeTree::join_children(std::size_t number, std::size_t second) {
  const Node &a = nodes_[number + 1], &b = nodes_[second];
  nodes_[number] = {glm::min(a.low, b.low), glm::max(a.high, b.high), 0, 0,
                    static_cast<std::uint32_t>(second)};
}

double EdgeTree::farthest_mm() const {
  if (nodes_.empty()) return 0.0;
  const glm::dvec2 farthest = glm::max(glm::abs(nodes_[0].low), glm::abs(nodes_[0].high));
  return std::max(farthest.x, farthest.y);
}

double EdgeTree::square_to(const glm::dvec2& p_mm) const {
  double least = infinity;
  if (!nodes_.empty()) nearest(0, p_mm, least);
  return least;
}

void EdgeTree::nearest(std::uint32_t number, const glm::dvec2& p_mm, double& least) const {
  const Node& node = nodes_[number];
  if (node.is_leaf()) {
    for (std::uint32_t i = node.from; i < node.to; ++i)
      least = std::min(least, square_to_segment(p_mm, points_[i], points_[i + 1]));
    return;
  }
  std::uint32_t near = number + 1, far = node.second;
  double to_near = nodes_[near].square_to(p_mm), to_far = nodes_[far].square_to(p_mm);
  if (to_far < to_near) {
    std::swap(near, far);
    std::swap(to_near, to_far);
  }
  if (to_near < least) nearest(near, p_mm, least);
  if (to_far < least) nearest(far, p_mm, least);
}

bool EdgeTree::contains(const glm::dvec2& p_mm) const {
  return !nodes_.empty() && crossed_oddly(0, p_mm);
}

bool EdgeTree::crossed_oddly(std::uint32_t number, const glm::dvec2& p_mm) const {
  const Node& node = nodes_[number];
  if (p_mm.y < node.low.y || p_mm.y >= node.high.y || p_mm.x >= node.high.x) return false;
  if (p_mm.x < node.low.x) return (points_[node.from].y > p_mm.y) != (points_[node.to].y > p_mm.y);
  if (!node.is_leaf()) return crossed_oddly(number + 1, p_mm) != crossed_oddly(node.second, p_mm);
  bool odd = false;
  for (std::uint32_t i = node.from; i < node.to; ++i)
    odd ^= crosses_ray_from(points_[i], points_[i + 1], p_mm);
  return odd;
}

std::vector<Edge> EdgeTree::edges_about(const glm::dvec2& low_mm, const glm::dvec2& high_mm) const {
  std::vector<Edge> edges;
  if (!nodes_.empty()) collect_about(0, low_mm, high_mm, edges);
  return edges;
}

void EdgeTree::collect_about(std::uint32_t number, const glm::dvec2& low_mm, const glm::dvec2& high_mm,
                             std::vector<Edge>& edges) const {
  const Node& node = nodes_[number];
  if (node.high.x < low_mm.x || node.high.y < low_mm.y || node.low.y > high_mm.y) return;
  if (node.low.x > high_mm.x) {
    const double from = points_[node.from].y, to = points_[node.to].y;
    if (from != to) edges.push_back({glm::dvec2(node.low.x, from), glm::dvec2(node.low.x, to)});
  } else if (node.is_leaf()) {
    for (std::uint32_t i = node.from; i < node.to; ++i) edges.push_back({points_[i], points_[i + 1]});
  } else {
    collect_about(number + 1, low_mm, high_mm, edges);
    collect_about(node.second, low_mm, high_mm, edges);
  }
}

}  // namespace octotomy::voxel
