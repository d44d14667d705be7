// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/render.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/voxel/dense.h"
#include "tests/voxel/field_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;

/// 64 voxels of 2 mm about the origin, so that the sides of the patient are the signs of LPS.
Universe universe_of_128_mm() {
  return universe_around({glm::dvec3(-64.0), glm::dvec3(64.0)}, 2.0);
}

/// A block of 4 voxels a side whose corner is at a voxel.
Octree block_at(const glm::ivec3& corner) {
  Dense dense(64);
  dense.for_each([&](const glm::ivec3& v) {
    const glm::ivec3 from = v - corner;
    dense.at(v) =
        glm::all(glm::greaterThanEqual(from, glm::ivec3(0))) && glm::all(glm::lessThan(from, glm::ivec3(4)));
  });
  return tests::octree_of(universe_of_128_mm(), dense);
}

RenderOptions whole_universe(const std::string& view, int size_px = 64) {
  RenderOptions options;
  options.view = parse_view(view);
  options.size_px = glm::ivec2(size_px);
  options.centre_mm = glm::dvec2(0.0);
  options.width_mm = 128.0;
  return options;
}

/// Mean position of lit pixels from the middle, as shares of the picture, right and up positive.
glm::dvec2 middle_of_lit(const Picture& picture) {
  glm::dvec2 sum(0.0);
  for (int y = 0; y < picture.size_px.y; ++y)
    for (int x = 0; x < picture.size_px.x; ++x)
      if (picture.object[static_cast<std::size_t>(y * picture.size_px.x + x)] >= 0)
        sum += glm::dvec2(x + 0.5, y + 0.5) / glm::dvec2(picture.size_px) - 0.5;
  sum /= static_cast<double>(picture.lit_pixels);
  return {sum.x, -sum.y};
}

float least_depth_mm(const Picture& picture) {
  return *std::min_element(picture.depth_mm.begin(), picture.depth_mm.end());
}

/// The place, by the table of views, of a block at the patient's left, back and head.
struct Convention {
  const char* view;
  double right;  ///< sign of the block's place in the picture
  double up;
  double depth_mm;  ///< of the block's nearest face
};

class Conventions : public testing::TestWithParam<Algorithm> {};

TEST_P(Conventions, ABlockAtThePatientsLeftBackAndHeadStandsWhereTheContractsTableOfViewsPutsIt) {
  // The block reaches from 40 to 48 mm to the left, 24 to 32 mm to the back and 8 to 16 mm to the head; the
  // universe from -64 to 64 mm.
  const Octree block = block_at({52, 44, 36});
  const std::array<Convention, 6> table{{
      {"anterior", 44.0, 12.0, 64.0 + 24.0},
      {"posterior", -44.0, 12.0, 64.0 - 32.0},
      {"left", 28.0, 12.0, 64.0 - 48.0},
      {"right", -28.0, 12.0, 64.0 + 40.0},
      {"superior", -44.0, -28.0, 64.0 - 16.0},
      {"inferior", 44.0, -28.0, 64.0 + 8.0},
  }};
  for (const Convention& convention : table) {
    RenderOptions options = whole_universe(convention.view);
    options.algorithm = GetParam();
    const Picture picture = render({{"block", block}}, options);
    EXPECT_EQ(picture.algorithm, GetParam());
    EXPECT_EQ(picture.lit_pixels, 16u) << convention.view;
    const glm::dvec2 middle_mm = middle_of_lit(picture) * 128.0;
    EXPECT_NEAR(middle_mm.x, convention.right, 1e-9) << convention.view;
    EXPECT_NEAR(middle_mm.y, convention.up, 1e-9) << convention.view;
    EXPECT_NEAR(least_depth_mm(picture), convention.depth_mm, 1e-4) << convention.view;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, Conventions, testing::Values(Algorithm::NodeTrace, Algorithm::RayCast));

TEST(Render, AzimuthTurnsTheObserverToThePatientsLeftAndElevationRaisesHim) {
  // From 90 degrees of azimuth the view is "left"; halfway there a block at the patient's left comes nearer.
  const Octree left = block_at({58, 30, 30});
  const Octree top = block_at({30, 30, 58});
  const auto depth_mm = [](const Octree& block, const char* view) {
    const Picture picture = render({{"block", block}}, whole_universe(view));
    // Depth from the universe's middle, whose depth is the half of the bounding box's extent along look.
    const glm::dvec3 look = glm::abs(parse_view(view).look);
    return least_depth_mm(picture) - 64.0 * (look.x + look.y + look.z);
  };
  EXPECT_LT(depth_mm(left, "45,0"), depth_mm(left, "0,0") - 20.0);
  EXPECT_GT(depth_mm(left, "-45,0"), depth_mm(left, "0,0") + 20.0);
  EXPECT_LT(depth_mm(top, "0,45"), depth_mm(top, "0,0") - 20.0);
  EXPECT_GT(depth_mm(top, "0,-45"), depth_mm(top, "0,0") + 20.0);
  const Picture named = render({{"block", left}}, whole_universe("left"));
  RenderOptions options = whole_universe("90,0");
  options.algorithm = Algorithm::RayCast;
  const Picture turned = render({{"block", left}}, options);
  EXPECT_EQ(named.object, turned.object);
}

TEST(Render, ByDefaultThePictureIsTheSquareAboutTheObjectsATwentiethWider) {
  RenderOptions options;
  options.view = parse_view("anterior");
  options.size_px = {210, 420};
  const Picture picture = render({{"one", block_at({10, 30, 20})}, {"two", block_at({30, 30, 24})}}, options);
  // From voxel 10 to 33, 48 mm; the narrower side of the picture shows it.
  EXPECT_NEAR(picture.pixel_mm * 210.0, 48.0 * 1.05, 1e-9);
  EXPECT_NEAR(picture.centre_mm.x, -64.0 + 2.0 * (10 + 12), 1e-9);
  EXPECT_NEAR(picture.centre_mm.y, -64.0 + 2.0 * (20 + 4), 1e-9);
  EXPECT_NEAR(middle_of_lit(picture).x, 0.0, 0.01);
}

TEST(Render, APixelLooksThroughItsCentreWhateverItsSize) {
  // 7 pixels of 128/7 mm: centres at multiples of 18.2857 mm; the block from 40 to 48 mm holds none, the
  // one from 32 to 40 mm holds 36.57.
  RenderOptions options = whole_universe("anterior", 7);
  EXPECT_EQ(render({{"block", block_at({52, 30, 30})}}, options).lit_pixels, 0u);
  EXPECT_EQ(render({{"block", block_at({48, 30, 30})}}, options).lit_pixels, 1u);
  EXPECT_EQ(render({{"block", block_at({48, 30, 30})}}, whole_universe("anterior", 640)).lit_pixels, 1600u);
}

TEST(Render, BothAlgorithmsAgreeOnPartialVolumePicturesOfABall) {
  const Universe universe = universe_of_128_mm();
  const Scene scene = tests::field_scene<std::int16_t>(
      universe.lattice(), [](const glm::dvec3& p_mm) { return 100.0 * (45.0 - glm::length(p_mm)); });
  const DrawnObject ball{
      "ball", octree_of_window(universe, scene, 0, 32767), {}, grey_octree_of(universe, scene), 0.0};
  RenderOptions options = whole_universe("left");
  const Picture traced = render({ball}, options);
  options.algorithm = Algorithm::RayCast;
  const Picture cast = render({ball}, options);
  EXPECT_EQ(traced.object, cast.object);
  EXPECT_EQ(traced.lit_pixels, cast.lit_pixels);
  EXPECT_GT(traced.lit_pixels, 1000u);
  for (std::size_t i = 0; i < traced.depth_mm.size(); ++i)
    if (traced.object[i] >= 0) {
      // Both interpolate linearly between the same two samples.
      ASSERT_NEAR(traced.depth_mm[i], cast.depth_mm[i], 1e-3) << "pixel " << i;
    }
}

TEST(Render, AntialiasingBlendsOnlyTheColoursOfEdges) {
  RenderOptions options = whole_universe("30,20", 128);
  const std::vector<DrawnObject> objects{{"block", block_at({30, 30, 30})}};
  options.antialias = false;
  const Picture plain = render(objects, options);
  options.antialias = true;
  const Picture smooth = render(objects, options);
  EXPECT_EQ(plain.depth_mm, smooth.depth_mm);
  EXPECT_EQ(plain.object, smooth.object);
  EXPECT_EQ(plain.lit_pixels, smooth.lit_pixels);
  std::size_t changed_background = 0;
  for (std::size_t i = 0; i < plain.object.size(); ++i)
    changed_background += plain.object[i] < 0 && plain.rgb[3 * i] != smooth.rgb[3 * i];
  EXPECT_GT(changed_background, 0u);
}

TEST(Render, PicturesAreTheSameOnOneThreadAndOnTwo) {
  const std::vector<DrawnObject> objects{
      {"one", tests::octree_of(universe_of_128_mm(), tests::random_dense(64, 12))},
      {"two", tests::octree_of(universe_of_128_mm(), tests::random_dense(64, 13)), {0.8f, 0.3f, 0.2f}}};
  for (const char* view : {"superior", "33,21"}) {
    std::vector<Picture> pictures;
    for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      pictures.push_back(render(objects, whole_universe(view, 100)));
    }
    EXPECT_GT(pictures[0].lit_pixels, 100u);
    EXPECT_EQ(pictures[0].rgb, pictures[1].rgb);
    EXPECT_EQ(pictures[0].depth_mm, pictures[1].depth_mm);
    EXPECT_EQ(pictures[0].object, pictures[1].object);
  }
}

TEST(Render, AnEmptyObjectGivesABackgroundPicture) {
  RenderOptions options;
  options.view = parse_view("15,15");
  options.size_px = {20, 10};
  const Picture picture = render({{"nothing", Octree::empty(universe_of_128_mm())}}, options);
  EXPECT_EQ(picture.lit_pixels, 0u);
  EXPECT_EQ(picture.rgb, std::vector<std::uint8_t>(600, 255));
}

TEST(Render, DrawsAnExpressionThatIsNotBuiltAsItsOctreeHoweverItIsAsked) {
  const Universe universe = universe_of_128_mm();
  const Expression ball(combine(universe, Expression(Sphere{{0, 0, 0}, 40.0})));
  DrawnObject cut{"cut", Octree::empty(universe)};
  cut.unbuilt = moved(ball - Expression(Box{{-10, -64, -10}, {30, 0, 64}}),
                      moved_from_still({{4, 0, 0}, 8.0, {0, 0, 1}, {0, 0, 0}}));
  const DrawnObject octree = built({cut}).front();
  ASSERT_FALSE(octree.octree.is_empty());
  std::vector<RenderOptions> asked(6, whole_universe("anterior"));
  asked[0].centre_mm.reset();
  asked[1].algorithm = Algorithm::RayCast;
  asked[2].algorithm = Algorithm::FrontToBack;
  asked[3].shading = Shading::Context;
  asked[4].count = true;
  asked[5].cuts = {HalfSpace{glm::normalize(glm::dvec3(1.0, 0.5, 0.0)), 12.0}};
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const Picture seen = render({cut}, asked[i]), wanted = render({octree}, asked[i]);
    EXPECT_GT(wanted.lit_pixels, 500u) << i;
    EXPECT_EQ(seen.rgb, wanted.rgb) << i;
    EXPECT_EQ(seen.depth_mm, wanted.depth_mm) << i;
  }
}

TEST(Render, RefusesWhatItCannotDraw) {
  const Octree block = block_at({30, 30, 30});
  EXPECT_THROW(render({}, whole_universe("left")), std::invalid_argument);
  EXPECT_THROW(render({{"a", block}, {"b", Octree::empty(Universe())}}, whole_universe("left")),
               std::invalid_argument);
  RenderOptions options = whole_universe("left");
  options.size_px = {0, 5};
  EXPECT_THROW(render({{"a", block}}, options), std::invalid_argument);
  options = whole_universe("left");
  options.width_mm = -1.0;
  EXPECT_THROW(render({{"a", block}}, options), std::invalid_argument);
  options = whole_universe("left");
  options.shading = Shading::Density;  // without samples
  EXPECT_THROW(render({{"a", block}}, options), std::invalid_argument);
}

/// Two plates across the view, in front of each other: samples of 250 at the patient's right, of 800 behind
/// at the left.
DrawnObject two_plates() {
  const Universe universe = universe_of_128_mm();
  const GreyOctree grey =
      grey_octree_of(universe, tests::field_scene<std::int16_t>(universe.lattice(), [](const glm::dvec3& p) {
                       if (p.x < 0.0) return p.y > -10.0 && p.y < 0.0 ? 250.0 : -1000.0;
                       return p.y > 30.0 && p.y < 40.0 ? 800.0 : -1000.0;
                     }));
  const Octree octree = combine(universe, Expression(Window{grey, 0.0, 32767.0}));
  return {"plates", octree, glm::vec3(0.5f), grey, 0.0};
}

RenderOptions by_density(const DrawnObject& object, Shading shading) {
  RenderOptions options = whole_universe("anterior");
  options.shading = shading;
  options.antialias = options.occlusion = false;
  options.densities = Densities{
      {GreyOwners(object.octree.universe(), {{all_samples(*object.grey), object.octree}}), 0.0, 1000.0}, {}};
  return options;
}

glm::ivec3 rgb_at(const Picture& picture, int x, int y) {
  const std::size_t i = 3 * static_cast<std::size_t>(y * picture.size_px.x + x);
  return {picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]};
}

TEST(Render, ByDensityAPixelHasTheToneOfItsVoxelDimmedWithDepthOrTheColourOfItsRange) {
  const DrawnObject plates = two_plates();
  for (const Algorithm algorithm : {Algorithm::NodeTrace, Algorithm::RayCast}) {
    RenderOptions options = by_density(plates, Shading::Density);
    options.algorithm = algorithm;
    const Picture toned = render({plates}, options);
    // In the near plate all of the light, in the far one a tenth.
    EXPECT_EQ(rgb_at(toned, 16, 30), glm::ivec3(64));
    const auto linear = [](double srgb) { return std::pow((srgb + 0.055) / 1.055, 2.4); };
    const double far = 1.055 * std::pow(0.1 * linear(0.8), 1.0 / 2.4) - 0.055;
    EXPECT_NEAR(rgb_at(toned, 48, 30).x, 255.0 * far, 1.0);
    options.densities->colours = {{200.0, 300.0, {1.0f, 0.0f, 0.0f}}, {0.0, 5000.0, {0.0f, 0.0f, 1.0f}}};
    const Picture coloured = render({plates}, options);
    EXPECT_EQ(rgb_at(coloured, 16, 30), glm::ivec3(255, 0, 0));
    EXPECT_EQ(rgb_at(coloured, 48, 30).x, 0);
    EXPECT_GT(rgb_at(coloured, 48, 30).z, 50);
  }
}

TEST(Render, ColoursOfRangesAreLitAndOtherVoxelsKeepTheObjectsColour) {
  const DrawnObject plates = two_plates();
  RenderOptions options = by_density(plates, Shading::PartialVolume);
  options.lights = {Light{{0.0f, 0.0f, -1.0f}, 1.0f}};
  options.ambient = options.gloss = 0.0f;
  options.densities->colours = {{200.0, 300.0, {1.0f, 0.0f, 0.0f}}};
  const Picture picture = render({plates}, options);
  EXPECT_EQ(rgb_at(picture, 16, 30), glm::ivec3(rgb_at(picture, 16, 30).x, 0, 0));
  EXPECT_GT(rgb_at(picture, 16, 30).x, 200);
  const glm::ivec3 grey = rgb_at(picture, 48, 30);
  EXPECT_EQ(grey, glm::ivec3(grey.x));
  // Half of the diffuse share leaves half of the linear light.
  options.lights.front().strength = 0.5f;
  const auto linear = [](int srgb) { return std::pow((srgb / 255.0 + 0.055) / 1.055, 2.4); };
  EXPECT_NEAR(linear(rgb_at(render({plates}, options), 48, 30).x) / linear(grey.x), 0.5, 0.02);
}

TEST(Render, NodeTracingInAGeneralViewShowsThePictureOfFrontToBack) {
  const Octree block = block_at({30, 30, 30});
  for (const char* view : {"10,0", "45,35.264389682754654", "-120,-70"}) {
    RenderOptions options = whole_universe(view);
    options.algorithm = Algorithm::NodeTrace;
    const Picture traced = render({{"a", block}}, options);
    options.algorithm = Algorithm::FrontToBack;
    const Picture walked = render({{"a", block}}, options);
    EXPECT_EQ(traced.algorithm, Algorithm::NodeTrace);
    EXPECT_GT(traced.lit_pixels, 10u) << view;
    EXPECT_EQ(traced.rgb, walked.rgb) << view;
    EXPECT_EQ(traced.depth_mm, walked.depth_mm) << view;
  }
}

/// Mean and largest distance of picked points from a sphere of shares, outside of it positive, in voxels, where
/// the sight meets it at less than 50 degrees.
std::pair<double, double> surface_error_voxels(const std::string& view, Algorithm algorithm) {
  const Universe universe = universe_of_128_mm();
  const glm::dvec3 centre_mm(0.7, -0.4, 0.3);
  constexpr double radius_mm = 48.3, voxel_mm = 2.0;
  const PartialOctree partial = digitise_partial(universe, Expression(Sphere{centre_mm, radius_mm}));
  DrawnObject ball{"ball", at_least_half(partial)};
  ball.grey = share_samples(partial);
  ball.threshold = half_share;
  RenderOptions options = whole_universe(view, 200);
  options.algorithm = algorithm;
  const Picture picture = render({ball}, options);
  double sum = 0.0, largest = 0.0;
  int count = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const auto point_mm = picture.point_mm({x, y});
      if (!point_mm) continue;
      const glm::dvec3 from_centre_mm = *point_mm - centre_mm;
      const double ahead_mm = glm::dot(from_centre_mm, options.view.look);
      const double aside_mm = glm::length(from_centre_mm - ahead_mm * options.view.look);
      if (aside_mm > 0.766 * radius_mm) continue;
      const double error = (glm::length(from_centre_mm) - radius_mm) / voxel_mm;
      sum += error;
      largest = std::max(largest, std::abs(error));
      ++count;
    }
  EXPECT_GT(count, 8000);
  return {sum / count, largest};
}

TEST(Render, SharesOfASphereShowItsSurfaceToATwentiethOfAVoxelInTheMean) {
  for (const auto& [view, algorithm] :
       {std::pair("anterior", Algorithm::NodeTrace), std::pair("superior", Algorithm::NodeTrace),
        std::pair("anterior", Algorithm::RayCast), std::pair("30,20", Algorithm::RayCast),
        std::pair("30,20", Algorithm::FrontToBack)}) {
    const auto [mean, largest] = surface_error_voxels(view, algorithm);
    EXPECT_LT(std::abs(mean), 0.05) << view;
    EXPECT_LT(largest, 0.65) << view;
  }
}

}  // namespace
}  // namespace octotomy::voxel
