// SPDX-License-Identifier: AGPL-3.0-or-later
// One picture of every algorithm and shading, reviewed by eye. A picture that is meant to
// change is written anew by OCTOTOMY_GOLDEN_OUT=tests/golden/render image_tests --gtest_filter='Golden*', and
// looked at.
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <memory>

#include "tests/voxel/all_samples.h"
#include "tests/voxel/field_scene.h"
#include "voxel/scan/image_file.h"
#include "voxel/solid/combine.h"
#include "voxel/view/annotation.h"
#include "voxel/view/composite.h"
#include "voxel/view/lab.h"
#include "voxel/view/radiograph.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {
namespace {

constexpr int side_px = 120;
using Pixels = std::vector<std::uint8_t>;

/// A simple head with the symmetry of heads only: a shell with two orbits, a jaw, and a mark at the
/// patient's left temple. Bone 1000, inside 40, air -1000.
GreyOctree head() {
  const Universe universe = universe_around({glm::dvec3(-40.0), glm::dvec3(40.0)}, 1.25);
  const auto ball = [](const glm::dvec3& p, const glm::dvec3& centre, const glm::dvec3& radii) {
    const double least = std::min({radii.x, radii.y, radii.z});
    return (glm::length((p - centre) / radii) - 1.0) * least;
  };
  const auto sample = [&](const glm::dvec3& p) {
    const double outside = ball(p, {0, 4, 8}, {24, 29, 25});
    double bone = std::max(outside, -ball(p, {0, 4, 8}, {20, 25, 21}));
    bone =
        std::min(bone, std::max(ball(p, {0, -14, -20}, {15, 12, 12}), -ball(p, {0, -10, -14}, {11, 12, 10})));
    for (const double side : {-1.0, 1.0}) bone = std::max(bone, -ball(p, {side * 9.0, -25, 3}, {6, 9, 5}));
    bone = std::min(bone, ball(p, {24, 0, 12}, {5, 4, 4}));
    const double flesh = outside < 0.0 ? 40.0 : -1000.0;
    const double share = std::clamp(0.5 - bone / 1.25, 0.0, 1.0);
    return flesh + share * (1000.0 - flesh);
  };
  return grey_octree_of(universe, tests::field_scene<std::int16_t>(universe.lattice(), sample));
}

DrawnObject skull(const GreyOctree& grey) {
  DrawnObject object{"skull", combine(grey.universe(), Expression(Window{grey, 400.0}))};
  object.grey = grey;
  object.threshold = 400.0;
  return object;
}

/// The subjects of pictures, built once.
struct Subjects {
  GreyOctree grey = head();
  DrawnObject bone = skull(grey);
  static const Subjects& all() {
    static const Subjects subjects;
    return subjects;
  }
};

RenderOptions options_for(const std::string& view) {
  RenderOptions options;
  options.view = parse_view(view);
  options.size_px = glm::ivec2(side_px);
  options.centre_mm = glm::dvec2(0.0);
  options.width_mm = 76.0;
  return options;
}

struct Case {
  std::string name;
  std::string view = "35,15";
  std::optional<Algorithm> algorithm{};
  Shading shading = Shading::PartialVolume;
  std::string kind = "surface";
};

const std::vector<Case> cases{
    {"node_trace", "anterior", Algorithm::NodeTrace},
    {"ray_cast", "35,15", Algorithm::RayCast},
    {"front_to_back", "-40,20", Algorithm::FrontToBack},
    {"back_to_front", "left", Algorithm::BackToFront},
    {"depth", "35,15", {}, Shading::Depth},
    {"gradient", "35,15", {}, Shading::Gradient},
    {"context", "35,15", {}, Shading::Context},
    {"grey_gradient", "35,15", {}, Shading::GreyGradient},
    {"silhouette", "35,15", {}, Shading::Silhouette},
    {"outline", "35,15", {}, Shading::Outline},
    {"cut_grey", "35,15", {}, Shading::PartialVolume, "cut"},
    {"translucent", "35,15", {}, Shading::PartialVolume, "translucent"},
    {"scalar", "35,15", {}, Shading::PartialVolume, "scalar"},
    {"annotated", "posterior", {}, Shading::PartialVolume, "annotated"},
    {"mip", "anterior", {}, Shading::PartialVolume, "mip"},
    {"radiograph", "left", {}, Shading::PartialVolume, "radiograph"},
    {"composite", "35,15", {}, Shading::PartialVolume, "composite"},
};

Pixels draw(const Case& picture) {
  const Subjects& subjects = Subjects::all();
  RenderOptions options = options_for(picture.view);
  options.algorithm = picture.algorithm;
  options.shading = picture.shading;
  std::vector<DrawnObject> objects{subjects.bone};
  const ImagePlane plane = image_plane(subjects.grey.universe(), options.view, options.size_px,
                                       {*options.centre_mm, *options.width_mm});
  if (picture.kind == "mip") return grey_tones(maximum_intensity(subjects.grey, plane), -1000.0, 1000.0);
  if (picture.kind == "radiograph") return grey_tones(radiograph(subjects.grey, plane), 0.0, 2.0);
  if (picture.kind == "composite")
    return over(composite(subjects.grey, plane, {preset_transfer("skin"), {}, {}}), glm::vec3(1.0f));
  if (picture.kind == "cut") {
    options.cuts = {HalfSpace{glm::normalize(glm::dvec3(1.0, -0.4, 0.3)), 6.0}};
    options.cut_tones = CutTones{tests::all_samples(subjects.grey), -200.0, 1000.0};
  }
  if (picture.kind == "translucent") {
    objects.front().opacity = 0.45f;
    objects.push_back({"core",
                       combine(subjects.grey.universe(), Expression(Sphere{{4, 0, 8}, 12.0})),
                       {0.2f, 0.56f, 0.72f}});
  }
  if (picture.kind == "scalar") {
    const Octree other = combine(subjects.grey.universe(), Expression(Sphere{{0, 2, 6}, 25.0}));
    objects.front().scalar =
        std::make_shared<const SurfaceScalar>(distance_to(other, subjects.bone.octree, 6.0));
  }
  Picture drawn = render(objects, options);
  if (picture.kind == "annotated")
    annotate(drawn.rgb, drawn.plane(), {"head", true, {}, true, {{"bone", objects[0].colour}}, {}});
  return drawn.rgb;
}

std::filesystem::path golden_folder() {
  return std::filesystem::path(OCTOTOMY_SOURCE_DIR) / "tests/golden/render";
}

Pixels read_golden(const std::string& name) {
  const std::filesystem::path path = golden_folder() / (name + ".png");
  const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path.string());
  if (!in) throw std::runtime_error(path.string() + ": " + OIIO::geterror());
  Pixels pixels(3 * side_px * side_px);
  if (in->spec().width != side_px || in->spec().height != side_px || in->spec().nchannels != 3 ||
      !in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, pixels.data()))
    throw std::runtime_error(path.string() + ": is no picture of these tests");
  return pixels;
}

/// The visible difference of two pictures: distances in CIE Lab, in which 1 is just noticeable, between means
/// of two by two pixels, so that one pixel along an edge adds little.
struct Difference {
  double mean = 0.0;
  double worst_tile = 0.0;  ///< mean over 12 by 12 pixels
};
Difference difference(const Pixels& a, const Pixels& b) {
  constexpr int cells = side_px / 2, tile = 6;
  const auto lab = [](const Pixels& pixels, int i, int j) {
    glm::vec3 sum(0.0f);
    for (int y = 2 * j; y < 2 * j + 2; ++y)
      for (int x = 2 * i; x < 2 * i + 2; ++x)
        for (int channel = 0; channel < 3; ++channel)
          sum[channel] +=
              static_cast<float>(pixels[static_cast<std::size_t>(3 * (y * side_px + x) + channel)]);
    return lab_from_srgb(sum / (4.0f * 255.0f));
  };
  Difference found;
  for (int tile_y = 0; tile_y < cells; tile_y += tile)
    for (int tile_x = 0; tile_x < cells; tile_x += tile) {
      double sum = 0.0;
      for (int j = tile_y; j < tile_y + tile; ++j)
        for (int i = tile_x; i < tile_x + tile; ++i) sum += glm::distance(lab(a, i, j), lab(b, i, j));
      found.mean += sum / (cells * cells);
      found.worst_tile = std::max(found.worst_tile, sum / (tile * tile));
    }
  return found;
}

/// No noticeable difference on average, and no tile that looks different.
bool looks_the_same(const Difference& found) {
  return found.mean < 0.25 && found.worst_tile < 2.5;
}

class Golden : public testing::TestWithParam<Case> {};

TEST_P(Golden, LooksAsItDid) {
  const Pixels drawn = draw(GetParam());
  const std::string file = GetParam().name + ".png";
  if (const char* out = std::getenv("OCTOTOMY_GOLDEN_OUT"))
    write_image(std::filesystem::path(out) / file, glm::ivec2(side_px), drawn);
  const Difference found = difference(drawn, read_golden(GetParam().name));
  if (looks_the_same(found)) return;
  const std::filesystem::path actual =
      std::filesystem::path(testing::TempDir()) / ("octotomy_golden_" + file);
  write_image(actual, glm::ivec2(side_px), drawn);
  ADD_FAILURE() << file << " differs by " << found.mean << " in the mean, " << found.worst_tile
                << " in the worst tile; it is now " << actual;
}

INSTANTIATE_TEST_SUITE_P(Pictures, Golden, testing::ValuesIn(cases),
                         [](const auto& one) { return one.param.name; });

TEST(GoldenPictures, AreAllOfThoseInTheFolder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(golden_folder()))
    files += entry.path().extension() == ".png";
  EXPECT_EQ(files, cases.size());
}

TEST(GoldenPictures, SpoiledOnesAreToldFromTheirs) {
  const Pixels golden = read_golden("ray_cast");
  const auto at = [](int x, int y) { return static_cast<std::size_t>(3 * (y * side_px + x)); };
  Pixels mirrored = golden, shifted = golden, holed = golden, tinted = golden;
  for (int y = 0; y < side_px; ++y)
    for (int x = 0; x < side_px; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        mirrored[at(x, y) + channel] = golden[at(side_px - 1 - x, y) + channel];
        shifted[at(x, y) + channel] = golden[at(std::max(0, x - 2), y) + channel];
        if (x >= 60 && x < 66 && y >= 50 && y < 56) holed[at(x, y) + channel] = 255;
      }
  for (std::size_t i = 2; i < tinted.size(); i += 3) tinted[i] = static_cast<std::uint8_t>(tinted[i] * 0.97);
  EXPECT_TRUE(looks_the_same(difference(golden, golden)));
  EXPECT_FALSE(looks_the_same(difference(golden, mirrored)));
  EXPECT_FALSE(looks_the_same(difference(golden, shifted)));
  EXPECT_FALSE(looks_the_same(difference(golden, holed)));
  EXPECT_FALSE(looks_the_same(difference(golden, tinted)));
  // Noise of one grey level is no difference.
  Pixels noisy = golden;
  for (std::size_t i = 0; i < noisy.size(); i += 7) noisy[i] = static_cast<std::uint8_t>(noisy[i] ^ 1);
  EXPECT_TRUE(looks_the_same(difference(golden, noisy)));
}

TEST(GoldenPictures, AnotherShadingOrLightIsAnotherPicture) {
  Case picture = cases[1];
  const Pixels golden = read_golden(picture.name);
  picture.shading = Shading::Context;
  EXPECT_FALSE(looks_the_same(difference(draw(picture), golden)));
  picture.shading = Shading::PartialVolume;
  picture.view = "36.5,15";
  EXPECT_FALSE(looks_the_same(difference(draw(picture), golden)));
}

}  // namespace
}  // namespace octotomy::voxel
