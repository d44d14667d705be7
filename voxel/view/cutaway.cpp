// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/cutaway.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>

#include "voxel/view/depth_plane.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

/// A line of sight: its point at depth 0, and its step per millimetre of depth, LPS.
struct Sight {
  glm::dvec3 start_mm{0.0};
  glm::dvec3 along{0.0, 1.0, 0.0};
};

constexpr double endless_mm = std::numeric_limits<double>::infinity();

std::optional<TakenSpan> taken_of(const Sight& sight, const HalfSpace& kept) {
  const double beyond_mm = glm::dot(kept.normal, sight.start_mm) - kept.offset_mm;
  const double along = glm::dot(kept.normal, sight.along);
  if (along < 0.0) return TakenSpan{-endless_mm, -beyond_mm / along, kept.normal};
  if (along > 0.0) return TakenSpan{-beyond_mm / along, endless_mm, kept.normal};
  if (beyond_mm <= 0.0) return std::nullopt;
  return TakenSpan{-endless_mm, endless_mm, kept.normal};
}

std::optional<TakenSpan> taken_of(const Sight& sight, const Box& box) {
  TakenSpan span{-endless_mm, endless_mm, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const double along = sight.along[axis];
    const double low = box.low_mm[axis] - sight.start_mm[axis];
    const double high = box.high_mm[axis] - sight.start_mm[axis];
    if (along == 0.0) {
      if (low > 0.0 || high < 0.0) return std::nullopt;
      continue;
    }
    span.from_mm = std::max(span.from_mm, std::min(low / along, high / along));
    const double until_mm = std::max(low / along, high / along);
    if (until_mm >= span.until_mm) continue;
    span.until_mm = until_mm;
    span.normal = glm::dvec3(0.0);
    span.normal[axis] = along > 0.0 ? -1.0 : 1.0;
  }
  if (span.from_mm > span.until_mm) return std::nullopt;
  return span;
}

/// An upper bound of the distance, along a cut's normal, between the cut and a face that separates a kept
/// voxel from a removed one. The two centres lie on different sides of the cut, and no point of a voxel is
/// farther from its centre than this.
double half_voxel_mm(const glm::dmat3& lps_from_voxel, const glm::dvec3& normal) {
  return 0.5 *
         (std::abs(glm::dot(lps_from_voxel[0], normal)) + std::abs(glm::dot(lps_from_voxel[1], normal)) +
          std::abs(glm::dot(lps_from_voxel[2], normal)));
}

/// The cut whose face a pixel shows; if there are several, the nearest in depth.
std::optional<TakenSpan> face_at(const Sight& sight, double depth_mm, const glm::dmat3& lps_from_voxel,
                                 const std::vector<Cutaway>& cuts) {
  // A margin in mm for the rounding of depths, which are floats of a few hundred millimetres.
  constexpr double rounding = 1.0 + 1e-3;
  std::optional<TakenSpan> nearest;
  for (const Cutaway& cut : cuts) {
    const std::optional<TakenSpan> found = taken_span(cut, sight.start_mm, sight.along);
    if (!found || !std::isfinite(found->until_mm)) continue;
    const double facing = -glm::dot(found->normal, sight.along);
    const double off_mm = std::abs(found->until_mm - depth_mm);
    if (facing < 1.0 / break_mm(1.0) ||
        off_mm * facing > rounding * half_voxel_mm(lps_from_voxel, found->normal))
      continue;
    if (!nearest || off_mm < std::abs(nearest->until_mm - depth_mm)) nearest = found;
  }
  return nearest;
}

}  // namespace

std::optional<TakenSpan> taken_span(const Cutaway& cut, const glm::dvec3& start_mm, const glm::dvec3& along) {
  return std::visit([&](const auto& taken) { return taken_of({start_mm, along}, taken); }, cut);
}

Expression without(const Expression& object, const std::vector<Cutaway>& cuts) {
  Expression left = object;
  for (const Cutaway& cut : cuts) {
    if (const auto* kept = std::get_if<HalfSpace>(&cut)) left = left & Expression(*kept);
    if (const auto* box = std::get_if<Box>(&cut)) left = left - Expression(*box);
  }
  return left;
}

std::vector<DrawnObject> without(const std::vector<DrawnObject>& objects, const std::vector<Cutaway>& cuts) {
  std::vector<DrawnObject> left = objects;
  if (cuts.empty()) return left;
  for (DrawnObject& object : left) {
    object.unbuilt = without(object.unbuilt ? *object.unbuilt : Expression(object.octree), cuts);
    object.octree = Octree::empty(object.octree.universe());
    object.counted_in_grey = false;
    object.inside.reset();
  }
  return left;
}

std::vector<glm::vec3> flatten_cuts(DepthImage& image, const ImagePlane& plane, const Universe& universe,
                                    const std::vector<Cutaway>& cuts) {
  if (cuts.empty()) return {};
  std::vector<glm::vec3> normals(image.pixels.size(), glm::vec3(0.0f));
  const glm::dmat3 lps_from_voxel(universe.lps_from_voxel);
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      const std::size_t pixel = pixel_index(image.size_px, x, y);
      Seen& seen = image.pixels[pixel];
      if (!seen.lit() || !seen.stepped) continue;
      const glm::dvec2 p_px(x + 0.5, y + 0.5);
      Sight sight{plane.lps_mm(p_px, 0.0), {}};
      sight.along = plane.lps_mm(p_px, 1.0) - sight.start_mm;
      const std::optional<TakenSpan> face = face_at(sight, seen.depth_mm, lps_from_voxel, cuts);
      if (!face) continue;
      seen.depth_mm = static_cast<float>(face->until_mm);
      seen.stepped = false;
      normals[pixel] =
          glm::vec3(glm::dot(face->normal, plane.view.right), glm::dot(face->normal, plane.view.up),
                    glm::dot(face->normal, plane.view.look));
    }
  });
  return normals;
}

}  // namespace octotomy::voxel
