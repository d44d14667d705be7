// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/dicom_source.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_frames.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

/// A source of images every 2 mm from z = 10 to 20, whose identifiers are their heights.
DicomSource stacked() {
  DicomSource source;
  for (int z = 10; z <= 20; z += 2)
    source.images.push_back({"class", std::to_string(z), static_cast<double>(z)});
  return source;
}

std::string behind(const Lattice& lattice, int k) {
  std::string uids;
  for (const DicomSource::Image& image : images_behind(stacked(), lattice, k))
    uids += image.instance_uid + " ";
  return uids;
}

TEST(DicomSource, ASliceAtAnImagesHeightComesFromItAndOneBetweenFromBoth) {
  const Lattice lattice = axis_aligned_lattice({5, 5, 20}, {1, 1, 0.5}, {0, 0, 10});
  EXPECT_EQ(behind(lattice, 0), "10 ");
  EXPECT_EQ(behind(lattice, 1), "10 12 ");
  EXPECT_EQ(behind(lattice, 4), "12 ");
  EXPECT_EQ(behind(lattice, 7), "12 14 ");
}

TEST(DicomSource, ASliceBeyondTheStackComesFromTheNearestImage) {
  const Lattice lattice = axis_aligned_lattice({5, 5, 40}, {1, 1, 1}, {0, 0, 0});
  EXPECT_EQ(behind(lattice, 3), "10 ");
  EXPECT_EQ(behind(lattice, 30), "20 ");
}

TEST(DicomSource, ASliceAcrossTheStackComesFromAllThatItCuts) {
  Lattice coronal = axis_aligned_lattice({5, 5, 5}, {1, 1, 1}, {0, 0, 11});
  std::swap(coronal.lps_from_voxel[1], coronal.lps_from_voxel[2]);  // rows go up, from 11 to 15 mm
  EXPECT_EQ(behind(coronal, 2), "10 12 14 16 ");
}

TEST(DicomSource, FramesOfOneFileAreOneImage) {
  const tests::ScratchFolder folder;
  const tests::DicomFrames frames;
  std::ofstream(folder / "frames.dcm", std::ios::binary)
      << tests::DicomBytes::file("1.2.840.10008.1.2.1", frames.attributes());
  const DicomSource source = dicom_source(folder / "frames.dcm");
  EXPECT_EQ(source.images.size(), 5u);
  const Lattice lattice = axis_aligned_lattice({4, 3, 1}, {0.25, 0.5, 2}, {-10, -20, 33});
  const std::vector<DicomSource::Image> images = images_behind(source, lattice, 0);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_EQ(images.front().instance_uid, "1.2.3.4") << "the file's, without the frame's number";
}

TEST(DicomSource, AStudyWithoutADateGivesNone) {
  const tests::ScratchFolder folder;
  DicomOptions options;
  options.source = stacked();
  options.source->attributes[0x00100010] = {"PN", "Anonymous"};
  write_dicom_series(tests::linear_scene(tests::oblique_lattice()), folder / "derived", options);
  const DicomSource derived = dicom_source(folder / "derived");
  EXPECT_FALSE(derived.attributes.contains(0x00080020)) << "a date of ours would be a false one";
  EXPECT_EQ(derived.attributes.at(0x00100010).value, "Anonymous");
}

TEST(DicomSource, TakesOverPatientAndStudyOfAWrittenSeries) {
  const tests::ScratchFolder folder;
  const Scene scene = tests::linear_scene(tests::oblique_lattice());
  DicomOptions options;
  options.patient_name = "M\xc3\xbcller^Eva";
  write_dicom_series(scene, folder / "source", options);
  const DicomSource source = dicom_source(folder / "source");
  EXPECT_EQ(source.attributes.at(0x00100010).value, options.patient_name);
  EXPECT_EQ(source.attributes.at(0x00080005).value, "ISO_IR 192");
  EXPECT_FALSE(source.attributes.at(0x0020000d).value.empty());
  EXPECT_EQ(source.images.size(), 20u);
  // What is made from what was made from it is still of that patient.
  options = {};
  options.source = source;
  write_dicom_series(scene, folder / "derived", options);
  const DicomSource derived = dicom_source(folder / "derived");
  EXPECT_EQ(derived.attributes.at(0x00100010).value, source.attributes.at(0x00100010).value);
  EXPECT_NE(derived.series_uid, source.series_uid);
  EXPECT_EQ(read_scene(folder / "derived").samples, scene.samples);
}

}  // namespace
}  // namespace octotomy::voxel
