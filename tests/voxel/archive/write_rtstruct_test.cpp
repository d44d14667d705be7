// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/write_rtstruct.h"

#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/codes/run_length.h"
#include "voxel/dicom/dicom_file.h"
#include "voxel/scan/read_rtstruct.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;

/// An oblique universe of 8 voxels a side; its third axis leans if asked for.
Universe universe_of(double lean_mm = 0.0) {
  Universe universe;
  universe.depth = 3;
  universe.lps_from_voxel = glm::dmat4(glm::dvec4(0.48, 0.64, 0, 0), glm::dvec4(-0.72, 0.54, 0, 0),
                                       glm::dvec4(0, lean_mm, 2.5, 0), glm::dvec4(-7, 11, 30, 1));
  return universe;
}

std::uint64_t index(int x, int y, int z) {
  return static_cast<std::uint64_t>(x + 8 * (y + 8 * z));
}

/// A block of 3 x 3 voxels in each of these planes; in the first without its middle.
Octree ring(const Universe& universe, std::initializer_list<int> planes) {
  RunLength runs{universe, {}};
  for (const int z : planes)
    for (int y = 2; y < 5; ++y) {
      if (z == *planes.begin() && y == 3) {
        runs.runs.push_back({index(2, y, z), index(2, y, z)});
        runs.runs.push_back({index(4, y, z), index(4, y, z)});
      } else {
        runs.runs.push_back({index(2, y, z), index(4, y, z)});
      }
    }
  return octree_of(runs);
}

/// A series of images at these heights above the universe's first plane.
DicomSource source_of(std::initializer_list<double> heights_mm) {
  DicomSource source;
  source.series_uid = "1.2.3";
  source.attributes[0x00100020] = {"LO", "A17"};
  source.attributes[0x0020000d] = {"UI", "1.2.4"};
  source.attributes[0x00200052] = {"UI", "1.2.5"};
  for (const double height : heights_mm)
    source.images.push_back(
        {"1.2.840.10008.5.1.4.1.1.2", "1.2.3." + std::to_string(source.images.size() + 1), 30.0 + height});
  return source;
}

std::vector<DicomFile> contours_of(const DicomFile& file) {
  return file.items(0x30060039).front().items(0x30060040);
}

TEST(WriteRtstruct, AHoleIsAContourOfItsOwnByExclusiveOr) {
  const ScratchFolder folder;
  const DicomSegment object{"Skull", ring(universe_of(), {1, 2})};
  const auto drawn = write_rtstruct({&object, 1}, folder / "x.dcm");
  ASSERT_EQ(drawn.size(), 1U);
  EXPECT_EQ(drawn[0].planes, 2U);
  EXPECT_EQ(drawn[0].contours, 3U);
  EXPECT_EQ(drawn[0].holes, 1U);
  EXPECT_EQ(drawn[0].points, 12U);
  ASSERT_TRUE(is_rtstruct(folder / "x.dcm"));
  const StructureSet set = read_rtstruct(folder / "x.dcm");
  ASSERT_EQ(set.structures.size(), 1U);
  EXPECT_EQ(set.structures[0].name, "Skull");
  EXPECT_EQ(set.structures[0].slab_mm, 2.5);
  EXPECT_EQ(set.structures[0].miscounted, 0U);
  ASSERT_EQ(set.structures[0].contours_mm.size(), 3U);
  const Lattice lattice = universe_of().lattice();
  const std::vector<glm::dvec3>& outer = set.structures[0].contours_mm[0];
  const glm::dvec3 corner = lattice.lps_mm({4.5, 1.5, 1.0});
  EXPECT_LT(glm::distance(outer[0], corner), 1e-4) << "along the voxels' edges, in their plane";
  const std::string bytes = tests::bytes_of(folder / "x.dcm");
  const DicomFile file(bytes, bytes.size());
  EXPECT_EQ(file.transfer_syntax(), "1.2.840.10008.1.2");
  for (const DicomFile& contour : contours_of(file)) EXPECT_EQ(contour.text(0x30060042), "CLOSEDPLANAR_XOR");
}

TEST(WriteRtstruct, WithoutAHoleContoursAreOfTheTypeThatEveryReaderKnows) {
  const ScratchFolder folder;
  const DicomSegment object{"A", Octree::full(universe_of())};
  write_rtstruct({&object, 1}, folder / "x.dcm");
  const std::string bytes = tests::bytes_of(folder / "x.dcm");
  EXPECT_EQ(contours_of(DicomFile(bytes, bytes.size())).front().text(0x30060042), "CLOSED_PLANAR");
}

TEST(WriteRtstruct, ContoursLieOnTheImagesAndReferToThem) {
  const ScratchFolder folder;
  RtstructOptions options;
  options.source = source_of({0.0, 2.5, 5.0, 7.5});
  const DicomSegment object{"A", ring(universe_of(), {1, 2})};
  const auto drawn = write_rtstruct({&object, 1}, folder / "x.dcm", options);
  EXPECT_EQ(drawn[0].planes, 2U);
  EXPECT_EQ(drawn[0].planes_left_out, 0U);
  EXPECT_EQ(drawn[0].farthest_mm, 0.0);
  const std::string bytes = tests::bytes_of(folder / "x.dcm");
  const DicomFile file(bytes, bytes.size());
  EXPECT_EQ(file.text(0x00100020), "A17");
  EXPECT_EQ(file.text(0x0020000d), "1.2.4");
  EXPECT_EQ(file.text(0x00200052), "1.2.5");
  const auto contours = contours_of(file);
  EXPECT_EQ(contours.front().items(0x30060016).front().text(0x00081155), "1.2.3.2");
  EXPECT_EQ(contours.back().items(0x30060016).front().text(0x00081155), "1.2.3.3");
  const StructureSet set = read_rtstruct(folder / "x.dcm");
  EXPECT_EQ(set.identity.referred_series_uids, std::vector<std::string>{"1.2.3"});
  EXPECT_EQ(set.structures[0].frame_uids, std::vector<std::string>{"1.2.5"});
}

TEST(WriteRtstruct, ImagesBetweenTheVoxelsShowTheNearestPlaneUnlessTheVoxelsPlanesAreChosen) {
  const ScratchFolder folder;
  RtstructOptions options;
  options.source = source_of({1.0, 6.0});
  const DicomSegment object{"A", ring(universe_of(), {0, 1, 2})};
  const auto on_images = write_rtstruct({&object, 1}, folder / "x.dcm", options);
  EXPECT_EQ(on_images[0].planes, 2U);
  EXPECT_EQ(on_images[0].planes_left_out, 1U);
  EXPECT_NEAR(on_images[0].farthest_mm, 1.0, 1e-12);
  EXPECT_NEAR(read_rtstruct(folder / "x.dcm").structures[0].contours_mm[0][0].z, 31.0, 1e-4);
  EXPECT_EQ(read_rtstruct(folder / "x.dcm").structures[0].slabs_mm[0], 5.0) << "as thick as the wider gap";
  options.planes = ContourPlanes::Voxels;
  const auto on_voxels = write_rtstruct({&object, 1}, folder / "x.dcm", options);
  EXPECT_EQ(on_voxels[0].planes, 3U);
  EXPECT_EQ(on_voxels[0].planes_left_out, 0U);
}

TEST(WriteRtstruct, EqualContentIsWrittenAsEqualBytes) {
  const ScratchFolder folder;
  const std::vector<DicomSegment> objects{{"A", ring(universe_of(), {1, 2})},
                                          {"B", ring(universe_of(), {4})}};
  write_rtstruct(objects, folder / "x.dcm");
  write_rtstruct(objects, folder / "y.dcm");
  EXPECT_TRUE(tests::bytes_of(folder / "x.dcm") == tests::bytes_of(folder / "y.dcm"));
  const std::vector<DicomSegment> others{{"A", ring(universe_of(), {1, 2})}, {"B", ring(universe_of(), {5})}};
  write_rtstruct(others, folder / "y.dcm");
  const std::string a = tests::bytes_of(folder / "x.dcm"), b = tests::bytes_of(folder / "y.dcm");
  EXPECT_NE(DicomFile(a, a.size()).text(0x00080018), DicomFile(b, b.size()).text(0x00080018));
}

TEST(WriteRtstruct, AContourOf64KilobytesIsWhole) {
  const ScratchFolder folder;
  Universe universe;
  universe.depth = 9;
  // Full rows, each with teeth below it, joined by the first column.
  RunLength comb{universe, {}};
  for (std::uint64_t y = 0; y < 510; ++y) {
    if (y % 3 == 0) comb.runs.push_back({512 * y, 512 * y + 510});
    if (y % 3 != 0) comb.runs.push_back({512 * y, 512 * y});
    for (std::uint64_t x = 2; y % 3 == 1 && x < 511; x += 2) comb.runs.push_back({512 * y + x, 512 * y + x});
  }
  const DicomSegment object{"A", octree_of(comb)};
  const auto drawn = write_rtstruct({&object, 1}, folder / "x.dcm");
  EXPECT_EQ(drawn[0].contours, 1U);
  EXPECT_GT(drawn[0].points, 100000U);
  const StructureSet set = read_rtstruct(folder / "x.dcm");
  EXPECT_EQ(set.structures[0].contours_mm[0].size(), drawn[0].points);
  EXPECT_EQ(set.structures[0].miscounted, 0U);
}

TEST(WriteRtstruct, RefusesWhatItCannotSay) {
  const ScratchFolder folder;
  const DicomSegment empty{"A", Octree::empty(universe_of())}, full{"A", Octree::full(universe_of())};
  EXPECT_THROW(write_rtstruct({}, folder / "x.dcm"), std::invalid_argument);
  EXPECT_THROW(write_rtstruct({&empty, 1}, folder / "x.dcm"), std::invalid_argument);
  RtstructOptions options;
  options.source = source_of({1000.0});
  EXPECT_THROW(write_rtstruct({&full, 1}, folder / "x.dcm", options), Error) << "beside all images";
  options.source = source_of({0.0});
  options.source->normal = {1, 0, 0};
  EXPECT_THROW(write_rtstruct({&full, 1}, folder / "x.dcm", options), std::invalid_argument);
  options = {};
  options.label = std::string(65, 'x');
  EXPECT_THROW(write_rtstruct({&full, 1}, folder / "x.dcm", options), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace octotomy::voxel
