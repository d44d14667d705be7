// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/write_plan_objects.h"

#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/dicom/dicom_file.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;

PlanObjects subject() {
  PlanObjects plan{"Advancement", "<ClinicalDocument/>", "2.25.17", {}};
  plan.pictures.push_back({"before", {{2, 1}, {1, 2, 3, 4, 5, 6}}});
  plan.pictures.push_back({"after", {{1, 1}, {7, 8, 9}}});  // an odd number of bytes
  return plan;
}

DicomSource scan() {
  DicomSource source;
  source.series_uid = "1.2.3";
  source.attributes[0x00100020] = {"LO", "A17"};
  source.attributes[0x0020000d] = {"UI", "1.2.4"};
  source.attributes[0x00200052] = {"UI", "1.2.5"};
  for (const char* uid : {"1.2.3.1", "1.2.3.1", "1.2.3.2"})
    source.images.push_back({"1.2.840.10008.5.1.4.1.1.2", uid, 0.0});
  return source;
}

TEST(WritePlanObjects, ThePlanAndItsPicturesAreOfThePatientsStudy) {
  const ScratchFolder folder;
  const auto names = write_plan_objects(subject(), folder.path(), scan());
  ASSERT_EQ(names, (std::vector<std::filesystem::path>{"plan.dcm", "picture_001.dcm", "picture_002.dcm"}));
  std::vector<std::string> series;
  for (const auto& name : names) {
    const std::string bytes = tests::bytes_of(folder.path() / name);
    const DicomFile file(bytes, bytes.size());
    EXPECT_EQ(file.text(0x00100020), "A17");
    EXPECT_EQ(file.text(0x0020000d), "1.2.4");
    EXPECT_EQ(file.text(0x00200052), "") << "pages and views have no frame of reference";
    series.push_back(file.text(0x0020000e));
  }
  EXPECT_NE(series[0], series[1]);
  EXPECT_EQ(series[1], series[2]);
}

TEST(WritePlanObjects, ClassesAndValuesAreThoseOfTheStandard) {
  const ScratchFolder folder;
  write_plan_objects(subject(), folder.path(), scan());
  std::string bytes = tests::bytes_of(folder / "plan.dcm");
  const DicomFile plan(bytes, bytes.size());
  EXPECT_EQ(plan.text(0x00080016), "1.2.840.10008.5.1.4.1.1.104.2");
  EXPECT_EQ(plan.text(0x00420012), "text/XML");
  EXPECT_EQ(plan.text(0x0040e001), "2.25.17");
  EXPECT_EQ(plan.value(0x00420011), std::string("<ClinicalDocument/>\0", 20));
  EXPECT_EQ(plan.unsigned_long(0x00420015), 19U);
  EXPECT_EQ(plan.items(0x00420013).size(), 2U) << "an image is listed once";
  const std::string other = tests::bytes_of(folder / "picture_002.dcm");
  const DicomFile picture(other, other.size());
  EXPECT_EQ(picture.text(0x00080016), "1.2.840.10008.5.1.4.1.1.7");
  EXPECT_EQ(picture.text(0x00280301), "NO");
  EXPECT_EQ(picture.unsigned_short(0x00280010), 1);
  ASSERT_TRUE(picture.raw_pixels());
  EXPECT_EQ(picture.at(*picture.raw_pixels()), std::string("\7\10\11\0", 4));
}

TEST(WritePlanObjects, EqualPlansAreEqualBytesAndOthersHaveOtherNames) {
  const ScratchFolder one, two, three;
  write_plan_objects(subject(), one.path(), std::nullopt);
  write_plan_objects(subject(), two.path(), std::nullopt);
  PlanObjects other = subject();
  other.pictures[1].pixels.rgb[0] = 6;
  write_plan_objects(other, three.path(), std::nullopt);
  for (const char* name : {"plan.dcm", "picture_001.dcm", "picture_002.dcm"}) {
    EXPECT_TRUE(tests::bytes_of(one / name) == tests::bytes_of(two / name)) << name;
    EXPECT_FALSE(tests::bytes_of(one / name) == tests::bytes_of(three / name)) << name;
  }
  other.title.clear();
  EXPECT_THROW(write_plan_objects(other, three.path(), std::nullopt), InvalidInput);
}

}  // namespace
}  // namespace octotomy::voxel
