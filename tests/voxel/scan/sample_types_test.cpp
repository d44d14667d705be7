// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Every type of samples, in either byte order, out of every kind of volume file: the lowest and highest
// values of the type come back as they are, or rounded to single precision with a line that says so.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// A type of samples by the names and codes that formats give it.
struct Type {
  const char* name;  ///< NRRD's
  const char* meta;
  std::int16_t nifti;
  std::vector<double> values;  ///< eight
  std::size_t bytes;
  std::function<std::string(double)> stored;  ///< little-endian
};

template <typename Number>
Type type(const char* name, const char* meta, std::int16_t nifti) {
  using Limits = std::numeric_limits<Number>;
  const double low = std::is_floating_point_v<Number> ? -1234.5 : static_cast<double>(Limits::lowest());
  const double high = std::is_floating_point_v<Number> ? 65536.25 : static_cast<double>(Limits::max());
  return {name, meta, nifti, {low, low + 1, 0, 1, 2, 100, high - 1, high}, sizeof(Number), [](double value) {
            const auto number = static_cast<Number>(value);
            return std::string(reinterpret_cast<const char*>(&number), sizeof number);
          }};
}

const std::vector<Type>& types() {
  static const std::vector<Type> all{
      type<std::int8_t>("int8", "MET_CHAR", 256),  type<std::uint8_t>("uint8", "MET_UCHAR", 2),
      type<std::int16_t>("int16", "MET_SHORT", 4), type<std::uint16_t>("uint16", "MET_USHORT", 512),
      type<std::int32_t>("int32", "MET_INT", 8),   type<std::uint32_t>("uint32", "MET_UINT", 768),
      type<float>("float", "MET_FLOAT", 16),       type<double>("double", "MET_DOUBLE", 64)};
  return all;
}

std::string samples_of(const Type& type, bool big_endian) {
  std::string bytes;
  for (const double value : type.values) {
    std::string one = type.stored(value);
    if (big_endian) std::reverse(one.begin(), one.end());
    bytes += one;
  }
  return bytes;
}

std::string nrrd(const Type& type, bool big_endian) {
  return std::string("NRRD0004\ntype: ") + type.name +
         "\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
         "space directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (4,5,6)\nencoding: raw\nendian: " +
         (big_endian ? "big" : "little") + "\n\n" + samples_of(type, big_endian);
}

std::string meta(const Type& type, bool big_endian) {
  return std::string(
             "ObjectType = Image\nNDims = 3\nBinaryData = True\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n"
             "Offset = 4 5 6\nElementSpacing = 1 2 3\nDimSize = 2 2 2\nBinaryDataByteOrderMSB = ") +
         (big_endian ? "True" : "False") + "\nElementType = " + type.meta + "\nElementDataFile = LOCAL\n" +
         samples_of(type, big_endian);
}

/// NIfTI-1 with an sform, whose RAS is the others' LPS, and a rescale.
std::string nifti(const Type& type, bool big_endian, float slope = 1.0f, float intercept = 0.0f) {
  std::string bytes(352, '\0');
  const auto put = [&](std::size_t at, auto number) {
    std::string one(reinterpret_cast<const char*>(&number), sizeof number);
    if (big_endian) std::reverse(one.begin(), one.end());
    bytes.replace(at, one.size(), one);
  };
  put(0, std::int32_t{348});
  for (std::size_t i = 0; i < 8; ++i) put(40 + 2 * i, std::array<std::int16_t, 8>{3, 2, 2, 2, 1, 1, 1, 1}[i]);
  put(70, type.nifti);
  put(72, static_cast<std::int16_t>(8 * type.bytes));
  for (std::size_t i = 0; i < 4; ++i) put(76 + 4 * i, std::array{1.0f, 1.0f, 2.0f, 3.0f}[i]);
  put(108, 352.0f);
  put(112, slope);
  put(116, intercept);
  put(254, std::int16_t{1});
  const std::array<float, 12> rows{-1, 0, 0, -4, 0, -2, 0, -5, 0, 0, 3, 6};
  for (std::size_t i = 0; i < rows.size(); ++i) put(280 + 4 * i, rows[i]);
  bytes.replace(344, 4, std::string("n+1\0", 4));
  return bytes + samples_of(type, big_endian);
}

std::vector<double> values_of(const Scene& scene) {
  return std::visit([](const auto& samples) { return std::vector<double>(samples.begin(), samples.end()); },
                    scene.samples);
}

/// The values in the precision of a scene, and whether the scene must report that they are rounded.
void expect_values(const Scene& scene, const std::vector<double>& values) {
  bool rounded = false;
  std::vector<double> expected;
  bool whole = true;
  for (const double value : values) {
    whole = whole && value == std::trunc(value) && value >= -32768 && value <= 32767;
    expected.push_back(static_cast<double>(static_cast<float>(value)));
    rounded = rounded || expected.back() != value;
  }
  EXPECT_EQ(values_of(scene), expected);
  EXPECT_EQ(std::holds_alternative<Int16Samples>(scene.samples), whole);
  EXPECT_EQ(tests::finding(scene, "precision") != nullptr, rounded);
  EXPECT_EQ(scene.lattice.lps_mm({1, 1, 1}), glm::dvec3(5, 7, 9));
}

TEST(SampleTypes, ComeOutOfEveryVolumeFileAsTheyWere) {
  const tests::ScratchFolder folder;
  const std::vector<std::pair<const char*, std::string (*)(const Type&, bool)>> formats{
      {"scan.nrrd", nrrd}, {"scan.mha", meta}, {"scan.nii", [](const Type& of, bool big_endian) {
                                                  return nifti(of, big_endian);
                                                }}};
  int read = 0;
  for (const auto& [name, bytes] : formats)
    for (const Type& type : types())
      for (const bool big_endian : {false, true}) {
        SCOPED_TRACE(std::string(name) + ", " + type.name + (big_endian ? ", big-endian" : ""));
        std::ofstream(folder / name, std::ios::binary) << bytes(type, big_endian);
        expect_values(read_scene(folder / name), type.values);
        ++read;
      }
  EXPECT_EQ(read, 48);
}

TEST(SampleTypes, LabelsThatSinglePrecisionMergesAreRefusedInEveryVolumeFile) {
  const tests::ScratchFolder folder;
  for (Type wide : {type<std::int32_t>("int32", "MET_INT", 8), type<std::uint32_t>("uint32", "MET_UINT", 768),
                    type<std::int64_t>("int64", "MET_LONG_LONG", 1024),
                    type<std::uint64_t>("uint64", "MET_ULONG_LONG", 1280)})
    for (const char* name : {"labels.nrrd", "labels.mha", "labels.nii", "labels.raw"}) {
      SCOPED_TRACE(std::string(name) + ", " + wide.name);
      const std::string file(name);
      ReadOptions options;
      if (file == "labels.raw") options.raw = RawLayout{{2, 2, 2}, *sample_type(wide.name)};
      if (file == "labels.raw") options.spacing_mm = glm::dvec3(1.0);
      const auto scene_of = [&](std::vector<double> values) {
        wide.values = std::move(values);
        std::ofstream(folder / file, std::ios::binary) << (file == "labels.nrrd"  ? nrrd(wide, false)
                                                           : file == "labels.mha" ? meta(wide, false)
                                                           : file == "labels.nii" ? nifti(wide, false)
                                                                                  : samples_of(wide, false));
        return read_scene(folder / file, options);
      };
      EXPECT_EQ(labels(scene_of({0, 1, 1, 2, 0, 0, 16777214, 16777215})).size(), 4U);
      const Scene merged = scene_of({0, 1, 1, 2, 0, 0, 16777216, 16777217});
      ASSERT_NE(tests::finding(merged, "precision"), nullptr);
      EXPECT_NE(tests::finding(merged, "precision")->detail.find("labels must be smaller"),
                std::string::npos);
      EXPECT_THROW(labels(merged), std::invalid_argument);
      EXPECT_THROW(labels(scene_of({0, 0, 0, 0, 0, 0, 0, 16777216})), std::invalid_argument);
    }
}

TEST(SampleTypes, OfNiftiAreRescaledToTheBit) {
  const tests::ScratchFolder folder;
  // Halves and quarters are exact in binary; the last slope makes whole numbers again.
  for (const auto& [slope, intercept] :
       {std::pair{0.5f, -1024.0f}, std::pair{0.25f, 0.125f}, std::pair{2.0f, 10.0f}})
    for (std::size_t i = 0; i < 4; ++i) {
      const Type& type = types()[i];
      std::ofstream(folder / "scan.nii", std::ios::binary) << nifti(type, false, slope, intercept);
      std::vector<double> values;
      for (const double stored : type.values)
        values.push_back(static_cast<double>(slope) * stored + static_cast<double>(intercept));
      SCOPED_TRACE(std::string(type.name) + ", slope " + std::to_string(slope));
      expect_values(read_scene(folder / "scan.nii"), values);
    }
}

}  // namespace
}  // namespace octotomy::voxel
