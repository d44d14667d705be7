// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/ray_surface.h"

#include <cassert>
#include <cstdint>

namespace octotomy::voxel {
namespace {

// Vectors of (x, y, z, 0).
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

Float4 floats(const glm::dvec3& v) {
  return Float4{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 0.0f};
}
Int4 ints(const glm::ivec3& v) {
  return Int4{v.x, v.y, v.z, 0};
}
template <typename Vector>
Vector clamped(Vector v, Vector low, Vector high) {
  v = v < low ? low : v;
  return v > high ? high : v;
}

/// Computes trilinear samples along a ray near one of the ray's points. Caches the eight corners of the last
/// cell. Single precision suffices: a 16-bit sample is rounded by less than a thousandth of its unit, and a
/// position, counted from a nearby voxel, by less than a millionth of a voxel.
class RaySamples {
 public:
  /// Distances count from depth `origin_mm`.
  RaySamples(const GreyOctree& grey, const VoxelRay& ray, double origin_mm)
      : grey_(grey), per_mm_(floats(ray.per_mm)) {
    const glm::dvec3 p = ray.start + origin_mm * ray.per_mm;
    const glm::ivec3 first = glm::ivec3(glm::floor(p)) - reach;
    first_ = ints(first);
    origin_ = floats(p - glm::dvec3(first));
    last_ = ints(glm::ivec3(grey.universe().side() - 2));
  }

  /// Precondition: within the universe.
  float voxel(const glm::ivec3& voxel) {
    assert(voxel.x >= 0 && voxel.y >= 0 && voxel.z >= 0);
    return samples_of(voxel >> 4)[along(voxel.x) + (along(voxel.y) << 2) + (along(voxel.z) << 4)];
  }

  /// The interpolated sample at distance_mm along the ray. Precondition: the point at this distance is less
  /// than `reach` voxels from the origin.
  float operator()(float distance_mm) {
    const Float4 p = origin_ + distance_mm * per_mm_;
    const Int4 cell = clamped(first_ + __builtin_convertvector(p, Int4), Int4{}, last_);
    const Int4 same = cell == cell_;
    if ((same[0] & same[1] & same[2]) == 0) {
      cell_ = cell;
      fetch_corners();
    }
    const Float4 t =
        clamped(p - __builtin_convertvector(cell - first_, Float4), Float4{}, Float4{1.0f, 1.0f, 1.0f, 1.0f});
    const Float4 along_z = below_ + (above_ - below_) * t[2];
    const float left = along_z[0] + (along_z[2] - along_z[0]) * t[1];
    const float right = along_z[1] + (along_z[3] - along_z[1]) * t[1];
    return left + (right - left) * t[0];
  }

 private:
  static constexpr int reach = 8;

  const std::int16_t* samples_of(const glm::ivec3& block) {
    if (block != block_) {
      block_ = block;
      samples_ = grey_.brick(block).samples.front().data();
    }
    return samples_;
  }
  void fetch_corners() {
    const glm::ivec3 first(cell_[0], cell_[1], cell_[2]);
    const glm::ivec3 end = first + 1;
    // The common case: five cells in six lie within one brick.
    if (((first ^ end) & ~15) == glm::ivec3(0)) {
      const std::int16_t* samples = samples_of(first >> 4);
      const int x0 = along(first.x), x1 = along(end.x);
      const int y0 = along(first.y) << 2, y1 = along(end.y) << 2;
      const int z0 = along(first.z) << 4, z1 = along(end.z) << 4;
      const auto layer = [&](int z) {
        const Int4 four{samples[x0 + y0 + z], samples[x1 + y0 + z], samples[x0 + y1 + z],
                        samples[x1 + y1 + z]};
        return __builtin_convertvector(four, Float4);
      };
      below_ = layer(z0);
      above_ = layer(z1);
    } else {
      for (int corner = 0; corner < 4; ++corner) {
        const glm::ivec3 at = first + glm::ivec3(corner & 1, corner >> 1, 0);
        below_[corner] = voxel(at);
        above_[corner] = voxel(at + glm::ivec3(0, 0, 1));
      }
    }
  }
  /// The summand of coordinate x in the number of a brick's sample. Samples are numbered by leaves, then by
  /// voxels of a leaf, each in the order x + 4y + 16z.
  static int along(int coordinate) { return ((coordinate >> 2) & 3) * 64 + (coordinate & 3); }

  const GreyOctree& grey_;
  Float4 origin_{}, per_mm_;
  Int4 first_{};  ///< positions are counted from this voxel
  Int4 last_{};   ///< highest cell
  Int4 cell_{-1, -1, -1, 0};
  Float4 below_{}, above_{};  ///< samples at the corners x + 2y, at the cell's z and at z + 1
  glm::ivec3 block_{-1};
  const std::int16_t* samples_ = nullptr;  ///< of the block
};

/// A sample and its distance along the ray.
struct Sample {
  float distance_mm = 0.0f;
  float value = 0.0f;
};

/// The crossing of the threshold between a sample below it and one that is not below. Uses linear
/// interpolation, repeated once on the part that contains the crossing. Trilinear samples along a ray are a
/// cubic. Within half a voxel the error of this approximation is smaller than that of samples rounded to
/// integers.
float crossing(RaySamples& samples, float threshold, Sample below, Sample above) {
  const auto between = [&] {
    return below.distance_mm +
           (above.distance_mm - below.distance_mm) * (threshold - below.value) / (above.value - below.value);
  };
  Sample middle{between()};
  middle.value = samples(middle.distance_mm);
  (middle.value < threshold ? below : above) = middle;
  return above.value > below.value ? between() : middle.distance_mm;
}

Seen face_of(const Passage& passage) {
  return {static_cast<float>(passage.enter_mm), 0, true};
}

/// The surface near a voxel that a ray passes. If the ray is outside the surface where it enters the voxel,
/// searches forward until the ray leaves the voxel; none if the ray remains outside. If it is inside at the
/// entry, searches back over two voxels; the result is the voxel's face if the ray is inside everywhere
/// there. Distances of `samples` count from the entry.
std::optional<Seen> surface_about(RaySamples& samples, float threshold, const Passage& passage,
                                  float half_voxel_mm) {
  const auto surface = [&](Sample below, Sample above) {
    return Seen{static_cast<float>(passage.enter_mm + double{crossing(samples, threshold, below, above)}), 0,
                false};
  };
  const Sample enter{0.0f, samples(0.0f)};
  if (enter.value < threshold) {
    const auto way_mm = static_cast<float>(passage.leave_mm - passage.enter_mm);
    const Sample middle{0.5f * way_mm, samples(0.5f * way_mm)};
    if (middle.value >= threshold) return surface(enter, middle);
    const Sample leave{way_mm, samples(way_mm)};
    if (leave.value >= threshold) return surface(middle, leave);
    return std::nullopt;
  }
  // The interpolated surface is at most one voxel away from the object's voxels. Along an oblique ray this is
  // at most two voxels' lengths, so four steps of half a voxel back suffice.
  Sample above = enter;
  for (int step = 1; step <= 4; ++step) {
    const float distance_mm = -static_cast<float>(step) * half_voxel_mm;
    const Sample sample{distance_mm, samples(distance_mm)};
    if (sample.value < threshold) return surface(sample, above);
    above = sample;
  }
  return face_of(passage);
}

/// The depth that half a voxel's length along a ray spans.
float half_voxel_mm(const VoxelRay& ray) {
  return static_cast<float>(0.5 / glm::length(ray.per_mm));
}

}  // namespace

GreySurface::GreySurface(const DrawnObject& object)
    : grey_(*object.grey),
      threshold_(static_cast<float>(object.grey->in_steps(object.threshold))),
      side_(object.octree.universe().side()),
      still_from_voxel_(object.still_from_voxel()) {}

std::optional<Seen> GreySurface::seen(const VoxelRay& ray, const Mirror& mirror,
                                      const Passage& passage) const {
  return still_from_voxel_ ? seen_moved(ray, passage) : seen_still(ray, mirror, passage);
}

std::optional<Seen> GreySurface::seen_still(const VoxelRay& ray, const Mirror& mirror,
                                            const Passage& passage) const {
  RaySamples samples(grey_, ray, passage.enter_mm);
  // A voxel below the threshold has no surface in its samples.
  if (samples.voxel(mirror.native(passage.voxel)) < threshold_) return face_of(passage);
  // If the voxel in front was cut away, the surface does not lie in front of this voxel.
  glm::ivec3 before = passage.voxel;
  --before[passage.entered_through];
  before = mirror.native(before);
  const bool cut = glm::any(glm::lessThan(before, glm::ivec3(0))) ||
                   glm::any(glm::greaterThanEqual(before, glm::ivec3(side_))) ||
                   samples.voxel(before) >= threshold_;
  if (cut && samples(0.0f) >= threshold_) return face_of(passage);
  return surface_about(samples, threshold_, passage, half_voxel_mm(ray));
}

std::optional<Seen> GreySurface::seen_moved(const VoxelRay& ray, const Passage& passage) const {
  assert(still_from_voxel_);
  const VoxelRay still{glm::dvec3(*still_from_voxel_ * glm::dvec4(ray.start, 1.0)),
                       glm::dmat3(*still_from_voxel_) * ray.per_mm};
  RaySamples samples(grey_, still, passage.enter_mm);
  return surface_about(samples, threshold_, passage, half_voxel_mm(still));
}

}  // namespace octotomy::voxel
