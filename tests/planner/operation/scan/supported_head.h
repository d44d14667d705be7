// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>
#include <tbb/parallel_for.h>
#include <vector>

#include "verify/phantom/head_phantom.h"
#include "voxel/space/scene.h"

// The head phantom on a table, with the truth of every sample.
namespace octotomy::tests {

/// The material at a sample's centre.
enum class Truth : std::uint8_t { Air, Soft, Bone, Support, Foam, Front };

struct SupportOptions {
  enum class Table { None, Board, Couch, Cradle, Slab } table = Table::Couch;
  bool holder = false;  ///< a base with two wings beside the head, over a part of the scan
  bool pillow = false;  ///< foam between the head and what carries it
  bool mask = false;    ///< a shell over the face that runs down to the table at the sides
  bool marker = false;  ///< a wire in the air before the nose
  bool strap = false;   ///< a band over the forehead that runs down to the table at the sides
  double arm_mm = 0.0;  ///< radius of an arm at the left border, which lies on the table; zero: no arm
  double couch_mm = 70.0;
  double sink_mm = 1.0;  ///< how deep the table's face lies within the head's back; negative is a gap
  double board_hu = 150.0, foam_hu = -900.0;
  double table_tilt_deg = 0.0;    ///< of the table's top about the patient's x axis
  glm::dvec3 head_turn_deg{0.0};  ///< about x, y and z
  glm::dvec3 voxel_mm{2.0};
  double blur_mm = 0.0, noise_hu = 10.0;
  std::uint64_t seed = 1;
};

struct SupportedHead {
  voxel::Scene scene;
  std::vector<Truth> truth;  ///< in the scene's order
  double middle_y_mm = 0.0;  ///< half-way between the foremost and the rearmost sample of the patient

  double litres(const std::function<bool(std::size_t)>& counts) const {
    double count = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) count += counts(i);
    return count * scene.lattice.voxel_mm3() * 1e-6;
  }
};

namespace supported_head {

/// The phantom without a headrest, sampled once.
inline const voxel::Scene& bare_head() {
  static const voxel::Scene scene = [] {
    verify::HeadOptions options;
    options.tissues.headrest = options.tissues.air;
    options.voxel_mm = 1.5;
    return verify::head_phantom(options);
  }();
  return scene;
}

/// Blurs along each axis by a Gaussian.
inline void blur(std::vector<float>& values, const voxel::Lattice& lattice, double sigma_mm) {
  const glm::dvec3 spacing = lattice.spacing_mm();
  const std::array<std::size_t, 3> strides{
      1, static_cast<std::size_t>(lattice.dims.x),
      static_cast<std::size_t>(lattice.dims.x) * static_cast<std::size_t>(lattice.dims.y)};
  for (int axis = 0; axis < 3; ++axis) {
    const int reach = static_cast<int>(std::ceil(3.0 * sigma_mm / spacing[axis]));
    std::vector<double> weights;
    double sum = 0.0;
    for (int k = -reach; k <= reach; ++k) {
      weights.push_back(std::exp(-0.5 * std::pow(k * spacing[axis] / sigma_mm, 2.0)));
      sum += weights.back();
    }
    const std::vector<float> before = values;
    const std::size_t stride = strides[static_cast<std::size_t>(axis)];
    tbb::parallel_for(0, lattice.dims.z, [&](int z) {
      for (int y = 0; y < lattice.dims.y; ++y)
        for (int x = 0; x < lattice.dims.x; ++x) {
          const glm::ivec3 p(x, y, z);
          const std::size_t at = static_cast<std::size_t>(x) * strides[0] +
                                 static_cast<std::size_t>(y) * strides[1] +
                                 static_cast<std::size_t>(z) * strides[2];
          double value = 0.0;
          for (int k = -reach; k <= reach; ++k) {
            const int q = std::clamp(p[axis] + k, 0, lattice.dims[axis] - 1) - p[axis];
            value += weights[static_cast<std::size_t>(k + reach)] *
                     static_cast<double>(before[at + static_cast<std::size_t>(q) * stride]);
          }
          values[at] = static_cast<float>(value / sum);
        }
    });
  }
}

/// The supports' closed forms, for a head whose back touches y = face_mm.
class Supports {
 public:
  Supports(const SupportOptions& options, double face_mm) : options_(options), face_mm_(face_mm) {}

  /// HU and truth of a point outside the head; `skin_mm` is its distance from the skin where that is near.
  /// An arm is the patient's.
  std::pair<double, Truth> at(glm::dvec3 p, double skin_mm) const {
    const double slope = std::tan(glm::radians(options_.table_tilt_deg));
    p.y -= slope * p.z;
    if (options_.marker && std::abs(p.y + 122.0) < 2.0 && std::abs(p.x) < 2.0 && std::abs(p.z + 20.0) < 12.0)
      return {2500.0, Truth::Front};
    const double depth = p.y - face_mm_;
    if (options_.arm_mm > 0.0) {
      const double radius = glm::length(glm::dvec2(p.x - 165.0, depth + options_.arm_mm + 0.5));
      if (radius < 0.3 * options_.arm_mm) return {900.0, Truth::Bone};
      if (radius < options_.arm_mm) return {45.0, Truth::Soft};
    }
    if (const auto found = table(p, depth)) return *found;
    if (options_.holder && holder(p, depth)) return {options_.board_hu, Truth::Support};
    if (options_.mask && mask(p, skin_mm)) return {50.0, Truth::Front};
    if (options_.strap && std::abs(p.z - 50.0) < 12.0 && depth < 0.0) {
      if (p.y < face_mm_ - 110.0 && skin_mm < 3.0) return {80.0, Truth::Front};
      if (p.y >= face_mm_ - 110.0 && std::abs(std::abs(p.x) - 94.0) < 1.5) return {80.0, Truth::Support};
    }
    if (options_.pillow && depth < 0.0 && depth > -60.0 && std::abs(p.x) < 95.0)
      return {options_.foam_hu + 60.0, Truth::Foam};
    return {-1000.0, Truth::Air};
  }

 private:
  std::optional<std::pair<double, Truth>> table(const glm::dvec3& p, double depth) const {
    switch (options_.table) {
      case SupportOptions::Table::None:
        return std::nullopt;
      case SupportOptions::Table::Board:
        if (depth < 0.0 || depth > 12.0 || std::abs(p.x) > 130.0) return std::nullopt;
        return std::pair{options_.board_hu, Truth::Support};
      case SupportOptions::Table::Couch: {
        const double inner = std::min({depth, options_.couch_mm - depth, 190.0 - std::abs(p.x)});
        if (inner < 0.0) return std::nullopt;
        return inner < 2.5 ? std::pair{options_.board_hu, Truth::Support}
                           : std::pair{options_.foam_hu, Truth::Support};
      }
      case SupportOptions::Table::Slab:
        if (depth < 0.0 || depth > options_.couch_mm || std::abs(p.x) > 190.0) return std::nullopt;
        return std::pair{options_.board_hu, Truth::Support};
      case SupportOptions::Table::Cradle: {
        const double radius = glm::length(glm::dvec2(p.x, p.y - (face_mm_ - 115.0)));
        if (radius < 115.0 || radius > 122.0 || p.y < face_mm_ - 75.0) return std::nullopt;
        return std::pair{options_.board_hu, Truth::Support};
      }
    }
    return std::nullopt;
  }

  bool holder(const glm::dvec3& p, double depth) const {
    if (p.z < -60.0) return false;  // it ends at the neck
    const bool wing = std::abs(std::abs(p.x) - 105.0) < 3.0 && depth < 0.0 && depth > -70.0;
    const bool base = depth <= 0.0 && depth > -6.0 && std::abs(p.x) < 105.0;
    return wing || base;
  }

  bool mask(const glm::dvec3& p, double skin_mm) const {
    if (std::abs(p.z) > 80.0) return false;
    return p.y < face_mm_ - 110.0 ? skin_mm < 3.0 : p.y < face_mm_ && std::abs(std::abs(p.x) - 92.0) < 1.5;
  }

  const SupportOptions& options_;
  double face_mm_;
};

}  // namespace supported_head

/// A scan of the head on supports. Cost: about a second at two millimetres.
inline SupportedHead head_on_supports(const SupportOptions& options) {
  using namespace supported_head;
  const voxel::Scene& bare = bare_head();
  glm::dmat4 turn(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 direction(0.0);
    direction[axis] = 1.0;
    turn = glm::rotate(turn, glm::radians(options.head_turn_deg[axis]), direction);
  }
  const glm::dmat4 back = glm::transpose(turn);
  const auto head_point = [&](const glm::dvec3& p) { return glm::dvec3(back * glm::dvec4(p, 1.0)); };
  const voxel::Box box = verify::head_bounds();

  SupportedHead head;
  head.scene.meaning = voxel::Meaning::Hounsfield;
  head.scene.modality = "CT";
  head.scene.source = "head on supports";
  const glm::dvec3 low(-215, -150, -112), high(215, 215, 125);
  head.scene.lattice =
      voxel::axis_aligned_lattice(glm::ivec3((high - low) / options.voxel_mm), options.voxel_mm, low);
  const voxel::Lattice& lattice = head.scene.lattice;
  const auto index = [&](const glm::ivec3& p) {
    return (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(lattice.dims.y) +
            static_cast<std::size_t>(p.y)) *
               static_cast<std::size_t>(lattice.dims.x) +
           static_cast<std::size_t>(p.x);
  };
  // The head's samples first, to know where its back lies.
  std::vector<float> values(lattice.sample_count(), -1000.0F);
  head.truth.assign(lattice.sample_count(), Truth::Air);
  std::vector<std::pair<double, double>> reach(static_cast<std::size_t>(lattice.dims.z), {1e9, -1e9});
  tbb::parallel_for(0, lattice.dims.z, [&](int z) {
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) {
        const glm::dvec3 p = lattice.lps_mm({x, y, z}), q = head_point(p);
        if (glm::any(glm::lessThan(q, box.low_mm)) || glm::any(glm::greaterThan(q, box.high_mm)) ||
            !verify::head_contains(verify::HeadPart::Skin, q))
          continue;
        const std::size_t at = index({x, y, z});
        head.truth[at] = verify::head_contains(verify::HeadPart::Bone, q) ? Truth::Bone : Truth::Soft;
        values[at] = static_cast<float>(voxel::interpolate(bare, bare.lattice.voxel(q)));
        auto& [front, rear] = reach[static_cast<std::size_t>(z)];
        front = std::min(front, p.y);
        rear = std::max(rear, p.y);
      }
  });
  double front = 1e9, rear = -1e9, face = -1e9;
  const double slope = std::tan(glm::radians(options.table_tilt_deg));
  for (int z = 0; z < lattice.dims.z; ++z) {
    front = std::min(front, reach[static_cast<std::size_t>(z)].first);
    rear = std::max(rear, reach[static_cast<std::size_t>(z)].second);
    face = std::max(face, reach[static_cast<std::size_t>(z)].second - slope * lattice.lps_mm({0, 0, z}).z);
  }
  head.middle_y_mm = 0.5 * (front + rear);
  // The head lies on the holder's base, which lies on the table.
  const Supports supports(options, face - options.sink_mm + (options.holder ? 6.0 : 0.0));
  tbb::parallel_for(0, lattice.dims.z, [&](int z) {
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) {
        const std::size_t at = index({x, y, z});
        if (head.truth[at] != Truth::Air) continue;
        const glm::dvec3 p = lattice.lps_mm({x, y, z});
        double skin_mm = std::numeric_limits<double>::infinity();
        if ((options.mask || options.strap) && glm::length(glm::dvec2(p)) < 130.0) {
          const glm::dvec3 inward = p * (1.0 - 3.0 / glm::length(p));
          if (verify::head_contains(verify::HeadPart::Skin, head_point(inward))) skin_mm = 2.0;
        }
        const auto [hu, truth] = supports.at(p, skin_mm);
        values[at] = static_cast<float>(hu);
        head.truth[at] = truth;
      }
  });
  if (options.blur_mm > 0.0) blur(values, lattice, options.blur_mm);
  voxel::Int16Samples samples(values.size());
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> noise(0.0, std::max(1e-9, options.noise_hu));
  for (std::size_t i = 0; i < values.size(); ++i)
    samples[i] = static_cast<std::int16_t>(
        std::clamp(std::lround(static_cast<double>(values[i]) + noise(random)), -1024L, 3071L));
  head.scene.samples = std::move(samples);
  return head;
}

/// The effect of a removal on the supported head.
struct RemovalTally {
  double support_l = 0.0, left_l = 0.0, foam_l = 0.0, foam_left_l = 0.0;
  double soft_mm3 = 0.0, bone_mm3 = 0.0, front_mm3 = 0.0;  ///< the patient's that is gone; any in front
  double soft_share = 0.0;                                 ///< of the patient's soft tissue
};

/// Counts supports only behind the coronal middle, where a removal may take them.
template <typename Removed>
RemovalTally tally(const SupportedHead& head, const Removed& removed) {
  const double mm3 = head.scene.lattice.voxel_mm3();
  RemovalTally tally;
  double soft = 0.0;
  for (std::size_t i = 0; i < head.truth.size(); ++i) {
    const auto x = static_cast<std::size_t>(head.scene.lattice.dims.x),
               y = static_cast<std::size_t>(head.scene.lattice.dims.y);
    const double at_mm =
        head.scene.lattice
            .lps_mm({static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / (x * y))})
            .y;
    const bool is_front = at_mm < head.middle_y_mm;
    const bool gone = removed(i);
    tally.front_mm3 += gone && is_front ? mm3 : 0.0;
    switch (head.truth[i]) {
      case Truth::Soft:
        soft += mm3;
        tally.soft_mm3 += gone ? mm3 : 0.0;
        break;
      case Truth::Bone:
        tally.bone_mm3 += gone ? mm3 : 0.0;
        break;
      case Truth::Support:
        if (is_front) break;
        tally.support_l += mm3 * 1e-6;
        tally.left_l += gone ? 0.0 : mm3 * 1e-6;
        break;
      case Truth::Foam:
        if (is_front) break;
        tally.foam_l += mm3 * 1e-6;
        tally.foam_left_l += gone ? 0.0 : mm3 * 1e-6;
        break;
      case Truth::Air:
      case Truth::Front:
        break;
    }
  }
  tally.soft_share = soft > 0.0 ? tally.soft_mm3 / soft : 0.0;
  return tally;
}

/// A random variant: table or none, holder, pillow, mask, strap, marker, arm, a gap to 6 mm, turns to 20
/// degrees, noise, blur and spacing.
inline SupportOptions random_supports(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  const auto chance = [&](double share) { return between(0.0, 1.0) < share; };
  SupportOptions options;
  options.table = static_cast<SupportOptions::Table>(1 + static_cast<int>(between(0.0, 2.999)));
  options.holder = chance(0.4);
  options.pillow = chance(0.4);
  options.mask = chance(0.25);
  options.marker = chance(0.4);
  options.couch_mm = between(30.0, 80.0);
  options.sink_mm = between(-6.0, 3.0);
  options.board_hu = between(-100.0, 350.0);
  options.foam_hu = between(-950.0, -820.0);
  options.table_tilt_deg = chance(0.3) ? between(-6.0, 6.0) : 0.0;
  options.head_turn_deg = {between(-20.0, 20.0), between(-10.0, 10.0), between(-20.0, 20.0)};
  options.blur_mm = between(0.3, 1.2);
  options.noise_hu = between(10.0, 60.0);
  const double pixel = between(1.3, 2.2);
  options.voxel_mm = {pixel, pixel, between(1.2, 3.5)};
  options.seed = seed;
  options.strap = chance(0.3);
  const double kind = between(0.0, 1.0);
  if (kind < 0.1) options.table = SupportOptions::Table::None;
  if (kind > 0.85) options.table = SupportOptions::Table::Slab;
  if (options.table != SupportOptions::Table::Cradle && chance(0.3)) options.arm_mm = between(22.0, 42.0);
  return options;
}

}  // namespace octotomy::tests
