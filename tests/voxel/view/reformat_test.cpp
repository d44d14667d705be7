// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/reformat.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "tests/voxel/linear_scene.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

// The field that linear_scene() rounds, in float: linear interpolation gives it back.
Scene exact_scene(const Lattice& lattice) {
  return tests::field_scene<float>(lattice, tests::linear_field);
}

Lattice head_lattice(double x_step_mm) {
  Lattice lattice = axis_aligned_lattice({40, 30, 20}, {1, 1, 2}, {x_step_mm > 0 ? -19.5 : 19.5, -14.5, -19});
  lattice.lps_from_voxel[0][0] = x_step_mm;
  return lattice;
}

// The brightest pixel of a plane through the scan's middle, as a place from (0, 0), top left, to (1, 1).
glm::dvec2 brightest(const Scene& scene, const char* view, const glm::dvec3& middle_mm) {
  const View seen = parse_view(view);
  const Sheet sheet = plane_sheet(scene.lattice, seen, glm::dot(middle_mm, seen.look), 1.0);
  const SheetSamples picture = sample(scene, sheet, Interpolation::Linear);
  const auto at = std::max_element(picture.image.values.begin(), picture.image.values.end());
  const auto number = static_cast<int>(at - picture.image.values.begin());
  const glm::ivec2 size = sheet.size_px();
  return {number % size.x / (size.x - 1.0), number / size.x / (size.y - 1.0)};
}

// A bright block at the patient's left, front and head.
Scene marked(const Lattice& lattice, bool mirrored) {
  Scene scene;
  scene.lattice = lattice;
  Int16Samples samples;
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) {
        glm::dvec3 p = lattice.lps_mm({x, y, z});
        if (mirrored) p.x = -p.x;
        samples.push_back(static_cast<std::int16_t>(1000.0 + 10.0 * p.x - 10.0 * p.y + 10.0 * p.z));
      }
  scene.samples = std::move(samples);
  return scene;
}

// Radiological convention: the patient's left is on the picture's right in axial and coronal slices, the face
// is up in axial slices and left in sagittal ones, the head is up otherwise.
bool is_radiological(const Scene& scene) {
  const auto near = [&](const char* view, const glm::dvec2& corner) {
    return glm::distance(brightest(scene, view, {0.5, 0.5, 1.0}), corner) < 0.01;
  };
  return near("inferior", {1, 0}) && near("anterior", {1, 0}) && near("left", {0, 0});
}

TEST(PlaneSheet, IsRadiologicalWhateverTheOrderOfSamplesAndNotForAMirroredPatient) {
  for (const double x_step_mm : {1.0, -1.0}) {
    EXPECT_TRUE(is_radiological(marked(head_lattice(x_step_mm), false))) << x_step_mm;
    EXPECT_FALSE(is_radiological(marked(head_lattice(x_step_mm), true))) << x_step_mm;
  }
}

TEST(PlaneSheet, OfTheLatticesOwnAxesHasItsSamplesAsPixels) {
  const Scene scene = tests::linear_scene(head_lattice(-1.0));
  const Sheet sheet = plane_sheet(scene.lattice, parse_view("inferior"), -19 + 2 * 7, 1.0);
  ASSERT_EQ(sheet.size_px(), glm::ivec2(40, 30));
  const SheetSamples picture = sample(scene, sheet, Interpolation::Linear);
  const auto& samples = std::get<Int16Samples>(scene.samples);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)  // index x runs to the patient's right, the picture to the left
      ASSERT_FLOAT_EQ(picture.image.values[static_cast<std::size_t>(x + 40 * y)],
                      samples[static_cast<std::size_t>(39 - x + 40 * (y + 30 * 7))])
          << x << ' ' << y;
}

TEST(PlaneSheet, ShowsALinearFieldExactlyWhereverItCuts) {
  for (const bool left_handed : {false, true}) {
    const Scene scene = exact_scene(tests::oblique_lattice(left_handed));
    const glm::dvec3 middle_mm = scene.lattice.lps_mm(0.5 * glm::dvec3(scene.lattice.dims - 1));
    int compared = 0;
    for (const char* view : {"inferior", "anterior", "left", "30,20", "-110,-65"}) {
      const View seen = parse_view(view);
      const Sheet sheet = plane_sheet(scene.lattice, seen, glm::dot(middle_mm, seen.look), 0.7);
      const SheetSamples picture = sample(scene, sheet, Interpolation::Linear);
      for (int y = 0; y < sheet.height_px; ++y)
        for (int x = 0; x < sheet.size_px().x; ++x) {
          const glm::dvec3 p_mm = sheet.lps_mm(x, y);
          ASSERT_NEAR(glm::dot(p_mm - middle_mm, seen.look), 0.0, 1e-9);
          const glm::dvec3 p_voxel = scene.lattice.voxel(p_mm);
          // The outer half of border voxels repeats their centres.
          if (glm::any(glm::lessThan(p_voxel, glm::dvec3(0.0))) ||
              glm::any(glm::greaterThan(p_voxel, glm::dvec3(scene.lattice.dims - 1))))
            continue;
          const auto at = static_cast<std::size_t>(x + sheet.size_px().x * y);
          ASSERT_EQ(picture.inside[at], 1);
          // Floats of some hundreds are exact to 2^-15.
          ASSERT_NEAR(picture.image.values[at], tests::linear_field(p_mm), 2e-4) << view;
          ++compared;
        }
    }
    EXPECT_GT(compared, 5000);
  }
}

TEST(PlaneSheet, ShowsAllOfTheCutAndNoMoreThanAPixelBeyond) {
  const Scene scene = tests::linear_scene(tests::oblique_lattice());
  const View view = parse_view("40,25");
  const glm::dvec3 middle_mm = scene.lattice.lps_mm(0.5 * glm::dvec3(scene.lattice.dims - 1));
  const double position_mm = glm::dot(middle_mm, view.look);
  const Sheet sheet = plane_sheet(scene.lattice, view, position_mm, 0.5);
  const SheetSamples picture = sample(scene, sheet, Interpolation::Nearest);
  const glm::ivec2 size = sheet.size_px();
  const auto inside = [&](int x, int y) {
    return picture.inside[static_cast<std::size_t>(x + size.x * y)] != 0;
  };
  // Every edge of the picture touches the cut: in its first or, where the last pixel reaches beyond, second
  // row. A sharp corner may slip between pixels' centres; two rows of half a millimetre are enough here.
  bool left = false, right = false, top = false, bottom = false;
  for (int i = 0; i < 2; ++i) {
    for (int y = 0; y < size.y; ++y) left |= inside(i, y), right |= inside(size.x - 1 - i, y);
    for (int x = 0; x < size.x; ++x) top |= inside(x, i), bottom |= inside(x, size.y - 1 - i);
  }
  EXPECT_TRUE(left && right && top && bottom);
  // The area inside is that of the cut: volume = integral of area over position, by slices 0.25 mm apart.
  double volume_mm3 = 0.0;
  for (double offset = -40.0; offset < 40.0; offset += 0.25) try {
      const Sheet one = plane_sheet(scene.lattice, view, position_mm + offset, 0.5);
      const SheetSamples samples = sample(scene, one, Interpolation::Nearest);
      volume_mm3 +=
          0.25 * 0.25 * static_cast<double>(std::count(samples.inside.begin(), samples.inside.end(), 1));
    } catch (const std::invalid_argument&) {
      continue;  // beyond the scan
    }
  const double truth = scene.lattice.voxel_mm3() * static_cast<double>(scene.lattice.sample_count());
  EXPECT_NEAR(volume_mm3 / truth, 1.0, 0.005);
}

TEST(PlaneSheet, RefusesWhatCannotBeDrawn) {
  const Lattice lattice = head_lattice(1.0);
  const View axial = parse_view("inferior");
  EXPECT_NO_THROW(plane_sheet(lattice, axial, 19.5, 1.0));
  EXPECT_THROW(plane_sheet(lattice, axial, 20.5, 1.0), std::invalid_argument);
  EXPECT_THROW(plane_sheet(lattice, axial, NAN, 1.0), std::invalid_argument);
  EXPECT_THROW(plane_sheet(lattice, axial, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(plane_sheet(lattice, axial, 0.0, 0.001), std::invalid_argument);
}

TEST(CurvedSheet, UnrollsAnArcInTrueScale) {
  constexpr double radius_mm = 15.0;
  CurveOptions options;
  constexpr int steps = 400;
  for (int i = 0; i <= steps; ++i) {  // from the patient's right over the front to the left
    const double turn = std::numbers::pi * (1.0 + static_cast<double>(i) / steps);
    options.points_mm.emplace_back(radius_mm * std::cos(turn), radius_mm * std::sin(turn),
                                   i % 2 == 0 ? 3 : 5);
  }
  options.height_mm = 20.0;
  options.pixel_mm = 0.5;
  const Sheet sheet = curved_sheet(options);
  EXPECT_EQ(sheet.size_px(), glm::ivec2(static_cast<int>(std::ceil(std::numbers::pi * radius_mm / 0.5)), 40));
  for (int x = 0; x < sheet.size_px().x; ++x) {
    const double turn = std::numbers::pi + 0.5 * (x + 0.5) / radius_mm;
    // The points' middle height is 4; the top row's centre is 19 half pixels above.
    const glm::dvec3 truth(radius_mm * std::cos(turn), radius_mm * std::sin(turn), 4 + 0.25 * 39);
    // A polygon of 400 edges strays from its arc by 5e-4 mm in length and less across.
    ASSERT_LT(glm::distance(sheet.lps_mm(x, 0), truth), 2e-3) << x;
    ASSERT_NEAR(glm::distance(sheet.lps_mm(x, 0), sheet.lps_mm(x, 39)), 19.5, 1e-12);
    if (x == 0) continue;
    ASSERT_NEAR(glm::distance(sheet.lps_mm(x - 1, 7), sheet.lps_mm(x, 7)), 0.5, 1e-3);
  }
  const Scene scene = exact_scene(axis_aligned_lattice({41, 41, 41}, {1, 1, 1}, {-20, -20, -20}));
  const SheetSamples picture = sample(scene, sheet, Interpolation::Linear);
  for (int x = 0; x < sheet.size_px().x; ++x)
    ASSERT_NEAR(picture.image.values[static_cast<std::size_t>(x)], tests::linear_field(sheet.lps_mm(x, 0)),
                2e-4);
}

TEST(CurvedSheet, RefusesPointsThatSpanNoSheet) {
  CurveOptions options;
  EXPECT_THROW(curved_sheet(options), std::invalid_argument);
  options.points_mm = {{0, 0, 0}, {0, 0, 9}};  // above each other
  EXPECT_THROW(curved_sheet(options), std::invalid_argument);
  options.up = {0, 1, 0};
  EXPECT_NO_THROW(curved_sheet(options));
  options.up = {0, 0, 0};
  EXPECT_THROW(curved_sheet(options), std::invalid_argument);
  options.up = {0, 1, 0};
  options.height_mm = -1;
  EXPECT_THROW(curved_sheet(options), std::invalid_argument);
  options.height_mm = 10;
  options.points_mm[0].x = NAN;
  EXPECT_THROW(curved_sheet(options), std::invalid_argument);
}

TEST(CurvedSheet, NamesTheLengthsOfAPictureThatIsTooLarge) {
  CurveOptions options;
  options.points_mm = {{0, 0, 0}, {5, 0, 0}};
  options.pixel_mm = 0.001;
  try {
    curved_sheet(options);
    FAIL() << "was made";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "a picture of 60 mm takes more than 8192 pixels of 0.001 mm: choose larger pixels");
  }
}

TEST(CurvedSheet, PointsWhoseDistanceOverflowsAreRefused) {
  CurveOptions options;
  options.points_mm = {{0, 0, 0}, {1e308, 0, 0}};
  options.height_mm = 10;
  EXPECT_THROW(curved_sheet(options), std::invalid_argument);
}

TEST(SheetSamples, OfAScanAndOfItsGreyOctreeAreTheSame) {
  const Scene scene = tests::linear_scene(axis_aligned_lattice({32, 32, 32}, {1, 1, 1}, {-15, -16, -17}));
  const Universe universe{5, scene.lattice.lps_from_voxel};
  const GreyOctree grey = grey_octree_of(universe, scene);
  const View view = parse_view("35,20");
  const Sheet sheet = plane_sheet(scene.lattice, view, 0.0, 0.6);
  for (const Interpolation interpolation :
       {Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic}) {
    const SheetSamples a = sample(scene, sheet, interpolation);
    const SheetSamples b = sample(grey, sheet, interpolation);
    EXPECT_EQ(a.inside, b.inside);
    int compared = 0;
    for (int y = 0; y < sheet.height_px; ++y)
      for (int x = 0; x < sheet.size_px().x; ++x) {
        const glm::dvec3 p = scene.lattice.voxel(sheet.lps_mm(x, y));
        if (glm::any(glm::lessThan(p, glm::dvec3(1.0))) || glm::any(glm::greaterThan(p, glm::dvec3(30.0))))
          continue;  // beyond the border one repeats it, the other has its background
        const auto at = static_cast<std::size_t>(x + sheet.size_px().x * y);
        ASSERT_FLOAT_EQ(a.image.values[at], b.image.values[at]);
        ++compared;
      }
    EXPECT_GT(compared, 1000);
  }
}

TEST(SheetSamples, AreTheSameOnOneThreadAndOnTwoAndStopWhenAsked) {
  const Scene scene = tests::linear_scene(tests::oblique_lattice());
  const Sheet sheet = plane_sheet(scene.lattice, parse_view("10,10"), 0.0, 0.5);
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return sample(scene, sheet, Interpolation::Cubic).image.values;
  };
  EXPECT_EQ(on(1), on(2));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(sample(scene, sheet, Interpolation::Linear, {stop.get_token(), {}}), Stopped);
}

TEST(ObjectOnASlice, OfABallIsADiscAndItsOutlineACircle) {
  const Universe universe = universe_around({glm::dvec3(-32), glm::dvec3(32)}, 0.5);
  constexpr double radius_mm = 20.0;
  const glm::dvec3 centre(1, 2, 3.25);  // a slice of voxels' centres, as the one 12 mm above
  const Octree ball = combine(universe, Sphere{centre, radius_mm});
  for (const char* view : {"inferior", "25,40"}) {
    const View seen = parse_view(view);
    const double centre_mm = glm::dot(centre, seen.look);
    for (const double off_mm : {0.0, 12.0}) {
      const Sheet sheet = plane_sheet(universe.lattice(), seen, centre_mm + off_mm, 0.25);
      const std::vector<std::uint8_t> inside = cut(ball, sheet);
      const double disc_mm2 = std::numbers::pi * (radius_mm * radius_mm - off_mm * off_mm);
      const auto pixels = static_cast<double>(std::count(inside.begin(), inside.end(), 1));
      // A disc's boundary voxels, half in and half out, leave less than half a per cent.
      EXPECT_NEAR(pixels * 0.0625 / disc_mm2, 1.0, 0.02) << view << ' ' << off_mm;
      const std::vector<std::uint8_t> edge = outline(inside, sheet.size_px());
      for (std::size_t i = 0; i < edge.size(); ++i) {
        if (edge[i] == 0) continue;
        ASSERT_EQ(inside[i], 1);
        const auto width = static_cast<std::size_t>(sheet.size_px().x);
        const glm::dvec3 p = sheet.lps_mm(static_cast<int>(i % width), static_cast<int>(i / width));
        // Within a voxel's diagonal and a pixel of the sphere.
        ASSERT_NEAR(glm::distance(p, centre), radius_mm, 0.5 * 1.8 + 0.25);
      }
      EXPECT_GT(std::count(edge.begin(), edge.end(), 1), 400);
    }
  }
}

TEST(Outline, IsOnePixelWideAndNotAtThePicturesEdge) {
  // A bar that leaves the picture on the left.
  const glm::ivec2 size(6, 5);
  std::vector<std::uint8_t> bar(30, 0);
  for (std::size_t y = 1; y < 4; ++y)
    for (std::size_t x = 0; x < 4; ++x) bar[x + 6 * y] = 1;
  const std::vector<std::uint8_t> edge = outline(bar, size);
  const std::vector<std::uint8_t> truth{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0,
                                        1, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(edge, truth);
  EXPECT_THROW(outline(bar, {5, 5}), std::invalid_argument);
}

std::string around(const Sheet& sheet) {
  const EdgeLetters letters = edge_letters(sheet);
  return letters.left + " " + letters.right + " " + letters.top + " " + letters.bottom;
}

TEST(EdgeLetters, AreThoseOfRadiologicalSlices) {
  const auto of = [](const char* view) {
    return around(plane_sheet(head_lattice(1.0), parse_view(view), 0.0, 1.0));
  };
  EXPECT_EQ(of("inferior"), "R L A P");
  EXPECT_EQ(of("anterior"), "R L S I");
  EXPECT_EQ(of("left"), "A P S I");
  EXPECT_EQ(of("posterior"), "L R S I");  // the spoiled twin: seen from behind
}

TEST(EdgeLetters, OfADentalArchTellRightFromLeft) {
  CurveOptions arch;
  arch.points_mm = {{-20, 20, 0}, {-18, -5, 0}, {0, -20, 0}, {18, -5, 0}, {20, 20, 0}};
  EXPECT_EQ(around(curved_sheet(arch)), "PR PL S I");
}

}  // namespace
}  // namespace octotomy::voxel
