// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Guides and horseshoes, as splints have them, on random bumpy heads. Each is a block less the shadow of the
// head grown by a gap, so that it goes on. Half of them get a lug, a small ball that reaches into the head
// by a random depth above the tolerance: they bind there. The lug's way is a capsule, so that its depth at
// any place has a closed form. The long run: ninja random_seatings.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/mesh/distance.h"
#include "brep/shape/prism.h"
#include "brep/shape/seating.h"
#include "brep/shape/shadow.h"
#include "convert/voxel/voxelise.h"
#include "tests/brep/shapes.h"
#include "voxel/filter/seating.h"

namespace octotomy::verify {
namespace {

using brep::shapes::sphere;

constexpr double head_mm = 12.0, gap_mm = 0.25, tolerance_mm = 0.12, resolution_mm = 0.01, voxel_mm = 0.5;

using Random = std::mt19937_64;
double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
glm::dvec3 unit(Random& random) {
  for (;;) {
    const glm::dvec3 v(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    const double length = glm::length(v);
    if (length > 0.1 && length <= 1.0) return v / length;
  }
}

/// A ball with bumps and hollows, star-shaped about the origin.
class Head {
 public:
  explicit Head(Random& random) {
    for (int k = 0; k < 6; ++k)
      waves_.push_back({unit(random), uniform(random, 2.0, 6.0), uniform(random, 0.0, 6.0)});
  }
  brep::Solid grown(double by_mm) const {
    brep::Triangles surface = sphere({0, 0, 0}, 1.0, 4);
    for (glm::dvec3& p : surface.points_mm) {
      double share = 1.0;
      for (const Wave& wave : waves_)
        share += 0.035 * std::cos(wave.count * glm::dot(wave.along, p) + wave.phase);
      p *= head_mm * share + by_mm;
    }
    return brep::solid_of(surface);
  }

 private:
  struct Wave {
    glm::dvec3 along;
    double count = 1.0, phase = 0.0;
  };
  std::vector<Wave> waves_;
};

/// A block over the head, or a horseshoe around it, as seen along the direction in which it is put on.
brep::Prism block_along(const glm::dvec3& direction, bool is_horseshoe, Random& random) {
  const glm::dvec3 beside = std::abs(direction.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  brep::Prism block;
  block.look = direction;
  block.up = glm::normalize(glm::cross(direction, beside));
  block.right = glm::cross(block.look, block.up);
  block.from_mm = -head_mm * 1.35;
  block.to_mm = uniform(random, -0.5, 0.3) * head_mm;
  std::vector<glm::dvec2> outline;
  if (is_horseshoe) {
    const double outer = uniform(random, 0.95, 1.2) * head_mm, inner = uniform(random, 0.4, 0.7) * head_mm;
    constexpr int steps = 16;
    const double open = uniform(random, 0.3, 0.9);
    for (int k = 0; k <= steps; ++k) {
      const double angle = open + (2.0 * M_PI - 2.0 * open) * k / steps;
      outline.emplace_back(outer * std::cos(angle), outer * std::sin(angle));
    }
    for (int k = steps; k >= 0; --k) {
      const double angle = open + (2.0 * M_PI - 2.0 * open) * k / steps;
      outline.emplace_back(inner * std::cos(angle), inner * std::sin(angle));
    }
  } else {
    const glm::dvec2 middle(uniform(random, -0.5, 0.5) * head_mm, uniform(random, -0.5, 0.5) * head_mm);
    const glm::dvec2 half(uniform(random, 0.4, 0.8) * head_mm, uniform(random, 0.4, 0.8) * head_mm);
    outline = {middle - half, middle + glm::dvec2(half.x, -half.y), middle + half,
               middle + glm::dvec2(-half.x, half.y)};
  }
  block.polygons_mm = {outline};
  return block;
}

struct Lug {
  glm::dvec3 centre_mm{0.0};
  double radius_mm = 1.0;
  glm::dvec3 direction{0.0};

  /// The depth of a place in the lug's way: below 0 outside. The lug comes from before its place.
  double depth_mm(const glm::dvec3& p) const {
    const double along = std::min(glm::dot(p - centre_mm, direction), 0.0);
    return radius_mm - glm::distance(p, centre_mm + along * direction);
  }
};

/// The largest depth of a surface in the lug's way, by points no further apart than `apart_mm`.
double deepest_mm(const brep::Triangles& surface, const Lug& lug, double apart_mm) {
  double deepest = -1e300;
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 &p = surface.points_mm[a], &q = surface.points_mm[b], &r = surface.points_mm[c];
    const double longest = std::max({glm::distance(p, q), glm::distance(q, r), glm::distance(r, p)});
    if (lug.depth_mm(p) < deepest - longest) continue;
    const int steps = static_cast<int>(std::ceil(longest / apart_mm));
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j)
        deepest =
            std::max(deepest, lug.depth_mm(p + (double(i) * (q - p) + double(j) * (r - p)) / double(steps)));
  }
  return deepest;
}

struct Case {
  brep::Solid part, head;
  std::optional<Lug> lug;
  glm::dvec3 direction{0.0};
};

std::optional<Case> random_case(int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  Case made;
  const Head shape(random);
  made.head = shape.grown(0.0);
  made.direction = unit(random);
  const brep::Solid cast = shape.grown(gap_mm);
  const brep::Shadow taken =
      brep::shadow(cast, {made.direction, brep::far_end_mm(cast, made.direction) + head_mm, {}});
  const bool is_horseshoe = seed % 4 >= 2;
  const brep::Solid block = brep::solid_of(block_along(made.direction, is_horseshoe, random));
  made.part = brep::boolean(block, brep::Operation::Difference, taken.solid).solid;
  if (made.part.empty()) return std::nullopt;
  if (seed % 2 == 0) return made;
  // The lug sits where the part's fitting surface is near the head.
  const brep::Triangles& head = made.head.triangles();
  for (int round = 0; round < 2000; ++round) {
    const auto& [a, b, c] = head.faces[random() % head.faces.size()];
    const glm::dvec3 &p = head.points_mm[a], &q = head.points_mm[b], &r = head.points_mm[c];
    const glm::dvec3 normal = glm::normalize(glm::cross(q - p, r - p)), at = (p + q + r) / 3.0;
    if (glm::dot(normal, made.direction) > -0.1) continue;
    const double depth_mm = uniform(random, tolerance_mm + 0.06, 2.0);
    const double radius_mm = uniform(random, depth_mm + 0.4, depth_mm + 1.2);
    const glm::dvec3 centre = at + (radius_mm - depth_mm) * normal;
    std::uint32_t near = 0;
    if (!made.part.tree().is_inside(at + 2.0 * gap_mm * normal) ||
        made.part.tree().distance_mm(centre, near) > 0.7 * radius_mm)
      continue;
    made.part =
        brep::boolean(made.part, brep::Operation::Union, brep::solid_of(sphere(centre, radius_mm, 3))).solid;
    made.lug = Lug{centre, radius_mm, made.direction};
    return made;
  }
  return std::nullopt;
}

int cases_wanted() {
  const char* words = std::getenv("OCTOTOMY_SEATINGS");
  return words != nullptr ? std::atoi(words) : 6;
}

TEST(RandomSeatings, EveryPartThatBindsIsNamedWithItsPlaceAndNoneFalsely) {
  const voxel::Universe universe =
      voxel::universe_around({glm::dvec3(-2.2 * head_mm), glm::dvec3(2.2 * head_mm)}, voxel_mm);
  const double voxel_error_mm = glm::length(universe.lattice().spacing_mm());
  int binding = 0, free = 0, left_out = 0, named_by_voxels = 0;
  std::vector<double> seconds;
  for (int seed = 1; binding + free < cases_wanted(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::optional<Case> made = random_case(seed);
    if (!made) {
      ASSERT_LT(++left_out, cases_wanted() + 20) << "most cases are left out";
      continue;
    }
    const voxel::Octree part = convert::voxelise(universe, made->part.linked()),
                        head = convert::voxelise(universe, made->head.linked());
    const auto start = std::chrono::steady_clock::now();
    const brep::Seating by_mesh = brep::seating(made->part, made->head, {made->direction, resolution_mm});
    const voxel::Seating by_voxels = voxel::seating(part, voxel::Expression(part), head, {made->direction});
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    const double mesh_mm = by_mesh.binding ? by_mesh.binding->depth_mm : 0.0,
                 voxels_mm = by_voxels.binding ? by_voxels.binding->depth_mm : 0.0;
    EXPECT_NEAR(mesh_mm, voxels_mm, voxel_error_mm);
    if (!made->lug) {
      ++free;
      EXPECT_LT(mesh_mm, 2.0 * resolution_mm);
      continue;
    }
    ++binding;
    // The lug is a ball of flat triangles: its way is narrower than the capsule by their sag.
    const double flat_mm = 0.02 * made->lug->radius_mm;
    const double truth_mm = deepest_mm(made->head.triangles(), *made->lug, 0.05);
    EXPECT_GT(truth_mm, tolerance_mm);
    EXPECT_GT(mesh_mm, tolerance_mm) << "binds by " << truth_mm << " mm, and is not named";
    EXPECT_GT(mesh_mm, truth_mm - flat_mm - resolution_mm);
    ASSERT_TRUE(by_mesh.binding);
    const brep::Binding& at = *by_mesh.binding;
    EXPECT_GT(made->lug->depth_mm(at.at_mm), -voxel_mm) << "the place is not in the lug's way";
    // Voxels alone name places that are deeper than what they cannot tell, which is everywhere.
    EXPECT_TRUE(by_voxels.binding || truth_mm < voxel_error_mm);
    if (voxels_mm > voxel_error_mm) {
      ++named_by_voxels;
      EXPECT_GT(made->lug->depth_mm(by_voxels.binding->at_mm), -voxel_mm);
    }
    // The lug comes over the place `first` before the end, and has passed it `last` before the end.
    EXPECT_GE(at.first_mm, at.last_mm);
    const double before_mm = -glm::dot(at.at_mm - made->lug->centre_mm, made->direction);
    EXPECT_GT(at.first_mm, before_mm - voxel_mm);
  }
  EXPECT_EQ(binding + free, cases_wanted());
  EXPECT_GT(binding, cases_wanted() / 3);
  EXPECT_GT(free, cases_wanted() / 3);
  EXPECT_GT(named_by_voxels, 0);
  std::sort(seconds.begin(), seconds.end());
  std::printf("%d bind, %d go on, %d left out; median %.3f s, largest %.3f s\n", binding, free, left_out,
              seconds[seconds.size() / 2], seconds.back());
}

}  // namespace
}  // namespace octotomy::verify
