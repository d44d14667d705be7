// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/counted_trace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>
#include <utility>

#include "voxel/measure/grey_level_counts.h"
#include "voxel/view/axis_walk.h"
#include "voxel/view/counted_walk.h"
#include "voxel/view/node_polygon.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

/// The thesis's ancestor array: the nodes on the path from the root down, one for each level.
template <typename Node>
struct Ancestors {
  explicit Ancestors(const Node& root) { nodes.fill(root); }
  Node& operator[](int level) { return nodes[static_cast<std::size_t>(level)]; }

  std::array<Node, Universe::max_depth + 1> nodes;
};

/// Ignores that a quadtree node is painted.
struct NoReads {
  void painted(int, int, int, int) {}
};

/// `reads.painted()` is called for each quadtree node that is painted, with its level, corner and depth.
template <typename Node, typename Counter, typename Reads = NoReads>
class NodeTracer {
 public:
  NodeTracer(const AxisFrame& frame, Counter& counter, ColumnDepths& columns, Reads reads = {})
      : frame_(frame), counter_(counter), columns_(columns), reads_(std::move(reads)) {}

  /// Traces a quadtree node's ray from the octree node on the path at the recursion level.
  void trace(Ancestors<Node> path, int recursion, int p, int q, int d) {
    int level = recursion;
    for (;;) {
      const Status status = path[level].status();
      if (status == Status::Full) {
        frame_.paint(columns_, p, q, recursion, d);
        reads_.painted(recursion, p, q, d);
        return;
      }
      if (status == Status::Partial) {
        split(path, recursion, p, q, d);
        return;
      }
      // Steps from the front face of the Empty node to the node behind this node.
      const int next = d + (frame_.side() >> level);
      if (next >= frame_.side()) return;
      const int pivot = frame_.depth() - std::bit_width(static_cast<unsigned>(d ^ next));
      d = next;
      level = descend(path, pivot, recursion, p, q, d);
    }
  }

 private:
  /// Starts four rays at the front children of the Partial node on the path.
  void split(Ancestors<Node>& path, int recursion, int p, int q, int d) {
    const int half = frame_.side() >> (recursion + 1);
    for (int i = 0; i < 4; ++i) {
      const int at_p = p + (i & 1) * half;
      const int at_q = q + (i >> 1) * half;
      path[recursion + 1] = path[recursion].child(frame_.child(i, false));
      counter_.direct(recursion + 1, path[recursion + 1].status(), {at_p, at_q, d});
      counter_.quadtree(1, 0);
      trace(path, recursion + 1, at_p, at_q, d);
    }
  }

  /// Find_Node_and_Level: walks from the pivot down to a homogeneous node or to the recursion level.
  int descend(Ancestors<Node>& path, int pivot, int recursion, int p, int q, int d) {
    int level = pivot;
    for (;;) {
      path[level + 1] = path[level].child(frame_.child_at(level, p, q, d));
      ++level;
      const Status status = path[level].status();
      const int mask = -(frame_.side() >> level);
      const glm::ivec3 corner(p & mask, q & mask, d & mask);
      if (level == recursion || status != Status::Partial) {
        counter_.direct(level, status, corner);
        counter_.quadtree(1, static_cast<std::uint64_t>(recursion - pivot - 1));
        return level;
      }
      counter_.indirect(level, status, corner);
    }
  }

  const AxisFrame& frame_;
  Counter& counter_;
  ColumnDepths& columns_;
  Reads reads_;
};

/// Counts the additional visits of interpolated depths (thesis 5.2.2.2, figure 5.7). If the ray of a quadtree
/// node ends at a Full node, the samples at the front of this node and those of the node before it are
/// needed. Both nodes are on the ray's path and cost no visit. A node with different samples is opened, and
/// the quadtree node is split too.
class DepthReads {
 public:
  DepthReads(const GreyOctree& grey, Window16 window, const AxisFrame& frame, VisitCounter& counter)
      : grey_(&grey),
        root_{GreyNode::root(grey, window), glm::ivec3(0)},
        frame_(&frame),
        counter_(&counter) {}

  void painted(int level, int p, int q, int d) {
    if (d == 0) return;  // the universe has no voxel in front of the surface
    split(level, p, q, d, find(level, p, q, d - 1), find(level, p, q, d));
  }

 private:
  struct Place {
    GreyNode node;
    glm::ivec3 origin;
  };

  bool is_even(const Place& place) const {
    const MinMax range = range_of_node(*grey_, place.origin, place.node.side_log2());
    return range.low == range.high;
  }
  glm::ivec3 corner(int level, int p, int q, int d) const {
    return glm::ivec3(p, q, d) & -(frame_->side() >> level);
  }
  Place child(const Place& outer, int level, int p, int q, int d) const {
    const int number = frame_->child_at(level, p, q, d);
    const glm::ivec3 octant(number & 1, (number >> 1) & 1, number >> 2);
    return {outer.node.child(number), outer.origin + (octant << (outer.node.side_log2() - 1))};
  }

  /// The node on the given level, or the larger node of equal samples that contains it. The ray's path ends
  /// at Full and Empty nodes; each node that is visited below such a node counts as an indirect visit.
  Place find(int level, int p, int q, int d) {
    Place place = root_;
    for (int at = 0; at < level && !is_even(place); ++at) {
      const bool is_below = place.node.status() != Status::Partial;
      place = child(place, at, p, q, d);
      if (is_below) counter_->indirect(at + 1, place.node.status(), corner(at + 1, p, q, d));
    }
    return place;
  }

  void split(int level, int p, int q, int d, const Place& before, const Place& surface) {
    const bool opens_before = !is_even(before), opens_surface = !is_even(surface);
    if (!opens_before && !opens_surface) return;
    const int half = frame_->side() >> (level + 1);
    for (int i = 0; i < 4; ++i) {
      const int at_p = p + (i & 1) * half;
      const int at_q = q + (i >> 1) * half;
      counter_->quadtree(1, 0);
      split(level + 1, at_p, at_q, d, opens_before ? open(before, level, at_p, at_q, d - 1) : before,
            opens_surface ? open(surface, level, at_p, at_q, d) : surface);
    }
  }
  Place open(const Place& outer, int level, int p, int q, int d) {
    const Place inner = child(outer, level, p, q, d);
    counter_->direct(level + 1, inner.node.status(), corner(level + 1, p, q, d));
    return inner;
  }

  const GreyOctree* grey_;
  Place root_;
  const AxisFrame* frame_;
  VisitCounter* counter_;
};

/// A node of a grey octree. Its samples can be used only if they are all equal.
class PlainGreyNode {
 public:
  PlainGreyNode() = default;
  PlainGreyNode(const GreyOctree& grey, Window16 window, const glm::ivec3& origin, int side_log2)
      : grey_(&grey), window_(window), origin_(origin), side_log2_(side_log2) {
    const MinMax range = range_of_node(grey, origin, side_log2);
    status_ = range.low == range.high ? window_status(range, window.low, window.high) : Status::Partial;
  }

  Status status() const { return status_; }
  int side_log2() const { return side_log2_; }
  PlainGreyNode child(int number) const {
    const glm::ivec3 octant(number & 1, (number >> 1) & 1, number >> 2);
    return {*grey_, window_, origin_ + (octant << (side_log2_ - 1)), side_log2_ - 1};
  }

 private:
  const GreyOctree* grey_ = nullptr;
  Window16 window_;
  glm::ivec3 origin_{0};
  int side_log2_ = 0;
  Status status_ = Status::Empty;
};

/// Node tracing in a general view: a quadtree node's ray is a beam with a square section. Octree nodes do not
/// project onto quadtree nodes. A beam therefore has a list of the nodes that it meets, front to back,
/// instead of stepping from neighbour to neighbour.
template <typename Node, typename Counter>
class BeamTracer {
 public:
  BeamTracer(const NodePolygons& polygons, Counter& counter, std::int16_t object, DepthImage& image)
      : polygons_(polygons), counter_(counter), object_(object), image_(image) {}

  /// Traces a square of side_px pixels, a power of two.
  void trace(const Node& root, const glm::ivec2& corner_px, int side_px) {
    std::vector<Met> met;
    met.push_back({root, 0, glm::ivec3(0), polygons_.of(glm::ivec3(0), 1 << root.side_log2())});
    split(met, corner_px, side_px);
  }

 private:
  /// A node that a beam meets.
  struct Met {
    Node node;
    int level = 0;
    glm::ivec3 origin{0};
    NodePolygons::Polygon polygon;
  };

  /// Traces a beam. `outer` contains all nodes that the beam meets, front to back.
  void split(const std::vector<Met>& outer, const glm::ivec2& corner_px, int side_px) {
    if (glm::any(glm::greaterThanEqual(corner_px, image_.size_px))) return;
    if (side_px == 1) {
      for (const Met& met : outer)
        if (ends_in(met, corner_px)) return;
      return;
    }
    std::vector<Met> inner;
    for (const Met& met : outer)
      if (collect(met, corner_px, side_px, inner)) break;
    if (inner.empty()) return;
    if (inner.front().node.status() == Status::Full && covers(inner.front(), corner_px, side_px)) {
      paint(inner.front().polygon, corner_px, side_px);
      return;
    }
    const int half = side_px / 2;
    for (int i = 0; i < 4; ++i) split(inner, corner_px + half * glm::ivec2(i & 1, i >> 1), half);
  }

  /// Adds those parts of a node that the beam meets to `inner`, and opens a Partial node larger than the
  /// beam. Returns whether a Full node covers the whole beam and so hides everything behind it.
  bool collect(const Met& met, const glm::ivec2& corner_px, int side_px, std::vector<Met>& inner) {
    const auto where = polygons_.place(met.polygon, corner_px, side_px);
    if (where == NodePolygons::Containment::Outside) return false;
    const bool is_full = met.node.status() == Status::Full;
    const double extent_px = 2.0 * std::max(met.polygon.half_px.x, met.polygon.half_px.y);
    if (is_full || extent_px <= side_px) {
      inner.push_back(met);
      return is_full && where == NodePolygons::Containment::Inside;
    }
    return open(met, [&](const Met& child) { return collect(child, corner_px, side_px, inner); });
  }

  bool covers(const Met& met, const glm::ivec2& corner_px, int side_px) const {
    return polygons_.place(met.polygon, corner_px, side_px) == NodePolygons::Containment::Inside;
  }

  /// Paints the pixel if the ray through its centre ends in the node.
  bool ends_in(const Met& met, const glm::ivec2& pixel) {
    if (!polygons_.holds(met.polygon, glm::dvec2(pixel) + 0.5)) return false;
    if (met.node.status() == Status::Full) {
      paint(met.polygon, pixel, 1);
      return true;
    }
    return open(met, [&](const Met& child) { return ends_in(child, pixel); });
  }

  /// Visits the children of a Partial node that are not Empty, front to back, until `visit` returns true.
  template <typename Visit>
  bool open(const Met& met, const Visit& visit) {
    const int half = 1 << (met.node.side_log2() - 1);
    for (int i = 0; i < 8; ++i) {
      const int number = i ^ polygons_.front_child();
      const glm::ivec3 origin = met.origin + glm::ivec3(number & 1, (number >> 1) & 1, number >> 2) * half;
      const Met child{met.node.child(number), met.level + 1, origin, polygons_.of(origin, half)};
      counter_.direct(child.level, child.node.status(), origin);
      counter_.quadtree(1, 0);
      if (child.node.status() != Status::Empty && visit(child)) return true;
    }
    return false;
  }

  void paint(const NodePolygons::Polygon& polygon, const glm::ivec2& corner_px, int side_px) {
    const glm::ivec2 end = glm::min(corner_px + side_px, image_.size_px);
    for (int y = corner_px.y; y < end.y; ++y)
      for (int x = corner_px.x; x < end.x; ++x)
        image_.pixels[pixel_index(image_.size_px, x, y)] = {
            static_cast<float>(polygons_.depth_mm(polygon, {x + 0.5, y + 0.5})), object_, true};
  }

  const NodePolygons& polygons_;
  Counter& counter_;
  std::int16_t object_;
  DepthImage& image_;
};

/// The rays of a general view through one octree.
template <typename Node>
class RayCounter {
 public:
  RayCounter(const Node& root, const VoxelRays& rays, VisitCounter& counter)
      : path_(root), depth_(root.side_log2()), side_(1 << depth_), per_mm_(rays.per_mm), counter_(counter) {}

  void cast(const glm::dvec3& start) {
    double from_mm = -std::numeric_limits<double>::infinity();
    double until_mm = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) clip(start[axis], per_mm_[axis], from_mm, until_mm);
    if (!(from_mm <= until_mm)) return;
    glm::ivec3 voxel = glm::clamp(glm::ivec3(glm::floor(start + from_mm * per_mm_ + 0.5)), 0, side_ - 1);
    counter_.direct(0, path_[0].status(), glm::ivec3(0));
    counter_.quadtree(1, 0);
    int pivot = 0;
    while (path_[0].status() == Status::Partial) {
      const int level = descend(pivot, voxel);
      if (path_[level].status() == Status::Full || !step(start, level, voxel, pivot)) return;
    }
  }

 private:
  void clip(double start, double speed, double& from_mm, double& until_mm) const {
    const double low = -0.5 - start;
    const double high = side_ - 0.5 - start;
    if (speed == 0.0) {
      if (!(low <= 0.0 && 0.0 < high)) until_mm = -std::numeric_limits<double>::infinity();
      return;
    }
    from_mm = std::max(from_mm, std::min(low / speed, high / speed));
    until_mm = std::min(until_mm, std::max(low / speed, high / speed));
  }

  int descend(int pivot, const glm::ivec3& voxel) {
    int level = pivot;
    for (;;) {
      const int bit = depth_ - 1 - level;
      const glm::ivec3 digit = (voxel >> bit) & 1;
      path_[level + 1] = path_[level].child(digit.x + 2 * digit.y + 4 * digit.z);
      ++level;
      const Status status = path_[level].status();
      const glm::ivec3 corner = (voxel >> bit) << bit;
      if (status != Status::Partial) {
        counter_.direct(level, status, corner);
        counter_.quadtree(1, static_cast<std::uint64_t>(level - pivot - 1));
        return level;
      }
      counter_.indirect(level, status, corner);
    }
  }

  /// Moves into the voxel behind an Empty node. Returns false if this voxel is outside the universe.
  bool step(const glm::dvec3& start, int level, glm::ivec3& voxel, int& pivot) const {
    const int edge = side_ >> level;
    const glm::ivec3 low = voxel & -edge;
    double leave_mm = std::numeric_limits<double>::infinity();
    int through = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (per_mm_[axis] == 0.0) continue;
      const double face = per_mm_[axis] > 0.0 ? low[axis] + edge - 0.5 : low[axis] - 0.5;
      const double time = (face - start[axis]) / per_mm_[axis];
      if (time < leave_mm) {
        leave_mm = time;
        through = axis;
      }
    }
    glm::ivec3 next =
        glm::clamp(glm::ivec3(glm::floor(start + leave_mm * per_mm_ + 0.5)), low, low + edge - 1);
    next[through] = per_mm_[through] > 0.0 ? low[through] + edge : low[through] - 1;
    if (next[through] < 0 || next[through] >= side_) return false;
    const auto changed = static_cast<unsigned>((next.x ^ voxel.x) | (next.y ^ voxel.y) | (next.z ^ voxel.z));
    pivot = depth_ - std::bit_width(changed);
    voxel = next;
    return true;
  }

  Ancestors<Node> path_;
  int depth_, side_;
  glm::dvec3 per_mm_;
  VisitCounter& counter_;
};

}  // namespace

ColumnMap quadtree_trace(const std::vector<DrawnObject>& objects, const AxisView& axes, Visits* visits) {
  return walk_columns(objects, axes, visits,
                      [](const auto& frame, const auto& root, auto& counter, ColumnDepths& columns) {
                        using Root = std::decay_t<decltype(root)>;
                        counter.direct(0, root.status(), glm::ivec3(0));
                        counter.quadtree(1, 0);
                        NodeTracer<Root, std::decay_t<decltype(counter)>>(frame, counter, columns)
                            .trace(Ancestors<Root>(root), 0, 0, 0, 0);
                      });
}

DepthImage quadtree_trace(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Visits* visits) {
  const NodePolygons polygons(objects.front().octree.universe(), plane);
  DepthImage image = unlit(plane.size_px);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    DepthImage own = unlit(plane.size_px);
    const auto number = static_cast<std::int16_t>(i);
    const auto side_px =
        static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(plane.size_px.x, plane.size_px.y))));
    walk_object(objects[i], pixel_count(plane.size_px), visits, [&](const auto& root, auto& counter) {
      using Root = std::decay_t<decltype(root)>;
      using Counter = std::decay_t<decltype(counter)>;
      if (root.status() == Status::Empty) return;
      // To count visits, the whole picture is traced as one beam from the root. Otherwise each tile is traced
      // as a separate beam.
      constexpr int tile_px = 64;
      const int beam_px = visits != nullptr ? side_px : std::min(side_px, tile_px);
      const glm::ivec2 beams = (plane.size_px + beam_px - 1) / beam_px;
      tbb::parallel_for(0, beams.x * beams.y, [&](int beam) {
        BeamTracer<Root, Counter>(polygons, counter, number, own)
            .trace(root, beam_px * glm::ivec2(beam % beams.x, beam / beams.x), beam_px);
      });
    });
    take_nearer(own, image);
  }
  return image;
}

Visits visits_without_ranges(const GreyOctree& grey, Window16 window, const AxisView& axes) {
  const AxisFrame frame(axes, grey.universe().depth);
  ColumnDepths columns(frame.column_count(), -1);
  VisitCounter counter(level_counts(grey), frame.column_count());
  const PlainGreyNode root(grey, window, glm::ivec3(0), grey.universe().depth);
  counter.direct(0, root.status(), glm::ivec3(0));
  counter.quadtree(1, 0);
  NodeTracer<PlainGreyNode, VisitCounter>(frame, counter, columns)
      .trace(Ancestors<PlainGreyNode>(root), 0, 0, 0, 0);
  return counter.visits();
}

Visits visits_with_depths(const GreyOctree& grey, Window16 window, const AxisView& axes) {
  const AxisFrame frame(axes, grey.universe().depth);
  ColumnDepths columns(frame.column_count(), -1);
  VisitCounter counter(level_counts(grey, window), frame.column_count());
  const GreyNode root = GreyNode::root(grey, window);
  counter.direct(0, root.status(), glm::ivec3(0));
  counter.quadtree(1, 0);
  NodeTracer<GreyNode, VisitCounter, DepthReads>(frame, counter, columns, {grey, window, frame, counter})
      .trace(Ancestors<GreyNode>(root), 0, 0, 0, 0);
  return counter.visits();
}

void count_rays(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Visits& visits) {
  const glm::ivec2 size = plane.size_px;
  const VoxelRays rays = voxel_rays(objects.front().octree.universe(), plane);
  const auto pixels = static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
  for (const DrawnObject& object : objects)
    walk_object(object, pixels, &visits, [&](const auto& root, auto& counter) {
      if constexpr (std::is_same_v<std::decay_t<decltype(counter)>, VisitCounter>) {
        RayCounter<std::decay_t<decltype(root)>> rays_of_object(root, rays, counter);
        for (int y = 0; y < size.y; ++y)
          for (int x = 0; x < size.x; ++x) rays_of_object.cast(rays.start({x + 0.5, y + 0.5}));
      }
    });
}

}  // namespace octotomy::voxel
