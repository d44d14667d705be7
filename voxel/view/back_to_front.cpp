// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/back_to_front.h"

#include "voxel/view/axis_walk.h"
#include "voxel/view/counted_walk.h"
#include "voxel/view/node_polygon.h"
#include "voxel/view/pixel_index.h"

// Back to front after Meagher 1982 (thesis 4.4.3.1). Depths need no comparison, because later nodes are
// nearer. Objects are painted one by one, and the nearest surface is chosen afterwards. The result equals
// that of painting all objects at every node.

namespace octotomy::voxel {
namespace {

template <typename Node, typename Counter>
class AxisPainter {
 public:
  AxisPainter(const AxisFrame& frame, Counter& counter, ColumnDepths& columns)
      : frame_(frame), counter_(counter), columns_(columns) {}

  void paint(const Node& node, int level, int p, int q, int d) {
    const Status status = node.status();
    counter_.direct(level, status, {p, q, d});
    counter_.quadtree(1, 0);
    if (status == Status::Full) frame_.paint(columns_, p, q, level, d);
    if (status != Status::Partial) return;
    const int half = frame_.side() >> (level + 1);
    for (int i = 0; i < 4; ++i)
      for (const bool behind : {true, false})
        paint(node.child(frame_.child(i, behind)), level + 1, p + (i & 1) * half, q + (i >> 1) * half,
              d + (behind ? half : 0));
  }

 private:
  const AxisFrame& frame_;
  Counter& counter_;
  ColumnDepths& columns_;
};

/// Paints one object in a general view.
template <typename Node, typename Counter>
class PolygonPainter {
 public:
  PolygonPainter(const NodePolygons& polygons, Counter& counter, DepthImage& image, std::int16_t object)
      : polygons_(polygons), counter_(counter), image_(image), object_(object) {}

  void paint(const Node& node, int level, const glm::ivec3& origin) {
    const Status status = node.status();
    const int edge = 1 << node.side_log2();
    counter_.direct(level, status, origin);
    counter_.quadtree(1, 0);
    if (status == Status::Full) display(polygons_.of(origin, edge));
    if (status != Status::Partial) return;
    const int back_first = polygons_.front_child() ^ 7;
    for (int i = 0; i < 8; ++i) {
      const int child = i ^ back_first;
      paint(node.child(child), level + 1,
            origin + glm::ivec3(child & 1, (child >> 1) & 1, child >> 2) * (edge / 2));
    }
  }

 private:
  /// Paints the pixels whose centres lie in the polygon.
  void display(const NodePolygons::Polygon& polygon) {
    const glm::ivec2 first = glm::max(glm::ivec2(glm::ceil(polygon.centre_px - polygon.half_px - 0.5)), 0);
    const glm::ivec2 last =
        glm::min(glm::ivec2(glm::floor(polygon.centre_px + polygon.half_px - 0.5)), image_.size_px - 1);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        const glm::dvec2 centre(x + 0.5, y + 0.5);
        if (!polygons_.holds(polygon, centre)) continue;
        Seen& seen = image_.pixels[pixel_index(image_.size_px, x, y)];
        const auto depth_mm = static_cast<float>(polygons_.depth_mm(polygon, centre));
        seen = {depth_mm, object_, true};
      }
  }

  const NodePolygons& polygons_;
  Counter& counter_;
  DepthImage& image_;
  std::int16_t object_;
};

}  // namespace

ColumnMap back_to_front(const std::vector<DrawnObject>& objects, const AxisView& axes, Visits* visits) {
  return walk_columns(
      objects, axes, visits, [](const auto& frame, const auto& root, auto& counter, ColumnDepths& columns) {
        AxisPainter<std::decay_t<decltype(root)>, std::decay_t<decltype(counter)>>(frame, counter, columns)
            .paint(root, 0, 0, 0, 0);
      });
}

DepthImage back_to_front(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Visits* visits) {
  const NodePolygons polygons(objects.front().octree.universe(), plane);
  DepthImage image = unlit(plane.size_px);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    // Within an object later nodes overwrite earlier ones, so each object needs a separate image.
    DepthImage own = unlit(plane.size_px);
    walk_object(objects[i], image.pixels.size(), visits, [&](const auto& root, auto& counter) {
      PolygonPainter<std::decay_t<decltype(root)>, std::decay_t<decltype(counter)>>(
          polygons, counter, own, static_cast<std::int16_t>(i))
          .paint(root, 0, glm::ivec3(0));
    });
    take_nearer(own, image);
  }
  return image;
}

}  // namespace octotomy::voxel
