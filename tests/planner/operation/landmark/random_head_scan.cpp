// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Scans a random head.
// 1 A voxel whose fields are decided in its ball has the value of its tissue; another one is the mean of
//   sub-samples.
// 2 Things in the air and the couch are laid over, by their share of each voxel.
// 3 Blur, streaks, noise, rounding.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>

#include "tests/planner/operation/landmark/random_head.h"
#include "verify/phantom/head_solids.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::tests {

using verify::Chance;
using verify::HeadBricks;

namespace {

constexpr double air_hu = -1000.0;
/// A warp's largest stretch, canonical over head lengths.
constexpr double most_stretch = 1.45;
/// The gap between skin and mask.
constexpr double mask_gap_mm = 0.4;

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

}  // namespace

class HeadScan {
 public:
  explicit HeadScan(const RandomHead& head) : head_(head), head_from_lps_(glm::inverse(head.lps_from_head_)) {
    lay_lattice();
  }

  voxel::Scene scan(const voxel::Progress& progress) {
    samples_.resize(lattice_.sample_count());
    const glm::ivec3 blocks = (lattice_.dims + block_ - 1) / block_;
    voxel::SharedProgress rows_done(progress, static_cast<std::size_t>(blocks.z));
    tbb::parallel_for(0, blocks.z, [&](int z) {
      rows_done.one_more();
      for (int y = 0; y < blocks.y; ++y)
        for (int x = 0; x < blocks.x; ++x) {
          const glm::ivec3 first = glm::ivec3(x, y, z) * block_;
          scan_block(first, glm::min(first + block_, lattice_.dims));
        }
    });
    for (const RandomHead::Thing& thing : head_.things_)
      lay(head_point(thing.from_mm), head_point(thing.to_mm), thing.radius_mm, thing.hu);
    if (head_.metal_) {
      const glm::dvec3 at = head_point(head_.head_mm(head_.metal_->centre_mm));
      lay(at, at, head_.metal_->radius_mm, 3000.0);
    }
    if (head_.couch_) lay_couch();
    for (int axis = 0; axis < 3; ++axis) blur(axis);
    if (head_.metal_) streak();
    return finished();
  }

 private:
  glm::dvec3 head_point(const glm::dvec3& p) const {
    return glm::dvec3(head_.lps_from_head_ * glm::dvec4(p, 1.0));
  }
  std::size_t index(const glm::ivec3& v) const {
    return (static_cast<std::size_t>(v.z) * static_cast<std::size_t>(lattice_.dims.y) +
            static_cast<std::size_t>(v.y)) *
               static_cast<std::size_t>(lattice_.dims.x) +
           static_cast<std::size_t>(v.x);
  }

  void lay_lattice() {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 q(corner & 1 ? 86 : -86, corner & 2 ? 104 : -118, corner & 4 ? 112 : -104);
      const glm::dvec3 p = head_point(head_.head_mm(q));
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    low -= glm::dvec3(6.0, 18.0, head_.below_mm_);
    high += glm::dvec3(6.0, head_.couch_ ? 40.0 : 8.0, 6.0);
    const glm::dvec3 step(head_.voxel_mm_, head_.voxel_mm_, head_.slice_mm_);
    lattice_.dims = glm::ivec3(glm::ceil((high - low) / step));
    for (int axis = 0; axis < 3; ++axis) lattice_.lps_from_voxel[axis][axis] = step[axis];
    lattice_.lps_from_voxel[3] = glm::dvec4(low, 1.0);
    half_diagonal_mm_ = 0.5 * glm::length(step);
    parts_ = {2, 2, std::clamp(static_cast<int>(std::lround(2.0 * step.z / step.x)), 2, 6)};
    block_ = std::max(1, static_cast<int>(HeadBricks::margin_mm / (half_diagonal_mm_ * most_stretch)));
    step_mm_ = step;
  }

  /// Prunes the fields that matter within a ball, in the order in which they decide. A mask needs the skin's
  /// value outside, too.
  void narrow(const glm::dvec3& q, double radius_mm, const HeadBricks::Fields& from,
              HeadBricks::Places& places, HeadBricks::Fields& pruned) const {
    for (const auto field :
         {HeadBricks::Skin, HeadBricks::Air, HeadBricks::Bone, HeadBricks::ToothCore, HeadBricks::Teeth}) {
      if (places[field] < 0) {
        const double at = prune(from[field], q, radius_mm, pruned[field]);
        places[field] = verify::place(at, radius_mm);
        if (field == HeadBricks::Skin && head_.mask_mm_ > 0.0 && at > 0.0 && at < radius_mm + 4.0)
          places[field] = -1;
      }
      if (places[HeadBricks::Skin] == 0 || places[HeadBricks::Air] == 1) return;
      if (field == HeadBricks::Bone && places[field] == 0) return;
      if (field == HeadBricks::ToothCore && head_.has_upper_teeth_ && head_.has_lower_teeth_) return;
    }
  }
  bool is_decided(const HeadBricks::Places& places) const {
    if (places[HeadBricks::Skin] == 0 || places[HeadBricks::Air] == 1) return true;
    if (places[HeadBricks::Skin] < 0 || places[HeadBricks::Air] < 0) return false;
    if (places[HeadBricks::Bone] == 0) return true;
    if (places[HeadBricks::Bone] < 0 || places[HeadBricks::ToothCore] < 0 || !head_.defects_.empty())
      return false;
    return places[HeadBricks::Teeth] >= 0 || (head_.has_upper_teeth_ && head_.has_lower_teeth_);
  }

  glm::dvec3 head_of(const glm::dvec3& voxel) const {
    return glm::dvec3(head_from_lps_ * glm::dvec4(lattice_.lps_mm(voxel), 1.0));
  }

  void scan_block(const glm::ivec3& first, const glm::ivec3& end) {
    thread_local HeadBricks::Fields of_block, of_voxel;
    const glm::dvec3 centre = head_.canonical_mm(head_of(glm::dvec3(first + end - 1) * 0.5));
    const double block_mm = half_diagonal_mm_ * most_stretch * block_;
    const HeadBricks::Brick& brick = HeadBricks::instance().at(centre, block_mm);
    HeadBricks::Places block_places = brick.places;
    narrow(centre, block_mm, brick.steps, block_places, of_block);
    const bool is_one = is_decided(block_places);
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
          const glm::dvec3 h = head_of({x, y, z});
          float& sample = samples_[index({x, y, z})];
          HeadBricks::Places places = block_places;
          if (!is_one)
            narrow(head_.canonical_mm(h), half_diagonal_mm_ * most_stretch, of_block, places, of_voxel);
          if (is_one || is_decided(places)) {
            sample = static_cast<float>(hu({}, places, of_voxel));
            continue;
          }
          double sum = 0.0;
          for (int part = 0; part < parts_.x * parts_.y * parts_.z; ++part) {
            const glm::ivec3 at(part % parts_.x, part / parts_.x % parts_.y, part / (parts_.x * parts_.y));
            const glm::dvec3 off = (glm::dvec3(at) + 0.5) / glm::dvec3(parts_) - 0.5;
            sum +=
                hu(head_.canonical_mm(h + glm::dmat3(head_from_lps_) * (off * step_mm_)), places, of_voxel);
          }
          sample = static_cast<float>(sum / (parts_.x * parts_.y * parts_.z));
        }
  }

  double hu(const glm::dvec3& q, const HeadBricks::Places& places, const HeadBricks::Fields& pruned) const {
    const auto holds = [&](HeadBricks::Field field) {
      return places[field] >= 0 ? places[field] == 1 : value(pruned[field], q) < 0.0;
    };
    if (places[HeadBricks::Skin] == 0) return air_hu;
    if (places[HeadBricks::Skin] < 0) {
      const double skin = value(pruned[HeadBricks::Skin], q);
      const bool is_mask =
          head_.mask_mm_ > 0.0 && q.y < 10.0 && skin > mask_gap_mm && skin < mask_gap_mm + head_.mask_mm_;
      if (skin > 0.0) return is_mask ? head_.mask_hu_ : air_hu;
    }
    if (holds(HeadBricks::Air)) return air_hu;
    if (!holds(HeadBricks::Bone)) return RandomHead::soft_hu;
    const bool has_all_teeth = head_.has_upper_teeth_ && head_.has_lower_teeth_;
    if (head_.was_removed(q, !has_all_teeth && holds(HeadBricks::Teeth))) return RandomHead::soft_hu;
    return holds(HeadBricks::ToothCore) ? head_.tooth_hu_ : head_.bone_hu_;
  }

  /// Draws a capsule over the present samples.
  void lay(const glm::dvec3& from, const glm::dvec3& to, double radius_mm, double hu) {
    const glm::dvec3 reach = glm::dvec3(radius_mm) + step_mm_;
    const glm::dvec3 first_mm(lattice_.lps_from_voxel[3]);
    const glm::ivec3 low =
        glm::max(glm::ivec3(glm::floor((glm::min(from, to) - reach - first_mm) / step_mm_)), glm::ivec3(0));
    const glm::ivec3 high = glm::min(
        glm::ivec3(glm::ceil((glm::max(from, to) + reach - first_mm) / step_mm_)), lattice_.dims - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
          int inside = 0;
          for (int part = 0; part < 64; ++part) {
            const glm::dvec3 off = (glm::dvec3(part & 3, part >> 2 & 3, part >> 4) + 0.5) / 4.0 - 0.5;
            const glm::dvec3 p = lattice_.lps_mm(glm::dvec3(x, y, z) + off);
            inside += distance_to_segment(p, from, to) < radius_mm ? 1 : 0;
          }
          float& sample = samples_[index({x, y, z})];
          sample += static_cast<float>((hu - static_cast<double>(sample)) * inside / 64.0);
        }
  }

  /// A board behind the head, the same on all slices, where there is air.
  void lay_couch() {
    const RandomHead::Couch& couch = *head_.couch_;
    int hindmost = 0;
    for (int z = 0; z < lattice_.dims.z; ++z)
      for (int y = lattice_.dims.y - 1; y > hindmost; --y)
        for (int x = 0; x < lattice_.dims.x; ++x)
          if (samples_[index({x, y, z})] > -500.0f) hindmost = y;
    const double middle = 0.5 * (lattice_.dims.x - 1);
    for (int y = 0; y < lattice_.dims.y; ++y)
      for (int x = 0; x < lattice_.dims.x; ++x) {
        const double across = (x - middle) * step_mm_.x / couch.half_width_mm;
        const double deep = (y - hindmost) * step_mm_.y - 1.0 + couch.curve_mm * across * across;
        if (deep < 0.0 || deep > couch.thick_mm) continue;
        const bool is_skin = deep < couch.skin_mm || deep > couch.thick_mm - couch.skin_mm;
        for (int z = 0; z < lattice_.dims.z; ++z) {
          float& sample = samples_[index({x, y, z})];
          if (sample < -990.0f) sample = static_cast<float>(is_skin ? couch.skin_hu : couch.core_hu);
        }
      }
  }

  /// Gaussian along one axis, cut off at 4 deviations; the border repeats.
  void blur(int axis) {
    const double deviation = head_.blur_mm_ / step_mm_[axis];
    const int reach = static_cast<int>(std::ceil(4.0 * deviation));
    std::vector<double> weights;
    double sum = 0.0;
    for (int tap = -reach; tap <= reach; ++tap) {
      weights.push_back(std::exp(-0.5 * tap * tap / (deviation * deviation)));
      sum += weights.back();
    }
    std::size_t stride = 1;
    for (int lower = 0; lower < axis; ++lower) stride *= static_cast<std::size_t>(lattice_.dims[lower]);
    const int length = lattice_.dims[axis];
    tbb::parallel_for(
        std::size_t{0}, samples_.size() / static_cast<std::size_t>(length), [&](std::size_t line) {
          float* const begin =
              samples_.data() + line / stride * stride * static_cast<std::size_t>(length) + line % stride;
          std::vector<float> copy(static_cast<std::size_t>(length));
          for (std::size_t i = 0; i < copy.size(); ++i) copy[i] = begin[i * stride];
          for (int i = 0; i < length; ++i) {
            double mean = 0.0;
            for (int tap = -reach; tap <= reach; ++tap)
              mean += weights[static_cast<std::size_t>(tap + reach)] *
                      static_cast<double>(copy[static_cast<std::size_t>(std::clamp(i + tap, 0, length - 1))]);
            begin[static_cast<std::size_t>(i) * stride] = static_cast<float>(mean / sum);
          }
        });
  }

  /// Rays of light and dark about the metal in its slices.
  void streak() {
    const glm::dvec3 at = head_point(head_.head_mm(head_.metal_->centre_mm));
    for (int z = 0; z < lattice_.dims.z; ++z) {
      const double high = (lattice_.lps_mm({0.0, 0.0, z}).z - at.z) / (head_.metal_->radius_mm + 0.5);
      if (std::abs(high) > 1.0) continue;
      for (int y = 0; y < lattice_.dims.y; ++y)
        for (int x = 0; x < lattice_.dims.x; ++x) {
          const glm::dvec3 p = lattice_.lps_mm(glm::dvec3(x, y, z));
          const double away = std::hypot(p.x - at.x, p.y - at.y) + 4.0,
                       angle = std::atan2(p.y - at.y, p.x - at.x);
          samples_[index({x, y, z})] +=
              static_cast<float>(5000.0 / away * std::pow(std::cos(7.0 * angle + 2.0 * high), 3.0));
        }
    }
  }

  voxel::Scene finished() const {
    voxel::Int16Samples rounded(samples_.size());
    tbb::parallel_for(0, lattice_.dims.z, [&](int z) {
      Chance chance(head_.seed_ * 100003 + static_cast<std::uint64_t>(z));
      const auto slice =
          static_cast<std::size_t>(lattice_.dims.x) * static_cast<std::size_t>(lattice_.dims.y);
      for (std::size_t i = static_cast<std::size_t>(z) * slice; i < (static_cast<std::size_t>(z) + 1) * slice;
           ++i)
        rounded[i] = static_cast<std::int16_t>(
            std::clamp(std::round(static_cast<double>(samples_[i]) + head_.noise_hu_ * chance.normal()),
                       -1024.0, 3071.0));
    });
    voxel::Scene scene;
    scene.lattice = lattice_;
    scene.samples = std::move(rounded);
    scene.meaning = voxel::Meaning::Hounsfield;
    scene.modality = "CT";
    scene.source = "random head";
    return scene;
  }

  const RandomHead& head_;
  glm::dmat4 head_from_lps_;
  voxel::Lattice lattice_;
  glm::dvec3 step_mm_{1.0};
  glm::ivec3 parts_{2};
  int block_ = 1;  ///< edge of what shares a pruning, in voxels
  double half_diagonal_mm_ = 0.0;
  voxel::FloatSamples samples_;
};

voxel::Scene RandomHead::scan(const voxel::Progress& progress) const {
  return HeadScan(*this).scan(progress);
}

}  // namespace octotomy::tests
