// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::voxel {

using Edge = std::array<glm::dvec2, 2>;

/// A tree of boxes over the edges of closed polygons in a plane, so that a query at a point does not visit
/// all edges. Results have the same bits as those computed over all edges. Building costs n log n and takes
/// about 50 bytes an edge. A query costs about log n on contours; edges whose boxes overlap at the point are
/// visited one by one.
class EdgeTree {
 public:
  /// The polygons' closing edges are implied; a polygon without points has no edges.
  explicit EdgeTree(const std::vector<std::vector<glm::dvec2>>& polygons_mm);

  /// The square of the point's distance from the nearest edge, by square_to_segment(); infinity without
  /// edges.
  double square_to(const glm::dvec2& p_mm) const;
  /// Whether the point is inside by the even-odd rule, with the same results as contains() in region_mask.h.
  bool contains(const glm::dvec2& p_mm) const;
  /// Edges that suffice to determine which points of a rectangle are inside, and where the region's border
  /// meets the rectangle. These are the polygons' edges near the rectangle, and upright edges at larger x,
  /// each of which replaces a whole run of edges. A ray from the rectangle towards growing x crosses the
  /// polygons and these edges equally often, modulo two.
  std::vector<Edge> edges_about(const glm::dvec2& low_mm, const glm::dvec2& high_mm) const;

  /// The largest absolute coordinate; 0 without edges.
  double farthest_mm() const;

  /// Calls visit(from, to, number), in no particular order, for all edges that meet a rectangle and for some
  /// others near it. Numbers ascend in the polygons' order, each polygon's closing edge first; a polygon of n
  /// points uses n + 1 numbers.
  template <typename Visit>
  void visit(const glm::dvec2& low_mm, const glm::dvec2& high_mm, const Visit& visit_edge) const {
    if (!nodes_.empty()) visit_node(0, low_mm, high_mm, visit_edge);
  }

 private:
  static constexpr std::uint32_t leaf_size = 4;

  /// A run of edges, from point `from` to point `to`; or whole polygons, with `from` equal to `to`. An inner
  /// node's children are the next node and `second`.
  struct Node {
    glm::dvec2 low, high;
    std::uint32_t from = 0, to = 0, second = 0;

    bool is_leaf() const { return second == 0; }
    bool meets(const glm::dvec2& low_mm, const glm::dvec2& high_mm) const {
      return low.x <= high_mm.x && low_mm.x <= high.x && low.y <= high_mm.y && low_mm.y <= high.y;
    }
    double square_to(const glm::dvec2& p_mm) const {
      const glm::dvec2 to_box = glm::max(glm::max(low - p_mm, p_mm - high), glm::dvec2(0.0));
      return glm::dot(to_box, to_box);
    }
  };
  struct Polygon {
    std::uint32_t from, to;
    glm::dvec2 middle;
  };
  void append(Polygon* begin, Polygon* end);
  void append_run(std::uint32_t from, std::uint32_t to);
  void join_children(std::size_t number, std::size_t second);

  void nearest(std::uint32_t number, const glm::dvec2& p_mm, double& least) const;
  bool crossed_oddly(std::uint32_t number, const glm::dvec2& p_mm) const;
  void collect_about(std::uint32_t number, const glm::dvec2& low_mm, const glm::dvec2& high_mm,
                     std::vector<Edge>& edges) const;

  template <typename Visit>
  void visit_node(std::uint32_t number, const glm::dvec2& low_mm, const glm::dvec2& high_mm,
                  const Visit& visit_edge) const {
    const Node& node = nodes_[number];
    if (!node.meets(low_mm, high_mm)) return;
    if (node.is_leaf()) {
      for (std::uint32_t i = node.from; i < node.to; ++i) visit_edge(points_[i], points_[i + 1], i);
      return;
    }
    visit_node(number + 1, low_mm, high_mm, visit_edge);
    visit_node(node.second, low_mm, high_mm, visit_edge);
  }

  /// Points of all polygons, one polygon after the other; each polygon's last point is also stored before its
  /// first.
  std::vector<glm::dvec2> points_;
  std::vector<Node> nodes_;  ///< a parent before its children
};

}  // namespace octotomy::voxel
