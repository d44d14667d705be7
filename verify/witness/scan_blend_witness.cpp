// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The scan decides a point if its nearest point on the scan, the point itself and its distance are within every limit
// by more than the border's width. The object decides it if it is beyond one of the limits. Each limit has a slack:
// the largest deviation of a right answer. The scan's side of a point follows from the solid angle under which the
// point sees the scan. As a share of the full angle it is at least a half inside a scan of crowns, and at most zero
// outside, above the scan's border. In between, as inside a flat scan, the normals of the triangle's corners decide,
// interpolated at the nearest point. Where that normal is nearly perpendicular to the line to the point, both sides
// are allowed.
#include "verify/witness/scan_blend_witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "verify/witness/reshaped_witness.h"
#include "verify/witness/triangle_grid.h"

namespace octotomy::verify {
namespace {

/// Computes the share of the full solid angle under which a point sees a surface; positive from behind. For
/// triangles in cubes far from the point, the vector sum of their areas is used.
class SeenShare {
 public:
  explicit SeenShare(const brep::Triangles& surface) {
    constexpr double cube_mm = 4.0;
    std::map<std::array<long, 3>, std::vector<std::array<glm::dvec3, 3>>> cubes;
    for (const auto& face : surface.faces) {
      const std::array<glm::dvec3, 3> corners{surface.points_mm[face[0]], surface.points_mm[face[1]],
                                              surface.points_mm[face[2]]};
      const glm::dvec3 cube = glm::floor((corners[0] + corners[1] + corners[2]) / (3.0 * cube_mm));
      cubes[{std::lround(cube.x), std::lround(cube.y), std::lround(cube.z)}].push_back(corners);
    }
    for (auto& [place, triangles] : cubes) clusters_.push_back(cluster_of(std::move(triangles)));
  }

  double at(const glm::dvec3& p_mm) const {
    constexpr double far_radii = 3.0;
    double angle = 0.0;
    for (const Cluster& cluster : clusters_) {
      const glm::dvec3 to = cluster.middle_mm - p_mm;
      const double distance = glm::length(to);
      if (distance > far_radii * cluster.radius_mm) {
        angle += glm::dot(cluster.area_mm2, to) / (distance * distance * distance);
        continue;
      }
      for (const auto& [a, b, c] : cluster.triangles) angle += solid_angle(a - p_mm, b - p_mm, c - p_mm);
    }
    return angle / (4.0 * std::numbers::pi);
  }

 private:
  struct Cluster {
    std::vector<std::array<glm::dvec3, 3>> triangles;
    glm::dvec3 middle_mm{0.0}, area_mm2{0.0};
    double radius_mm = 0.0;
  };

  static Cluster cluster_of(std::vector<std::array<glm::dvec3, 3>> triangles) {
    Cluster cluster;
    double whole_mm2 = 0.0;
    for (const auto& [a, b, c] : triangles) {
      const glm::dvec3 area = 0.5 * glm::cross(b - a, c - a);
      cluster.area_mm2 += area;
      whole_mm2 += glm::length(area);
      cluster.middle_mm += glm::length(area) * (a + b + c) / 3.0;
    }
    if (whole_mm2 > 0.0) cluster.middle_mm /= whole_mm2;
    for (const auto& corners : triangles)
      for (const glm::dvec3& corner : corners)
        cluster.radius_mm = std::max(cluster.radius_mm, glm::distance(corner, cluster.middle_mm));
    cluster.triangles = std::move(triangles);
    return cluster;
  }

  /// The solid angle under which the origin sees a triangle, from the tangent of half that angle (Euler,
  /// 1781).
  static double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }

  std::vector<Cluster> clusters_;
};

class ScanBlendReader {
 public:
  ScanBlendReader(Witness object, WitnessedScan asked)
      : object_(std::move(object)), asked_(std::move(asked)), grid_(asked_.scan), seen_(asked_.scan) {
    find_normals();
    find_border();
  }

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds) const {
    const double slack = asked_.apart_mm + slack_mm + rounded_mm(p_mm),
                 far_mm = asked_.reach_mm + asked_.blend_mm;
    const double within = limit_mm(p_mm);
    std::optional<TriangleGrid::Foot> foot;
    if (within > -slack) foot = grid_.nearest(p_mm, far_mm + slack);
    if (!foot) return of_object(p_mm, slack);
    const glm::dvec3 foot_mm = at(*foot, asked_.scan.points_mm);
    const double least = std::min({within, far_mm - foot->distance_mm, border_distance_mm(foot_mm)});
    if (least <= -slack || (is_on_border(*foot) && foot->distance_mm > 2.0 * slack))
      return of_object(p_mm, slack);
    const AllowedSides of_scan = scan_sides(p_mm, *foot, foot_mm, slack);
    if (least > asked_.blend_mm + slack) return {of_scan, of_scan, of_scan.near ? 2 : 0};
    const Reading object = of_object(p_mm, slack);
    if (object.mesh == of_scan) return object;
    // The blended distance lies between those of the scan and of the object. So no surface is near where both
    // have the same side.
    return {on_surface, on_surface, 2};
  }

 private:
  static glm::dvec3 through(const std::array<std::uint32_t, 3>& face, const glm::dvec3& weights,
                            const std::vector<glm::dvec3>& values) {
    return weights.x * values[face[0]] + weights.y * values[face[1]] + weights.z * values[face[2]];
  }
  glm::dvec3 at(const TriangleGrid::Foot& foot, const std::vector<glm::dvec3>& values) const {
    return through(asked_.scan.faces[foot.face], foot.weights, values);
  }

  /// Computes the normals at the scan's points: sums, weighted by area, over all triangles that share a
  /// corner with a triangle at the point. So small triangles that noise reversed have little effect.
  void find_normals() {
    const std::vector<glm::dvec3>& points = asked_.scan.points_mm;
    std::vector<glm::dvec3> own(points.size(), glm::dvec3(0.0));
    const auto add = [&](std::vector<glm::dvec3>& to, const auto& value_of) {
      for (std::size_t i = 0; i < asked_.scan.faces.size(); ++i)
        for (const std::uint32_t corner : asked_.scan.faces[i]) to[corner] += value_of(asked_.scan.faces[i]);
    };
    add(own, [&](const auto& face) {
      return glm::cross(points[face[1]] - points[face[0]], points[face[2]] - points[face[0]]);
    });
    normals_.assign(points.size(), glm::dvec3(0.0));
    add(normals_, [&](const auto& face) { return own[face[0]] + own[face[1]] + own[face[2]]; });
  }

  /// Collects the edges that belong to one triangle only.
  void find_border() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
    for (const auto& face : asked_.scan.faces)
      for (std::size_t k = 0; k < 3; ++k) ++count[std::minmax(face[k], face[(k + 1) % 3])];
    is_border_.assign(asked_.scan.points_mm.size(), false);
    std::vector<BoxGrid::Box> boxes;
    for (const auto& [edge, triangles] : count) {
      if (triangles != 1) continue;
      is_border_[edge.first] = is_border_[edge.second] = true;
      const glm::dvec3 &a = asked_.scan.points_mm[edge.first], &b = asked_.scan.points_mm[edge.second];
      edges_.push_back({a, b});
      boxes.push_back({glm::min(a, b), glm::max(a, b)});
    }
    border_ = BoxGrid(boxes, asked_.blend_mm);
  }

  /// The distance of a point from the scan's border; at most twice `blend_mm`.
  double border_distance_mm(const glm::dvec3& p_mm) const {
    const double most = 2.0 * asked_.blend_mm;
    double least = most;
    if (border_.empty()) return least;
    const glm::ivec3 low = glm::max(border_.cell_of(p_mm - most), glm::ivec3(0)),
                     high = glm::min(border_.cell_of(p_mm + most), border_.dims() - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          border_.any_in({x, y, z}, [&](std::uint32_t i) {
            const auto& [a, b] = edges_[i];
            const glm::dvec3 along = b - a;
            const double squared = glm::dot(along, along);
            const double share =
                squared > 0.0 ? std::clamp(glm::dot(p_mm - a, along) / squared, 0.0, 1.0) : 0.0;
            least = std::min(least, glm::distance(p_mm, a + share * along));
            return false;
          });
    return least;
  }

  bool is_on_border(const TriangleGrid::Foot& foot) const {
    const auto& face = asked_.scan.faces[foot.face];
    for (std::size_t k = 0; k < 3; ++k)
      if (foot.weights[static_cast<int>(k)] > 1e-9 && !is_border_[face[k]]) return false;
    return border_distance_mm(at(foot, asked_.scan.points_mm)) < 1e-6;
  }

  double limit_mm(const glm::dvec3& p_mm) const {
    const double within = asked_.depth_mm + asked_.tips_mm - glm::dot(p_mm, asked_.to_roots);
    if (asked_.about_mm.empty()) return within;
    double nearest = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& q : asked_.about_mm) nearest = std::min(nearest, glm::distance(p_mm, q));
    return std::min(within, asked_.radius_mm - nearest);
  }

  Reading of_object(const glm::dvec3& p_mm, double slack) const {
    Reading reading = object_(p_mm, slack, ReadingNeeds::MeshOnly);
    reading.voxel = reading.mesh;
    if (reading.mesh.near) reading.surfaces = 2;
    return reading;
  }

  AllowedSides scan_sides(const glm::dvec3& p_mm, const TriangleGrid::Foot& foot, const glm::dvec3& foot_mm,
                          double slack) const {
    constexpr double surely_inside = 2.0 / 3.0, surely_outside = 0.0;
    if (foot.distance_mm <= slack) return on_surface;
    const double seen = seen_.at(p_mm);
    if (seen > surely_inside) return certainly_in;
    if (seen < surely_outside) return certainly_out;
    const glm::dvec3 normal = at(foot, normals_);
    const double along = glm::dot(p_mm - foot_mm, normal), whole = foot.distance_mm * glm::length(normal);
    constexpr double nearly_square = 0.1;
    if (std::abs(along) <= nearly_square * whole) return either_side;
    return along < 0.0 ? certainly_in : certainly_out;
  }

  Witness object_;
  WitnessedScan asked_;
  TriangleGrid grid_;
  SeenShare seen_;
  std::vector<glm::dvec3> normals_;  ///< by point of the scan
  std::vector<bool> is_border_;
  std::vector<std::pair<glm::dvec3, glm::dvec3>> edges_;
  BoxGrid border_;
};

/// Copies of a witness share the scan.
struct SharedReader {
  std::shared_ptr<const ScanBlendReader> reader;

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds needs) const {
    return (*reader)(p_mm, slack_mm, needs);
  }
};

}  // namespace

Witness witness_of_scan_blend(Witness object, WitnessedScan asked) {
  if (!object) return {};
  std::vector<PartChoice> choices = object.choices();
  return Witness(SharedReader{std::make_shared<const ScanBlendReader>(std::move(object), std::move(asked))})
      .with_choices(std::move(choices));
}

bool is_scan_blend(const Witness& witness) {
  return witness.reader<SharedReader>() != nullptr;
}

}  // namespace octotomy::verify
