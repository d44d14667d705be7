// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Scans without a patient frame, from images and raw files; and NIfTI-2, which has one.
#include <OpenImageIO/imageio.h>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <zlib.h>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::ScratchFolder;
using tests::verdict;

const glm::ivec3 dims(7, 5, 12);

std::int16_t ramp(int x, int y, int z) {
  return static_cast<std::int16_t>(100 * z - 20 * y + 3 * x - 500);
}

template <typename Sample>
std::vector<Sample> page(int z, int offset) {
  std::vector<Sample> samples;
  for (int y = 0; y < dims.y; ++y)
    for (int x = 0; x < dims.x; ++x) samples.push_back(static_cast<Sample>(ramp(x, y, z) + offset));
  return samples;
}

template <typename Sample>
void write_page(const fs::path& path, OIIO::TypeDesc type, int z, int offset) {
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out && out->open(path.string(), OIIO::ImageSpec(dims.x, dims.y, 1, type)));
  const std::vector<Sample> samples = page<Sample>(z, offset);
  ASSERT_TRUE(out->write_image(type, samples.data()) && out->close());
}

ReadOptions spaced() {
  ReadOptions options;
  options.spacing_mm = glm::dvec3(0.5, 0.75, 1.25);
  return options;
}

void expect_ramp(const Scene& scene, int offset) {
  ASSERT_EQ(scene.lattice.dims, dims);
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.5, 0.75, 1.25));
  EXPECT_TRUE(scene.lattice.right_handed());
  const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t i = 0;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) ASSERT_EQ(samples[i++], ramp(x, y, z) + offset) << x << y << z;
  EXPECT_EQ(verdict(scene, "orientation"), Verdict::Warn);
}

std::string reason_of(const fs::path& path, const ReadOptions& options) {
  try {
    read_scene(path, options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ReadImageStack, TakesTheFilesOfAFolderInTheOrderOfTheirNumbers) {
  const ScratchFolder folder;
  // Without leading zeros, so that the order of letters is another.
  for (int z = 0; z < dims.z; ++z)
    write_page<std::uint16_t>(folder / ("slice" + std::to_string(z) + ".png"), OIIO::TypeDesc::UINT16, z,
                              700);
  fs::create_symlink("self.png", folder / "self.png");  // no file
  expect_ramp(read_scene(folder.path(), spaced()), 700);
  expect_ramp(read_scene(folder / "slice*.png", spaced()), 700);
  EXPECT_EQ(read_scene(folder / "slice1?.png", spaced()).lattice.dims.z, 2);
  EXPECT_NE(reason_of(folder.path(), {}).find("--spacing"), std::string::npos);
  EXPECT_NE(reason_of(folder / "none*.png", spaced()).find("no such file"), std::string::npos);
}

TEST(ReadImageStack, TwoStacksInOneFolderAreNotOneOfTwiceTheHeight) {
  const ScratchFolder folder;
  const auto write = [&](const std::string& name) {
    write_page<std::uint16_t>(folder / name, OIIO::TypeDesc::UINT16, 0, 700);
  };
  for (int z = 0; z < 3; ++z) {
    write("ct_00" + std::to_string(z) + ".png");
    write("mask_" + std::to_string(z) + ".png");  // zeros before a number do not matter
  }
  const std::string reason = reason_of(folder.path(), spaced());
  EXPECT_NE(reason.find("ct_#.png (3 files) and mask_#.png (3 files)"), std::string::npos) << reason;
  EXPECT_NE(reason.find("put each stack into its own folder"), std::string::npos) << reason;
  const Scene both = read_scene(folder / "*.png", spaced());
  EXPECT_EQ(both.lattice.dims.z, 6);
  EXPECT_EQ(verdict(both, "stacks"), Verdict::Fail);
  const Scene one = read_scene(folder / "ct_*.png", spaced());
  EXPECT_EQ(one.lattice.dims.z, 3);
  for (const Finding& line : one.audit) EXPECT_NE(line.check, "stacks") << line.detail;
}

TEST(ReadImageStack, NumbersThatOccurTwiceAreTold) {
  const auto doubts = [](const std::vector<std::string>& names) {
    const ScratchFolder folder;
    for (const std::string& name : names)
      write_page<std::uint16_t>(folder / name, OIIO::TypeDesc::UINT16, 0, 700);
    std::string found;
    for (const Finding& line : read_scene(folder.path(), spaced()).audit)
      if (line.check == "stacks")
        found += std::string(line.verdict == Verdict::Warn ? "WARN " : "") + line.detail;
    return found;
  };
  const std::string twice = doubts({"s1_000.png", "s1_001.png", "s2_000.png", "s2_001.png"});
  EXPECT_NE(twice.find("'s1_' and with 's2_'"), std::string::npos) << twice;
  EXPECT_EQ(twice.find("WARN"), 0u) << twice;
  // One stack: numbers that go on, an equal number behind each slice's own, halves of different names.
  EXPECT_EQ(doubts({"a1.png", "a2.png", "a10.png"}), "");
  EXPECT_EQ(doubts({"z1_c0.png", "z2_c0.png", "z3_c0.png"}), "");
  EXPECT_EQ(doubts({"low_1.png", "low_2.png", "top_3.png", "top_4.png"}), "");
}

TEST(ReadImageStack, TakesThePagesOfOneTiffWithTheirSigns) {
  const ScratchFolder folder;
  const fs::path path = folder / "stack.tif";
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path.string());
  const OIIO::ImageSpec spec(dims.x, dims.y, 1, OIIO::TypeDesc::INT16);
  for (int z = 0; z < dims.z; ++z) {
    ASSERT_TRUE(out->open(path.string(), spec,
                          z == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendSubimage));
    const auto samples = page<std::int16_t>(z, 0);
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::INT16, samples.data()));
  }
  ASSERT_TRUE(out->close());
  expect_ramp(read_scene(path, spaced()), 0);
}

/// Writes the page of slice 0 with its rows stored as a TIFF of that orientation has them.
void write_turned(const fs::path& path, int orientation) {
  const bool is_turned = orientation >= 5;
  const int columns = is_turned ? dims.y : dims.x, rows = is_turned ? dims.x : dims.y;
  std::vector<std::uint16_t> samples;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      // TIFF 6.0: where row 0 lies, and where column 0.
      const glm::ivec2 place = orientation == 1   ? glm::ivec2(i, j)
                               : orientation == 2 ? glm::ivec2(dims.x - 1 - i, j)
                               : orientation == 3 ? glm::ivec2(dims.x - 1 - i, dims.y - 1 - j)
                               : orientation == 4 ? glm::ivec2(i, dims.y - 1 - j)
                               : orientation == 5 ? glm::ivec2(j, i)
                               : orientation == 6 ? glm::ivec2(dims.x - 1 - j, i)
                               : orientation == 7 ? glm::ivec2(dims.x - 1 - j, dims.y - 1 - i)
                                                  : glm::ivec2(j, dims.y - 1 - i);
      samples.push_back(static_cast<std::uint16_t>(ramp(place.x, place.y, 0) + 700));
    }
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path.string());
  OIIO::ImageSpec spec(columns, rows, 1, OIIO::TypeDesc::UINT16);
  spec.attribute("Orientation", orientation);
  ASSERT_TRUE(out->open(path.string(), spec));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT16, samples.data()) && out->close());
}

TEST(ReadImageStack, TurnsPicturesUprightByTheOrientationThatTheyState) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    SCOPED_TRACE(orientation);
    const ScratchFolder folder;
    for (const char* name : {"a1.tif", "a2.tif"}) write_turned(folder / name, orientation);
    const Scene scene = read_scene(folder.path(), spaced());
    ASSERT_EQ(scene.lattice.dims, glm::ivec3(dims.x, dims.y, 2));
    const auto& samples = std::get<Int16Samples>(scene.samples);
    for (int y = 0, i = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x, ++i)
        ASSERT_EQ(samples[static_cast<std::size_t>(i)], ramp(x, y, 0) + 700) << x << " " << y;
    EXPECT_EQ(tests::finding(scene, "picture_orientation") == nullptr, orientation == 1);
  }
  const ScratchFolder folder;
  write_turned(folder / "a1.tif", 1);
  write_turned(folder / "a2.tif", 3);
  EXPECT_EQ(verdict(read_scene(folder.path(), spaced()), "picture_orientation"), Verdict::Warn);
}

/// The lines that a stack of pages gets whose description and resolution are as given.
std::map<std::string, std::string> lines_of_picture(const std::string& description, float per_cm) {
  const ScratchFolder folder;
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("a.tif");
  OIIO::ImageSpec spec(dims.x, dims.y, 1, OIIO::TypeDesc::INT16);
  if (!description.empty()) spec.attribute("ImageDescription", description);
  if (per_cm > 0.0f) {
    spec.attribute("XResolution", per_cm);
    spec.attribute("YResolution", per_cm / 1.5f);
    spec.attribute("PixelAspectRatio", 1.0f / 1.5f);  // else OpenImageIO writes one resolution for both
    spec.attribute("ResolutionUnit", "cm");
  }
  EXPECT_TRUE(out && out->open((folder / "a.tif").string(), spec));
  EXPECT_TRUE(out->write_image(OIIO::TypeDesc::INT16, page<std::int16_t>(0, 0).data()) && out->close());
  std::map<std::string, std::string> found;
  for (const Finding& line : read_scene(folder / "a.tif", spaced()).audit)
    if (line.verdict != Verdict::Pass) found[line.check] += line.detail;
  return found;
}

TEST(ReadImageStack, HoldsWhatPicturesStateAgainstHowTheyAreRead) {
  // The spacing given is 0.5 x 0.75 x 1.25 mm.
  EXPECT_FALSE(lines_of_picture("", 20.0f).contains("picture_spacing"));
  EXPECT_NE(lines_of_picture("", 25.0f)["picture_spacing"].find("0.4 mm"), std::string::npos);
  const std::string image_j = "ImageJ=1.53t\nimages=1\nunit=mm\n",
                    ome = "<OME><Pixels PhysicalSizeXUnit=\"mm\" ";
  EXPECT_NE(lines_of_picture(image_j + "spacing=3\n", 0.0f)["picture_spacing"].find("slices 3 mm apart"),
            std::string::npos);
  EXPECT_FALSE(lines_of_picture(image_j + "spacing=1.25\n", 0.0f).contains("picture_spacing"));
  EXPECT_NE(lines_of_picture(image_j + "frames=7\n", 0.0f)["picture_axes"].find("7 times"),
            std::string::npos);
  EXPECT_NE(lines_of_picture(ome + "PhysicalSizeX=\"0.8\" SizeC=\"3\"/></OME>", 0.0f)["picture_spacing"].find(
                "0.8 mm"),
            std::string::npos);
  EXPECT_NE(lines_of_picture(ome + "SizeC=\"3\"/></OME>", 0.0f)["picture_axes"].find("3 channels"),
            std::string::npos);
  EXPECT_FALSE(lines_of_picture("a photograph", 0.0f).contains("picture_axes"));
  EXPECT_NE(lines_of_picture(image_j + "c0=-32768\nc1=1\n", 0.0f)["picture_values"].find("-32768 + 1 times"),
            std::string::npos);
  EXPECT_FALSE(lines_of_picture(image_j + "c0=0\nc1=1\n", 0.0f).contains("picture_values"));
  EXPECT_TRUE(lines_of_picture(image_j + "xorigin=12\n", 0.0f).contains("picture_origin"));
  EXPECT_FALSE(lines_of_picture(image_j, 0.0f).contains("picture_count"));
  EXPECT_NE(
      lines_of_picture("ImageJ=1.53t\nimages=8\n", 0.0f)["picture_count"].find("8 images and 1 were found"),
      std::string::npos);
}

/// Pages of one TIFF, the first with a description; `per_unit` are pixels along x and y, 0: not stated.
void write_described(const fs::path& path, const std::string& description, const glm::vec2& per_unit,
                     const char* unit = "none", int pages = 3) {
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path.string());
  for (int z = 0; z < pages; ++z) {
    OIIO::ImageSpec spec(dims.x, dims.y, 1, OIIO::TypeDesc::INT16);
    if (z == 0 && !description.empty()) spec.attribute("ImageDescription", description);
    if (per_unit.x > 0.0f) spec.attribute("XResolution", per_unit.x);
    if (per_unit.y > 0.0f) spec.attribute("YResolution", per_unit.y);
    // Else OpenImageIO writes one resolution for both.
    if (per_unit.x > 0.0f && per_unit.y > 0.0f) spec.attribute("PixelAspectRatio", per_unit.y / per_unit.x);
    spec.attribute("ResolutionUnit", unit);
    ASSERT_TRUE(out && out->open(path.string(), spec,
                                 z == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendSubimage));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::INT16, page<std::int16_t>(z, 0).data()));
  }
  ASSERT_TRUE(out->close());
}

TEST(ReadImageStack, TakesTheSpacingThatImageJAndOmeState) {
  const ScratchFolder folder;
  const std::string image_j = "ImageJ=1.53t\nimages=3\nslices=3\n";
  for (const auto& [description, per_unit] :
       {std::pair(image_j + "unit=mm\nspacing=1.25\nloop=false\n", glm::vec2(2.0f, 4.0f)),
        {image_j + "unit=cm\nspacing=0.125\n", {20.0f, 40.0f}},
        {image_j + "unit=mm\nyunit=cm\nzunit=um\nspacing=1250\n", {2.0f, 40.0f}},
        {"<?xml version=\"1.0\"?><OME><Image><Pixels PhysicalSizeX=\"500\" PhysicalSizeY=\"250\" "
         "PhysicalSizeZ=\"1.25\" PhysicalSizeZUnit=\"mm\" SizeC=\"1\"/></Image></OME>",
         {0.0f, 0.0f}},
        {"<OME><Pixels PhysicalSizeX='0.5' PhysicalSizeXUnit='mm' PhysicalSizeY='250' "
         "PhysicalSizeYUnit='\u00b5m' "
         "PhysicalSizeZ='0.125' PhysicalSizeZUnit='cm'/></OME>",
         {72.0f, 72.0f}}}) {
    SCOPED_TRACE(description);
    write_described(folder / "a.tif", description, per_unit);
    const Scene scene = read_scene(folder / "a.tif");
    const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(spacing_mm[axis], glm::dvec3(0.5, 0.25, 1.25)[axis], 1e-6) << axis;
    EXPECT_EQ(verdict(scene, "picture_spacing"), Verdict::Pass);
    EXPECT_NE(tests::finding(scene, "picture_spacing")->detail.find("0.5 x 0.25 x 1.25 mm"),
              std::string::npos);
    // The spacing given is 0.5 x 0.75 x 1.25 mm.
    const Scene given = read_scene(folder / "a.tif", spaced());
    EXPECT_EQ(given.lattice.spacing_mm(), *spaced().spacing_mm);
    EXPECT_EQ(verdict(given, "picture_spacing"), Verdict::Warn);
    EXPECT_NE(
        tests::finding(given, "picture_spacing")->detail.find("0.25 mm high, but --spacing states 0.75 mm"),
        std::string::npos);
  }
  for (const std::string micrometre : {"micron", "\\u00B5m", "\xb5m"}) {
    SCOPED_TRACE(micrometre);
    write_described(folder / "a.tif", image_j + "unit=" + micrometre + "\nspacing=1250.0\n", {2.0f, 4.0f});
    const glm::dvec3 spacing_mm = read_scene(folder / "a.tif").lattice.spacing_mm();
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(spacing_mm[axis], glm::dvec3(0.0005, 0.00025, 1.25)[axis], 1e-9) << axis;
  }
}

TEST(ReadImageStack, NamesWhatASpacingThatIsStatedInPartLeavesOut) {
  const ScratchFolder folder;
  const auto reason = [&](const std::string& description, const glm::vec2& per_unit,
                          const char* unit = "none") {
    write_described(folder / "a.tif", description, per_unit, unit);
    return reason_of(folder / "a.tif", {});
  };
  const std::string image_j = "ImageJ=1.53t\nimages=3\nslices=3\n";
  for (const auto& [text, part] :
       {std::pair(reason(image_j + "unit=mm\n", {2.0f, 4.0f}),
                  "0.5 x 0.25 x ? mm (ImageJ), without the distance"),
        {reason(image_j + "unit=mm\nspacing=1.25\n", {0.0f, 0.0f}),
         "the width of a pixel, the height of a pixel"},
        {reason(image_j + "unit=pixel\nspacing=1.25\n", {2.0f, 4.0f}),
         "unit 'pixel' is not a known unit of length"},
        {reason(image_j + "spacing=1.25\n", {2.0f, 4.0f}), "names no unit"},
        {reason(image_j + "unit=mm\nspacing=-1.25\n", {2.0f, 4.0f}), "a size of -1.25 mm"},
        {reason(image_j + "unit=mm\nspacing=1.25\n", {72.0f, 72.0f}, "in"), "another program changed it"},
        {reason("<OME><Pixels PhysicalSizeX=\"1\" PhysicalSizeY=\"1\"/></OME>", {0.0f, 0.0f}),
         "distance of slices"},
        {reason("<OME><Pixels PhysicalSizeX=\"1\" PhysicalSizeXUnit=\"pixel\"/></OME>", {0.0f, 0.0f}),
         "'pixel'"},
        // The resolution of a page is none of a patient.
        {reason("", {25.4f, 25.4f}, "in"), "does not state its spacing: give --spacing"},
        {reason("a photograph", {10.0f, 10.0f}, "cm"), "does not state its spacing: give --spacing"}}) {
    EXPECT_NE(text.find(part), std::string::npos) << text << "\n" << part;
    EXPECT_NE(text.find("give --spacing X,Y,Z in mm"), std::string::npos) << text;
  }
  write_described(folder / "b.tif", image_j + "unit=mm\nspacing=1.25\n", {2.0f, 4.0f});
  write_described(folder / "a.tif", image_j + "unit=mm\nspacing=1.25\n", {2.0f, 4.0f});
  EXPECT_EQ(read_scene(folder.path()).lattice.dims.z, 6);
  write_described(folder / "b.tif", image_j + "unit=mm\nspacing=2.5\n", {2.0f, 4.0f});
  EXPECT_NE(reason_of(folder.path(), {}).find("different sizes"), std::string::npos);
}

TEST(ReadImageStack, WarnsOfNumbersThatTheNamesSkip) {
  const auto missing = [](const std::vector<int>& numbers) {
    const ScratchFolder folder;
    for (const int number : numbers)
      write_page<std::uint16_t>(folder / ("s" + std::to_string(number) + ".png"), OIIO::TypeDesc::UINT16, 0,
                                700);
    const Scene scene = read_scene(folder.path(), spaced());
    const Finding* line = tests::finding(scene, "missing_slices");
    return line == nullptr ? std::string() : line->detail;
  };
  EXPECT_EQ(missing({1, 2, 3, 4, 5}), "");
  EXPECT_EQ(missing({10, 20, 30, 40}), "") << "every tenth number";
  EXPECT_EQ(missing({1, 7, 30}), "") << "no step is usual";
  const std::string one = missing({1, 2, 4, 5, 6});
  EXPECT_NE(one.find("1 numbers"), std::string::npos) << one;
  EXPECT_NE(one.find("s2.png"), std::string::npos) << one;
  EXPECT_NE(missing({1, 5, 6, 7, 8, 10}).find("4 numbers"), std::string::npos);
}

TEST(ReadImageStack, RefusesColourAndMixedSizes) {
  const ScratchFolder folder;
  write_page<std::uint16_t>(folder / "a1.png", OIIO::TypeDesc::UINT16, 0, 700);
  {
    const std::string path = folder / "a2.png";
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out->open(path, OIIO::ImageSpec(4, 4, 1, OIIO::TypeDesc::UINT16)));
    const std::vector<std::uint16_t> samples(16, 1);
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT16, samples.data()) && out->close());
  }
  EXPECT_NE(reason_of(folder.path(), spaced()).find("differs in size"), std::string::npos);
  const std::string path = folder / "colour.png";
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out->open(path, OIIO::ImageSpec(4, 4, 3, OIIO::TypeDesc::UINT8)));
  std::vector<std::uint8_t> samples(48, 9);
  samples[5] = 200;
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, samples.data()) && out->close());
  EXPECT_NE(reason_of(path, spaced()).find("colour"), std::string::npos);
}

template <typename Sample>
std::string raw_bytes(bool big_endian, int offset = 0) {
  std::string bytes;
  for (int z = 0; z < dims.z; ++z)
    for (const Sample sample : page<Sample>(z, offset)) {
      std::string one(sizeof(Sample), '\0');
      std::memcpy(one.data(), &sample, sizeof(Sample));
      if (big_endian) std::reverse(one.begin(), one.end());
      bytes += one;
    }
  return bytes;
}

TEST(ReadRaw, ReadsEveryTypeInEitherByteOrderAfterAnOffset) {
  const ScratchFolder folder;
  const auto check = [&]<typename Sample>(Sample, SampleType type, int offset) {
    for (const bool big_endian : {false, true}) {
      std::ofstream(folder / "scan.raw", std::ios::binary)
          << std::string("head") + raw_bytes<Sample>(big_endian, offset);
      ReadOptions options = spaced();
      options.raw = RawLayout{dims, type, big_endian, 4};
      expect_ramp(read_scene(folder / "scan.raw", options), offset);
    }
  };
  check(std::int16_t{}, SampleType::Int16, 0);
  check(std::uint16_t{}, SampleType::UInt16, 900);
  check(std::int32_t{}, SampleType::Int32, 0);
  check(std::uint32_t{}, SampleType::UInt32, 900);
  check(float{}, SampleType::Float, 0);
  check(double{}, SampleType::Double, 0);
}

TEST(ReadRaw, WarnsOfAByteOrderWhoseSwapIsFarSmoother) {
  const ScratchFolder folder;
  constexpr int side = 24;
  const auto warns = [&](bool stored_big, bool stated_big, int noise) {
    std::string bytes;
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const glm::ivec3 off = glm::ivec3(x, y, z) - side / 2;
          const int level = off.x * off.x + off.y * off.y + off.z * off.z < 70 ? 300 : -1000;
          const auto sample =
              static_cast<std::uint16_t>(level + (x * 7919 + y * 104729 + z * 31) % (noise + 1));
          const char low = static_cast<char>(sample & 0xFF), high = static_cast<char>(sample >> 8);
          bytes += stored_big ? high : low;
          bytes += stored_big ? low : high;
        }
    std::ofstream(folder / "scan.raw", std::ios::binary) << bytes;
    ReadOptions options = spaced();
    options.raw = RawLayout{glm::ivec3(side), SampleType::Int16, stated_big};
    return tests::finding(read_scene(folder / "scan.raw", options), "byte_order") != nullptr;
  };
  for (const int noise : {20, 200}) {
    EXPECT_TRUE(warns(true, false, noise)) << noise;
    EXPECT_TRUE(warns(false, true, noise)) << noise;
    EXPECT_FALSE(warns(true, true, noise)) << noise;
    EXPECT_FALSE(warns(false, false, noise)) << noise;
  }
  EXPECT_FALSE(warns(false, false, 60000)) << "numbers by chance are alike in both orders";
}

TEST(ReadRaw, DoubtsItsOriginAndASizeThatNoScannerMakes) {
  const ScratchFolder folder;
  std::ofstream(folder / "scan.raw", std::ios::binary) << raw_bytes<std::int16_t>(false);
  ReadOptions options = spaced();
  options.raw = RawLayout{dims, SampleType::Int16};
  const Scene scene = read_scene(folder / "scan.raw", options);
  EXPECT_EQ(verdict(scene, "origin"), Verdict::Warn);
  EXPECT_EQ(tests::finding(scene, "plausible_size"), nullptr);
  for (const double mm : {1000.0, 0.01}) {
    options.spacing_mm = glm::dvec3(mm);
    EXPECT_EQ(verdict(read_scene(folder / "scan.raw", options), "plausible_size"), Verdict::Warn) << mm;
  }
}

TEST(ReadRaw, DoubtsAWholeFieldOfCentimetresInManyPixels) {
  const ScratchFolder folder;
  const glm::ivec3 sizes{100, 80, 4};
  std::string bytes;
  for (int i = 0; i < sizes.x * sizes.y * sizes.z; ++i)
    bytes += {static_cast<char>(i % 97), static_cast<char>(1 + i % 3)};
  std::ofstream(folder / "scan.raw", std::ios::binary) << bytes;
  const auto finding = [&](const glm::dvec3& spacing_mm) {
    ReadOptions options;
    options.spacing_mm = spacing_mm;
    options.raw = RawLayout{sizes, SampleType::Int16};
    const Scene scene = read_scene(folder / "scan.raw", options);
    const Finding* line = tests::finding(scene, "plausible_size");
    return line == nullptr ? std::string() : line->detail;
  };
  EXPECT_NE(finding({0.24, 0.24, 0.5}).find("24 x 19.2 x 2 mm"), std::string::npos);
  EXPECT_EQ(finding({0.4, 0.4, 0.5}), "") << "40 mm, as of an ear";
  EXPECT_EQ(finding({0.24, 0.24, 10.0}), "") << "40 mm long";
}

TEST(ReadRaw, TakesDoublesBeyondSinglePrecisionAsPaddingAndSaysSo) {
  const ScratchFolder folder;
  std::string bytes = raw_bytes<double>(false);
  const double beyond = 1e300;
  std::memcpy(bytes.data() + sizeof beyond, &beyond, sizeof beyond);
  std::ofstream(folder / "scan.raw", std::ios::binary) << bytes;
  ReadOptions options = spaced();
  options.raw = RawLayout{dims, SampleType::Double};
  const Scene scene = read_scene(folder / "scan.raw", options);
  EXPECT_EQ(verdict(scene, "finite"), Verdict::Warn);
  ASSERT_TRUE(scene.padding.has_value());
  EXPECT_EQ(std::get<voxel::Int16Samples>(scene.samples)[1], *scene.padding);
  EXPECT_EQ(voxel::range(scene).low, ramp(0, dims.y - 1, 0));
}

TEST(ReadRaw, RefusesAFileThatHasNotTheBytesThatItsLayoutTakes) {
  const ScratchFolder folder;
  std::ofstream(folder / "scan.raw", std::ios::binary) << raw_bytes<std::int16_t>(false);
  ReadOptions options = spaced();
  options.raw = RawLayout{dims, SampleType::Int32};
  EXPECT_NE(reason_of(folder / "scan.raw", options).find("840 bytes"), std::string::npos)
      << reason_of(folder / "scan.raw", options);
  options.raw = RawLayout{glm::ivec3(1 << 20), SampleType::Double};
  EXPECT_NE(reason_of(folder / "scan.raw", options).find("check dims"), std::string::npos);
  options.raw = RawLayout{dims, SampleType::Int16};
  options.spacing_mm.reset();
  EXPECT_NE(reason_of(folder / "scan.raw", options).find("--spacing"), std::string::npos);
}

// A NIfTI-2 file of the ramp with an affine that mirrors x and exchanges y and z.
std::string nifti2(bool big_endian, bool sform) {
  std::string bytes(544, '\0');
  const auto put = [&](std::size_t at, auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big_endian) std::reverse(std::begin(raw), std::end(raw));
    std::memcpy(&bytes[at], raw, sizeof value);
  };
  put(0, std::int32_t{540});
  std::memcpy(&bytes[4], "n+2\0\r\n\032\n", 8);
  put(12, std::int16_t{4});
  put(14, std::int16_t{16});
  const std::int64_t lengths[] = {3, dims.x, dims.y, dims.z, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) put(16 + 8 * i, lengths[i]);
  const double steps[] = {1.0, 0.5, 0.75, 1.25, 0, 0, 0, 0};
  for (std::size_t i = 0; i < 8; ++i) put(104 + 8 * i, steps[i]);
  put(168, std::int64_t{544});
  put(176, 2.0);
  put(184, 5.0);
  if (sform) {
    put(348, std::int32_t{1});
    const double rows[3][4] = {{-0.5, 0, 0, 10}, {0, 0, 1.25, -20}, {0, 0.75, 0, 30}};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c) put(400 + 32 * r + 8 * c, rows[r][c]);
  } else {
    put(344, std::int32_t{1});  // half a turn about z: (b, c, d) = (0, 0, 1)
    put(368, 1.0);
    put(376, 10.0);
    put(384, -20.0);
    put(392, 30.0);
  }
  return bytes + raw_bytes<std::int16_t>(big_endian);
}

TEST(ReadNifti2, TurnsItsAffinesIntoLpsAndAppliesItsSlope) {
  const ScratchFolder folder;
  for (const bool big_endian : {false, true})
    for (const bool sform : {false, true}) {
      SCOPED_TRACE(std::to_string(big_endian) + std::to_string(sform));
      std::ofstream(folder / "scan.nii", std::ios::binary) << nifti2(big_endian, sform);
      const Scene scene = read_scene(folder / "scan.nii");
      ASSERT_EQ(scene.lattice.dims, dims);
      EXPECT_EQ(glm::dvec3(scene.lattice.lps_from_voxel[3]), glm::dvec3(-10, 20, 30));
      EXPECT_LT(glm::distance(glm::dvec3(scene.lattice.lps_from_voxel[0]), glm::dvec3(0.5, 0, 0)), 1e-12);
      EXPECT_LT(glm::distance(glm::dvec3(scene.lattice.lps_from_voxel[1]),
                              sform ? glm::dvec3(0, 0, 0.75) : glm::dvec3(0, 0.75, 0)),
                1e-12);
      EXPECT_LT(glm::distance(glm::dvec3(scene.lattice.lps_from_voxel[2]),
                              sform ? glm::dvec3(0, -1.25, 0) : glm::dvec3(0, 0, 1.25)),
                1e-12);
      EXPECT_EQ(std::get<voxel::Int16Samples>(scene.samples)[8], 2 * ramp(1, 1, 0) + 5);
    }
}

TEST(ReadNifti2, ReadsItPackedAndRefusesItDamaged) {
  const ScratchFolder folder;
  const std::string whole = nifti2(false, true);
  const gzFile out = gzopen((folder / "scan.nii.gz").c_str(), "wb");
  gzwrite(out, whole.data(), static_cast<unsigned>(whole.size()));
  gzclose(out);
  EXPECT_EQ(read_scene(folder / "scan.nii.gz").lattice.dims, dims);
  for (const std::size_t keep : {std::size_t{100}, std::size_t{541}, whole.size() - 1}) {
    std::ofstream(folder / "cut.nii", std::ios::binary) << whole.substr(0, keep);
    EXPECT_THROW(read_scene(folder / "cut.nii"), std::runtime_error) << keep;
  }
  // Every byte of the header spoiled in turn: read or refused, and nothing more allocated than the file
  // holds.
  int refused = 0;
  for (std::size_t at = 0; at < 540; ++at) {
    std::string mutant = whole;
    mutant[at] = static_cast<char>(mutant[at] ^ 0x7f);
    std::ofstream(folder / "mutant.nii", std::ios::binary) << mutant;
    refused += reason_of(folder / "mutant.nii", {}) != "nothing was thrown";
  }
  EXPECT_GT(refused, 40);
}

}  // namespace
}  // namespace octotomy::voxel
