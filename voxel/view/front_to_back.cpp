// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/front_to_back.h"

#include <bit>

#include "voxel/view/axis_walk.h"
#include "voxel/view/counted_walk.h"
#include "voxel/view/node_polygon.h"
#include "voxel/view/pixel_index.h"

// Front to back after Meagher 1982 and Amans 1986 (thesis 4.4.3.2, A.2). Departures: a covered quadtree node
// has one status for both cases of the thesis, a single colour (Full) or several (Masked); each level of the
// quadtree is a flat array, so that no node is created; for general views a quadtree node counts its
// uncovered pixels, so that it can be condensed without reading its children.

namespace octotomy::voxel {
namespace {

template <typename Node, typename Counter>
class AxisWalk {
 public:
  AxisWalk(const AxisFrame& frame, Counter& counter, ColumnDepths& columns)
      : frame_(frame), counter_(counter), columns_(columns) {
    for (int level = 0; level <= frame.depth(); ++level)
      covers_.emplace_back(std::size_t{1} << (2 * level), Status::Empty);
  }

  /// `is_virtual` means that the octree node is homogeneous and lies above the quadtree node's level, so that
  /// its visit was counted before.
  void walk(const Node& node, int level, int p, int q, int d, bool is_virtual) {
    const Status status = node.status();
    Status& cover = at(level, p, q);
    counter_.quadtree(1, 0);
    if (!is_virtual) counter_.direct(level, status, {p, q, d});
    if (status == Status::Empty || cover == Status::Full) return;
    if (status == Status::Full && cover == Status::Empty) {
      frame_.paint(columns_, p, q, level, d);
      cover = Status::Full;
      return;
    }
    cover = Status::Partial;
    const int half = frame_.side() >> (level + 1);
    bool covered = true;
    for (int i = 0; i < 4; ++i) {
      const int at_p = p + (i & 1) * half;
      const int at_q = q + (i >> 1) * half;
      const Status& child = at(level + 1, at_p, at_q);
      for (const bool behind : {false, true}) {
        if (status == Status::Partial)
          walk(node.child(frame_.child(i, behind)), level + 1, at_p, at_q, d + (behind ? half : 0), false);
        else
          walk(node, level + 1, at_p, at_q, d, true);
        if (child == Status::Full) break;
      }
      covered = covered && child == Status::Full;
    }
    if (covered) cover = Status::Full;
  }

 private:
  Status& at(int level, int p, int q) {
    const int shift = frame_.depth() - level;
    return covers_[static_cast<std::size_t>(level)]
                  [static_cast<std::size_t>(p >> shift) + (static_cast<std::size_t>(q >> shift) << level)];
  }

  const AxisFrame& frame_;
  Counter& counter_;
  ColumnDepths& columns_;
  std::vector<std::vector<Status>> covers_;  ///< by level
};

/// The quadtree of a picture. Its root is the smallest square of 2^levels pixels that covers the projection
/// of the universe (theorem 4.1). Its part outside the picture is covered from the start.
class Screen {
 public:
  Screen(const NodePolygons::Polygon& root, DepthImage& image)
      : image_(image), first_(glm::floor(root.centre_px - root.half_px)) {
    const glm::ivec2 extent = glm::ivec2(glm::ceil(root.centre_px + root.half_px)) - first_;
    levels_ = std::bit_width(static_cast<unsigned>(std::max(1, std::max(extent.x, extent.y) - 1)));
    for (int level = 0; level <= levels_; ++level) dark_.emplace_back(std::size_t{1} << (2 * level), 0);
    for (int y = 0; y < image.size_px.y; ++y)
      for (int x = 0; x < image.size_px.x; ++x) count({x, y}, 1);
  }

  int levels() const { return levels_; }
  int side_px(int level) const { return 1 << (levels_ - level); }
  /// The top left pixel of a quadtree node, in pixels of the picture.
  glm::ivec2 corner(int level, const glm::ivec2& node) const { return first_ + node * side_px(level); }
  /// The quadtree node on a level that contains a pixel position; positions are clamped to the root.
  glm::ivec2 node_at(int level, const glm::dvec2& p_px) const {
    const glm::dvec2 p = (p_px - glm::dvec2(first_)) / double(side_px(level));
    return glm::clamp(glm::ivec2(glm::floor(p)), 0, (1 << level) - 1);
  }
  bool covered(int level, const glm::ivec2& node) const { return dark(level, node) == 0; }
  void light(const glm::ivec2& pixel, const Seen& seen) {
    image_.pixels[pixel_index(image_.size_px, pixel.x, pixel.y)] = seen;
    count(pixel, -1);
  }

 private:
  std::int32_t dark(int level, const glm::ivec2& node) const {
    return dark_[static_cast<std::size_t>(level)][index(level, node)];
  }
  static std::size_t index(int level, const glm::ivec2& node) {
    return static_cast<std::size_t>(node.x) + (static_cast<std::size_t>(node.y) << level);
  }
  void count(const glm::ivec2& pixel, int by) {
    const glm::ivec2 p = pixel - first_;
    // Pixels outside the root show no part of the universe.
    if (p.x < 0 || p.y < 0 || ((p.x | p.y) >> levels_) != 0) return;
    for (int level = 0; level <= levels_; ++level)
      dark_[static_cast<std::size_t>(level)][index(level, p >> (levels_ - level))] += by;
  }

  DepthImage& image_;
  glm::ivec2 first_;
  int levels_ = 0;
  std::vector<std::vector<std::int32_t>> dark_;  ///< number of uncovered pixels of each node, by level
};

template <typename Node, typename Counter>
class PolygonWalk {
 public:
  PolygonWalk(const NodePolygons& polygons, Counter& counter, Screen& screen, std::int16_t object)
      : polygons_(polygons), counter_(counter), screen_(screen), object_(object) {}

  /// Visits a node that may be visible.
  void walk(const Node& node, int level, const glm::ivec3& origin) {
    const Status status = node.status();
    counter_.direct(level, status, origin);
    if (status == Status::Empty) return;
    const int edge = 1 << node.side_log2();
    if (status == Status::Full) {
      const NodePolygons::Polygon polygon = polygons_.of(origin, edge);
      for_each_covering(polygon, level,
                        [&](int at, const glm::ivec2& square) { paint(polygon, at, square); });
      return;
    }
    for (int i = 0; i < 8; ++i) {
      const int number = i ^ polygons_.front_child();
      const glm::ivec3 corner = origin + glm::ivec3(number & 1, (number >> 1) & 1, number >> 2) * (edge / 2);
      bool open = false;
      for_each_covering(polygons_.of(corner, edge / 2), level + 1, [&](int at, const glm::ivec2& square) {
        counter_.quadtree(1, 0);
        open = open || !screen_.covered(at, square);
      });
      if (open) walk(node.child(number), level + 1, corner);
    }
  }

 private:
  /// The quadtree nodes on the octree node's level, at most four, that the polygon's rectangle touches.
  template <typename Visit>
  void for_each_covering(const NodePolygons::Polygon& polygon, int octree_level, const Visit& visit) const {
    const int level = std::min(octree_level, screen_.levels());
    const glm::ivec2 first = screen_.node_at(level, polygon.centre_px - polygon.half_px);
    const glm::ivec2 last = screen_.node_at(level, polygon.centre_px + polygon.half_px);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) visit(level, glm::ivec2(x, y));
  }

  /// The thesis's paint_oct_into_quad.
  void paint(const NodePolygons::Polygon& polygon, int level, const glm::ivec2& square) {
    if (screen_.covered(level, square)) return;
    const glm::ivec2 corner = screen_.corner(level, square);
    if (level == screen_.levels()) {
      const glm::dvec2 centre = glm::dvec2(corner) + 0.5;
      if (polygons_.holds(polygon, centre))
        screen_.light(corner, {static_cast<float>(polygons_.depth_mm(polygon, centre)), object_, true});
      return;
    }
    if (polygons_.place(polygon, corner, screen_.side_px(level)) == NodePolygons::Containment::Outside)
      return;
    for (int i = 0; i < 4; ++i) paint(polygon, level + 1, 2 * square + glm::ivec2(i & 1, i >> 1));
  }

  const NodePolygons& polygons_;
  Counter& counter_;
  Screen& screen_;
  std::int16_t object_;
};

}  // namespace

ColumnMap front_to_back(const std::vector<DrawnObject>& objects, const AxisView& axes, Visits* visits) {
  return walk_columns(
      objects, axes, visits, [](const auto& frame, const auto& root, auto& counter, ColumnDepths& columns) {
        AxisWalk<std::decay_t<decltype(root)>, std::decay_t<decltype(counter)>>(frame, counter, columns)
            .walk(root, 0, 0, 0, 0, false);
      });
}

DepthImage front_to_back(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Visits* visits) {
  const Universe& universe = objects.front().octree.universe();
  const NodePolygons polygons(universe, plane);
  DepthImage image = unlit(plane.size_px);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    DepthImage own = unlit(plane.size_px);
    Screen screen(polygons.of(glm::ivec3(0), universe.side()), own);
    walk_object(objects[i], image.pixels.size(), visits, [&](const auto& root, auto& counter) {
      PolygonWalk<std::decay_t<decltype(root)>, std::decay_t<decltype(counter)>>(polygons, counter, screen,
                                                                                 static_cast<std::int16_t>(i))
          .walk(root, 0, glm::ivec3(0));
    });
    take_nearer(own, image);
  }
  return image;
}

}  // namespace octotomy::voxel
