// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/counted_window.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "tests/planner/ct_scene.h"
#include "verify/phantom/chance.h"
#include "verify/phantom/implicit_solid.h"

namespace octotomy::planner {
namespace {

constexpr double open_end = std::numeric_limits<double>::infinity();

/// A label map of ones where the centre of a sample is inside.
voxel::Scene labels_of(const std::function<bool(const glm::dvec3&)>& is_inside, const glm::dvec3& spacing_mm,
                       double reach_mm) {
  const glm::ivec3 half(glm::ceil(reach_mm / spacing_mm) + 1.0);
  voxel::Scene scene = tests::ct_scene(2 * half + 1, spacing_mm, -glm::dvec3(half) * spacing_mm,
                                       [&](auto, const glm::dvec3& p_mm) { return is_inside(p_mm) ? 1 : 0; });
  scene.meaning = voxel::Meaning::Label;
  return scene;
}

struct LabelledSolid {
  voxel::Scene labels;
  double volume_mm3 = 0.0;
};

/// A ball, a shell, a plate, a block or a rod of random size, pose and lattice.
LabelledSolid drawn(int number) {
  verify::Chance chance(static_cast<std::uint64_t>(number) + 901);
  const auto size = [&](double low, double high) {
    return low * std::exp(chance.between(0.0, std::log(high / low)));
  };
  constexpr double slices[] = {1.0, 2.0, 3.0, 5.0};
  const glm::dvec3 spacing_mm(size(0.5, 1.5), size(0.5, 1.5), slices[number / 5 % 4]);
  const glm::dmat3 turn = chance.even() < 0.0
                              ? glm::dmat3(1.0)
                              : verify::turned({chance.between(-180, 180), chance.between(-90, 90), 30.0});
  const glm::dvec3 at = glm::dvec3(chance.even(), chance.even(), chance.even()) * spacing_mm;
  const auto labelled = [&](double volume_mm3, double reach_mm, auto&& is_inside) {
    return LabelledSolid{labels_of([&](const glm::dvec3& p) { return is_inside(turn * (p - at)); },
                                   spacing_mm, reach_mm + 4.0),
                         volume_mm3};
  };
  const double r = size(3.0, 18.0), t = size(0.8, 4.0), length = size(8.0, 30.0);
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi;
  const auto box = [](const glm::dvec3& half) {
    return [half](const glm::dvec3& p) { return glm::all(glm::lessThanEqual(glm::abs(p), half)); };
  };
  switch (number % 5) {
    case 0:
      return labelled(ball_mm3 * r * r * r, r, [r](const glm::dvec3& p) { return glm::length(p) <= r; });
    case 1:
      return labelled(ball_mm3 * (std::pow(r + t, 3) - r * r * r), r + t,
                      [r, t](const glm::dvec3& p) { return glm::length(p) >= r && glm::length(p) <= r + t; });
    case 2:
      return labelled(t * length * length, length, box({0.5 * t, 0.5 * length, 0.5 * length}));
    case 3:
      return labelled(8.0 * r * r * t, 2.0 * r, box({r, r, t}));
    default:
      return labelled(std::numbers::pi * t * t * length, length, [t, length](const glm::dvec3& p) {
        return std::hypot(p.x, p.y) <= t && std::abs(p.z) <= 0.5 * length;
      });
  }
}

TEST(CountedWindow, TheDoubtOfACountHoldsSolidsOfAllThicknessesOnUnevenLattices) {
  constexpr int solids = 200;
  int held = 0, held_by_a_fifth = 0;
  for (int number = 0; number < solids; ++number) {
    const LabelledSolid solid = drawn(number);
    const double counted_mm3 =
        static_cast<double>(count_in(solid.labels, 1.0, 1.0)) * sample_mm3(solid.labels);
    const double off = std::abs(counted_mm3 - solid.volume_mm3);
    const double doubt_mm3 = counting_doubt_mm3(solid.labels, 1.0, 1.0);
    held += off <= doubt_mm3 ? 1 : 0;
    held_by_a_fifth += off <= 0.2 * doubt_mm3 ? 1 : 0;
  }
  // Seven of 200 miss less than once in a hundred runs of 98.5 %.
  EXPECT_GE(held, solids - 7);
  EXPECT_LT(held_by_a_fifth, solids - 20) << "a fifth of the doubt would do";
}

TEST(CountedWindow, OneSectionOfAPlateSaysLittleOfItsThickness) {
  const auto plate = [](const glm::dvec3& p) {
    return std::abs(p.z) < 0.4 && std::abs(p.x) < 10.0 && std::abs(p.y) < 10.0;
  };
  const voxel::Scene labels = labels_of(plate, {1.0, 1.0, 3.0}, 14.0);
  const double counted_mm3 = static_cast<double>(count_in(labels, 1.0, 1.0)) * sample_mm3(labels);
  EXPECT_EQ(counted_mm3, 19.0 * 19.0 * 3.0);
  EXPECT_GT(counting_doubt_mm3(labels, 1.0, 1.0), counted_mm3 - 0.8 * 400.0);
}

TEST(CountedWindow, TheMeanOfTwoIsTakenAlongTheCoarsestAxisAndHoldsNoPadding) {
  voxel::Scene scene = tests::ct_scene({2, 2, 3}, {1.0, 1.0, 2.0}, {5.0, 6.0, 7.0}, [](auto v, auto) {
    return v == glm::ivec3(0, 0, 1) ? -2000 : 10 * v.x + 100 * v.z;
  });
  scene.padding = -2000.0;
  const voxel::Scene thick = averaged_by_two(scene);
  EXPECT_EQ(thick.lattice.dims, glm::ivec3(2, 2, 2));
  EXPECT_EQ(thick.lattice.spacing_mm(), glm::dvec3(1.0, 1.0, 4.0));
  EXPECT_EQ(thick.lattice.lps_mm(glm::dvec3(0.0)), glm::dvec3(5.0, 6.0, 8.0));
  const auto& samples = std::get<voxel::Int16Samples>(thick.samples);
  EXPECT_EQ(samples[0], 0) << "beside padding";
  EXPECT_EQ(samples[1], 60);
  EXPECT_EQ(samples[5], 210) << "the last of three slices stays alone";
  const voxel::Scene even = tests::ct_scene({5, 4, 4}, {1.0, 0.9, 1.1}, {}, [](auto, auto) { return 7; });
  EXPECT_EQ(averaged_by_two(even).lattice.dims, glm::ivec3(3, 2, 2)) << "all axes are about as coarse";
}

TEST(CountedWindow, ThickerSamplesLoseASheetAndKeepABlock) {
  const auto scan = [](double thickness_mm) {
    return tests::ct_scene({24, 24, 24}, {1, 1, 1}, glm::dvec3(-11.5), [&](auto, const glm::dvec3& p) {
      const double share = std::clamp(0.5 * thickness_mm - std::abs(p.z) + 0.5, 0.0, 1.0);
      return std::abs(p.x) < 8.0 && std::abs(p.y) < 8.0 ? 1000.0 * share : 0.0;
    });
  };
  const auto sheet = thickness_of(scan(2.0), 600.0, open_end),
             block = thickness_of(scan(12.0), 600.0, open_end);
  ASSERT_TRUE(sheet && block);
  EXPECT_LE(std::abs(block->volume_change_mm3), 0.05 * 16 * 16 * 12);
  EXPECT_EQ(block->border_mm3, 0.0);
  EXPECT_FALSE(thickness_of(scan(2.0), 5000.0, open_end)) << "nothing is inside";
  const auto thin = thickness_of(scan(1.5), 600.0, open_end);
  ASSERT_TRUE(thin);
  EXPECT_LT(thin->volume_change_mm3, -0.3 * 16 * 16) << "means of 750 and 750 stay, of 750 and 0 do not";
}

TEST(CountedWindow, HalfASampleBeyondTheBorderIsNotKnown) {
  const voxel::Scene scan = tests::ct_scene({8, 8, 8}, {1, 1, 3}, {}, [](auto v, auto) {
    return v.z >= 4 && v.x >= 2 && v.x < 6 && v.y >= 2 && v.y < 6 ? 1000 : 0;
  });
  const auto found = thickness_of(scan, 500.0, open_end);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->border_mm3, 0.5 * 3.0 * 16.0);
  EXPECT_EQ(cut_mm2(scan, 500.0, open_end), 16.0);
  EXPECT_EQ(cut_mm2(scan, -500.0, 500.0), 2.0 * (24.0 + 24.0) * 8.0 + 2.0 * 64.0 - 16.0);
  EXPECT_FALSE(cut_finding(0.1, 200.0));
  EXPECT_NE(cut_finding(16.0, 200.0).value_or("").find("16.0 mm²"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
