// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Simulated scans of the head phantom's teeth, with noise, holes and a bent arch, laid onto its CT: how often the
// true error at the patches that the fit did not use lies in the stated interval, and which scans are refused. The
// long run: ninja tooth_scans.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "brep/align/tooth_scan.h"
#include "convert/surface/isosurface.h"
#include "tests/brep/shapes.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/tooth_scan_phantom.h"

namespace octotomy::verify {
namespace {

constexpr double bone_hu = 300.0, between_rows_mm = -59.2;

/// The bone and teeth of the phantom about the mouth, as a CT shows them; of the upper jaw alone or of both.
brep::Solid teeth_of_ct(const voxel::Scene& whole, bool has_lower = true) {
  const auto& samples = std::get<voxel::Int16Samples>(whole.samples);
  const glm::dvec3 from = whole.lattice.voxel({-45, -105, -85}), to = whole.lattice.voxel({45, -20, -30});
  const glm::ivec3 low(glm::ceil(from)), high(glm::floor(to));
  voxel::Scene mouth = whole;
  mouth.lattice.dims = high - low + 1;
  mouth.lattice.lps_from_voxel[3] = glm::dvec4(whole.lattice.lps_mm(glm::dvec3(low)), 1.0);
  voxel::Int16Samples kept;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const std::size_t i =
            static_cast<std::size_t>(x) +
            static_cast<std::size_t>(whole.lattice.dims.x) *
                (static_cast<std::size_t>(y) +
                 static_cast<std::size_t>(whole.lattice.dims.y) * static_cast<std::size_t>(z));
        const bool is_left_out = !has_lower && whole.lattice.lps_mm({0, 0, double(z)}).z < between_rows_mm;
        kept.push_back(is_left_out ? std::int16_t{-1000} : samples[i]);
      }
  mouth.samples = std::move(kept);
  return brep::trusted_solid(convert::isosurface(mouth, bone_hu, 1e9), brep::Proof::Construction);
}

HeadOptions head_of(double voxel_mm, double point_spread_sigma_mm, double noise_sigma_hu, int seed) {
  HeadOptions head;
  head.voxel_mm = voxel_mm;
  head.point_spread_sigma_mm = point_spread_sigma_mm;
  head.noise_sigma_hu = noise_sigma_hu;
  head.seed = static_cast<std::uint64_t>(seed);
  return head;
}
const voxel::Scene& one_ct() {
  static const voxel::Scene ct = head_phantom(head_of(1.0, 0.3, 20.0, 1));
  return ct;
}

glm::dvec3 laid_at(const brep::LaidToothScan& laid, const glm::dvec3& p_mm) {
  return glm::dvec3(laid.fixed_from_scan * glm::dvec4(p_mm, 1.0));
}

/// The root mean square distance of the scan's points, in the patches that the fit did not use, from where they
/// truly are. `off_mm` spoils the scan's place.
double true_error_mm(const brep::LaidToothScan& laid, const ToothScanPhantom& phantom,
                     const glm::dvec3& off_mm) {
  constexpr double within_mm = 1.5;
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < phantom.truth_mm.size(); ++i) {
    const glm::dvec3 p = laid_at(laid, phantom.scan.points_mm[i]);
    const bool is_held = std::any_of(laid.held.begin(), laid.held.end(), [&](const brep::HeldPatch& patch) {
      return glm::distance(patch.at_mm, p) < within_mm;
    });
    if (!is_held) continue;
    const glm::dvec3 apart = p + off_mm - phantom.truth_mm[i];
    squares += glm::dot(apart, apart);
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(count));
}

int scans_wanted() {
  const char* words = std::getenv("OCTOTOMY_TOOTH_SCANS");
  return words != nullptr ? std::atoi(words) : 2;
}

bool holds(const brep::LaidToothScan& laid, double truth_mm) {
  return std::abs(truth_mm - laid.error_mm) <= laid.half_width_mm;
}

TEST(RandomToothScans, TheTrueErrorAtPatchesThatTheFitDidNotUseLiesInTheStatedInterval) {
  constexpr int scans_a_head = 10;
  const int wanted = scans_wanted();
  int held = 0, spoiled_held = 0;
  double most_mm = 0.0, most_true_mm = 0.0, seconds = 0.0;
  brep::Solid mouth = teeth_of_ct(one_ct());
  HeadOptions head = head_of(1.0, 0.3, 20.0, 1);
  for (int seed = 1; seed <= wanted; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    if (seed > 1 && seed % scans_a_head == 1) {
      const int number = seed / scans_a_head;
      head = head_of(0.7 + 0.1 * (number % 6), 0.1 * (number % 5), 10.0 * (number % 4), seed);
      mouth = teeth_of_ct(head_phantom(head));
    }
    const ToothScanPhantom phantom =
        tooth_scan_phantom({.is_upper = seed % 2 == 1, .seed = static_cast<std::uint64_t>(seed)});
    const auto start = std::chrono::steady_clock::now();
    const brep::LaidToothScan laid =
        brep::lay_tooth_scan(brep::mesh_of(phantom.scan), mouth, {phantom.points_mm, phantom.scan_points_mm},
                             {.sample_mm = head.voxel_mm});
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double truth_mm = true_error_mm(laid, phantom, glm::dvec3(0.0));
    if (holds(laid, truth_mm)) ++held;
    // The twin: a scan that lies half a millimetre off must not pass.
    if (holds(laid, true_error_mm(laid, phantom, {0.3, -0.3, 0.3}))) ++spoiled_held;
    most_mm = std::max(most_mm, laid.error_mm + laid.half_width_mm);
    most_true_mm = std::max(most_true_mm, truth_mm);
    std::printf(
        "seed %d, voxels %.1f mm: true error %.3f mm, stated %.3f +- %.3f, %zu patches held, %.0f %% match\n",
        seed, head.voxel_mm, truth_mm, laid.error_mm, laid.half_width_mm, laid.held.size(),
        100.0 * laid.matched_share);
  }
  EXPECT_GE(held, wanted - wanted / 100);
  EXPECT_LE(spoiled_held, wanted / 100);
  // An interval as wide as a voxel states nothing.
  EXPECT_LT(most_mm, 0.5);
  std::printf(
      "%d of %d hold, %d of the spoiled; largest true error %.3f mm, largest bound %.3f mm; %.1f s each\n",
      held, wanted, spoiled_held, most_true_mm, most_mm, seconds / wanted);
}

/// Points are often named from side to side, and the sides of the arch may cancel in such an order.
TEST(ToothScan, TheOrderOfThePointsDoesNotCount) {
  const ToothScanPhantom upper = tooth_scan_phantom({});
  const brep::Solid mouth = teeth_of_ct(one_ct());
  brep::ToothPoints zigzag;
  for (const std::size_t i : {0U, 6U, 1U, 5U, 2U, 4U, 3U}) {
    zigzag.fixed_mm.push_back(upper.points_mm[i]);
    zigzag.scan_mm.push_back(upper.scan_points_mm[i]);
  }
  const auto laid_by = [&](const brep::ToothPoints& points) {
    return brep::lay_tooth_scan(brep::mesh_of(upper.scan), mouth, points, {});
  };
  const brep::LaidToothScan along = laid_by({upper.points_mm, upper.scan_points_mm}),
                            across = laid_by(zigzag);
  EXPECT_LT(glm::distance(across.to_roots, along.to_roots), 1e-9);
  EXPECT_NEAR(across.tips_mm, along.tips_mm, 1e-9);
  EXPECT_NEAR(across.error_mm, along.error_mm, 0.01);
}

/// The sentence with which a scan is refused; empty if it is not.
std::string refusal(const brep::Triangles& scan, const brep::Solid& fixed, const brep::ToothPoints& points) {
  try {
    brep::lay_tooth_scan(brep::mesh_of(scan), fixed, points, {.scan = "'scan.stl'", .fixed = "'upper'"});
  } catch (const brep::Error& error) {
    return error.what();
  }
  return "";
}
void expect_words(const std::string& refused, const std::string& words) {
  EXPECT_NE(refused.find(words), std::string::npos) << refused;
}

brep::Triangles scaled(brep::Triangles surface, const glm::dvec3& by) {
  for (glm::dvec3& p : surface.points_mm) p *= by;
  if (by.x * by.y * by.z < 0.0)
    for (auto& face : surface.faces) std::swap(face[0], face[1]);
  return surface;
}
std::vector<glm::dvec3> scaled(std::vector<glm::dvec3> points_mm, const glm::dvec3& by) {
  for (glm::dvec3& p : points_mm) p *= by;
  return points_mm;
}

TEST(ToothScan, ScansThatDoNotFitAreRefusedInASentenceThatSaysWhy) {
  const ToothScanPhantom upper = tooth_scan_phantom({}), lower = tooth_scan_phantom({.is_upper = false});
  const brep::Solid upper_jaw = teeth_of_ct(one_ct(), false), mouth = teeth_of_ct(one_ct());
  const brep::ToothPoints right{upper.points_mm, upper.scan_points_mm};
  EXPECT_EQ(refusal(upper.scan, mouth, right), "");
  // The other jaw, with its points in the order of the upper one, and turned about.
  brep::ToothPoints other{upper.points_mm, lower.scan_points_mm};
  expect_words(refusal(lower.scan, mouth, other), "the scan shows the other jaw");
  std::reverse(other.scan_mm.begin(), other.scan_mm.end());
  expect_words(refusal(lower.scan, upper_jaw, other), "the scan shows the other jaw");
  const glm::dvec3 mirror(-1, 1, 1);
  expect_words(refusal(scaled(upper.scan, mirror), mouth, {right.fixed_mm, scaled(right.scan_mm, mirror)}),
               "fits only mirrored");
  brep::ToothPoints few{{right.fixed_mm.begin(), right.fixed_mm.begin() + 2},
                        {right.scan_mm.begin(), right.scan_mm.begin() + 2}};
  expect_words(refusal(upper.scan, mouth, few), "the points are too few");
  few.fixed_mm = right.fixed_mm;
  expect_words(refusal(upper.scan, mouth, few), "give the same places on both, in the same order");
  for (const auto& [mm, unit] :
       {std::pair(0.001, "its unit is probably"), {1000.0, "its unit is probably um"}}) {
    const glm::dvec3 by(mm);
    expect_words(refusal(scaled(upper.scan, by), mouth, {right.fixed_mm, scaled(right.scan_mm, by)}), unit);
  }
  expect_words(refusal({}, mouth, right), "has no triangles");
  expect_words(refusal(brep::shapes::sphere({900, 0, 0}, 30.0, 3), mouth, right), "mm off 'scan.stl'");
  // A closed solid whose points are on it, and points on the object where there are no teeth.
  const brep::Triangles ball = brep::shapes::sphere({900, 0, 0}, 30.0, 4);
  EXPECT_NE(refusal(ball, mouth,
                    {{right.fixed_mm[0], right.fixed_mm[3], right.fixed_mm[6]},
                     {{930, 0, 0}, {900, 30, 0}, {870, 0, 0}}}),
            "");
  brep::ToothPoints none = right;
  for (glm::dvec3& p : none.fixed_mm) p.z += 40.0;
  expect_words(refusal(upper.scan, mouth, none), "mm off 'upper'");
}

}  // namespace
}  // namespace octotomy::verify
