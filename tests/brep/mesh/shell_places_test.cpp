// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/shell_places.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "brep/mesh/equal_points.h"
#include "brep/mesh/ray_passing.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// Boxes, each a shell of twelve triangles.
struct Boxes {
  Triangles triangles;
  std::vector<std::uint32_t> shell;

  void add(const glm::dvec3& low, const glm::dvec3& high, bool is_cavity) {
    const auto name = static_cast<std::uint32_t>(triangles.faces.size());
    const Triangles box = shapes::box(low, high);
    triangles = shapes::together(std::move(triangles), is_cavity ? shapes::inside_out(box) : box);
    shell.resize(triangles.faces.size(), name);
  }
  std::vector<ShellPlace> places() const {
    const MortonTree tree(triangles);
    const std::vector<std::uint32_t> first = first_equal_points(triangles.points_mm);
    return shell_places({triangles, first, shell}, &tree);
  }
  /// The first of its points with the largest x. Points that other shells share are left out if there are
  /// others.
  glm::dvec3 probe_of(std::uint32_t name) const {
    const std::vector<std::uint8_t> touching =
        shared_points(triangles, first_equal_points(triangles.points_mm), shell);
    glm::dvec3 probe(-std::numeric_limits<double>::infinity());
    for (const std::uint8_t touches : {0, 1}) {
      for (std::uint32_t f = name; f < name + 12; ++f)
        for (const std::uint32_t v : triangles.faces[f])
          if (touching[v] == touches && triangles.points_mm[v].x > probe.x) probe = triangles.points_mm[v];
      if (std::isfinite(probe.x)) break;
    }
    return probe;
  }
  /// The winding number by all triangles of all other shells.
  int winding_about(std::uint32_t name) const {
    const glm::dvec3 probe = probe_of(name);
    int winding = 0;
    for (std::uint32_t f = 0; f < shell.size(); ++f) {
      const auto& [a, b, c] = triangles.faces[f];
      const auto& p = triangles.points_mm;
      const RayPassing passing = shell[f] == name ? RayPassing::Beside : passing_of(probe, p[a], p[b], p[c]);
      winding += passing == RayPassing::Leaving ? 1 : passing == RayPassing::Entering ? -1 : 0;
    }
    return winding;
  }
};

TEST(ShellPlaces, ASingleShellNeedsNoTree) {
  const Triangles box = shapes::box({0, 0, 0}, {1, 2, 3});
  const std::vector<std::uint32_t> first = first_equal_points(box.points_mm), shell(12, 0);
  const std::vector<ShellPlace> places = shell_places({box, first, shell}, nullptr);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].winding, 0);
  EXPECT_NEAR(places[0].volume_mm3, 6.0, 1e-14);
}

TEST(ShellPlaces, ARowOfHollowBoxesIsPlacedBoxByBox) {
  Boxes row;
  for (int k = 0; k < 40; ++k) {
    row.add({3.0 * k, 0, 0}, {3.0 * k + 2, 2, 2}, false);
    row.add({3.0 * k + 0.5, 0.5, 0.5}, {3.0 * k + 1.5, 1.5, 1.5}, true);
  }
  const std::vector<ShellPlace> places = row.places();
  ASSERT_EQ(places.size(), 80u);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(places[i].shell, 12 * i);
    EXPECT_EQ(places[i].winding, static_cast<int>(i % 2)) << i;
    EXPECT_NEAR(places[i].volume_mm3, i % 2 == 0 ? 8.0 : -1.0, 1e-12) << i;
  }
}

TEST(ShellPlaces, NestedShellsWindAsDeepAsTheyLie) {
  Boxes nest;
  for (int k = 1; k <= 20; ++k) nest.add(glm::dvec3(-k), glm::dvec3(k), false);
  const std::vector<ShellPlace> places = nest.places();
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(places[i].winding, 19 - static_cast<int>(i)) << i;
}

TEST(ShellPlaces, BoxesOfAnyPlaceWindAsAllTheirTrianglesSay) {
  int inside = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    // A coarse lattice: rays run along sides and through corners, and boxes touch.
    std::uniform_int_distribution<int> place(0, 8), size(1, 5), one_in_three(0, 2);
    Boxes boxes;
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 low(place(random), place(random), place(random));
      boxes.add(low, low + glm::dvec3(size(random), size(random), size(random)), one_in_three(random) == 0);
    }
    for (const ShellPlace& place_of : boxes.places()) {
      EXPECT_EQ(place_of.winding, boxes.winding_about(place_of.shell))
          << "seed " << seed << ", shell " << place_of.shell;
      inside += place_of.winding != 0;
    }
  }
  EXPECT_GT(inside, 0);
}

}  // namespace
}  // namespace octotomy::brep
