// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/write_dicom_document.h"

#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/dicom/dicom_file.h"

namespace octotomy::voxel {
namespace {

using tests::ScratchFolder;

TEST(WriteDicomDocument, HoldsTheFileByteForByteInMillimetres) {
  const ScratchFolder folder;
  DicomDocumentOptions options;
  options.source.emplace();
  options.source->series_uid = "1.2.3";
  options.source->attributes[0x00100020] = {"LO", "A17"};
  options.source->attributes[0x00200052] = {"UI", "1.2.5"};
  for (const char* uid : {"1.2.3.1", "1.2.3.1", "1.2.3.2"})
    options.source->images.push_back({"1.2.840.10008.5.1.4.1.1.2", uid, 0.0});
  const std::string stl("solid a\nendsolid\0\x01", 18);
  for (const DocumentFormat format : {DocumentFormat::Stl, DocumentFormat::Obj}) {
    const bool is_stl = format == DocumentFormat::Stl;
    // An odd length is padded, and its own length stated.
    const std::string model = is_stl ? stl : stl + "\n";
    write_dicom_document(model, format, folder / "x.dcm", options);
    const std::string bytes = tests::bytes_of(folder / "x.dcm");
    const DicomFile file(bytes, bytes.size());
    EXPECT_EQ(file.text(0x00080016),
              is_stl ? "1.2.840.10008.5.1.4.1.1.104.3" : "1.2.840.10008.5.1.4.1.1.104.4");
    EXPECT_EQ(file.text(0x00420012), is_stl ? "model/stl" : "model/obj");
    EXPECT_EQ(file.unsigned_long(0x00420015), model.size());
    EXPECT_EQ(file.length(0x00420011), model.size() + model.size() % 2);
    EXPECT_NE(bytes.find(model), std::string::npos);
    EXPECT_EQ(file.items(0x004008ea).front().text(0x00080100), "mm");
    EXPECT_EQ(file.items(0x004008ea).front().text(0x00080102), "UCUM");
    EXPECT_EQ(file.text(0x00100020), "A17");
    EXPECT_EQ(file.text(0x00200052), "1.2.5");
    EXPECT_EQ(file.items(0x00420013).size(), 2U) << "an image is listed once";
  }
}

TEST(WriteDicomDocument, APdfIsOfThePatientAndInNoFrame) {
  const ScratchFolder folder;
  DicomDocumentOptions options{.label = "Plan"};
  options.source.emplace();
  options.source->series_uid = "1.2.3";
  options.source->attributes[0x00100020] = {"LO", "A17"};
  options.source->attributes[0x00200052] = {"UI", "1.2.5"};
  options.source->images.push_back({"1.2.840.10008.5.1.4.1.1.2", "1.2.3.1", 0.0});
  const std::string pdf = "%PDF-1.4 %%EOF";
  write_dicom_document(pdf, DocumentFormat::Pdf, folder / "x.dcm", options);
  const std::string bytes = tests::bytes_of(folder / "x.dcm");
  const DicomFile file(bytes, bytes.size());
  EXPECT_EQ(file.text(0x00080016), "1.2.840.10008.5.1.4.1.1.104.1");
  EXPECT_EQ(file.text(0x00420012), "application/pdf");
  EXPECT_EQ(file.text(0x00080060), "DOC");
  EXPECT_EQ(file.text(0x00280301), "YES");
  EXPECT_EQ(file.text(0x00100020), "A17");
  EXPECT_EQ(file.text(0x00200052), "");
  EXPECT_TRUE(file.items(0x004008ea).empty());
  EXPECT_EQ(file.items(0x00420013).size(), 1U);
  EXPECT_NE(bytes.find(pdf), std::string::npos);
}

TEST(WriteDicomDocument, EqualContentIsWrittenAsEqualBytes) {
  const ScratchFolder folder;
  write_dicom_document("solid", DocumentFormat::Stl, folder / "x.dcm");
  write_dicom_document("solid", DocumentFormat::Stl, folder / "y.dcm");
  EXPECT_TRUE(tests::bytes_of(folder / "x.dcm") == tests::bytes_of(folder / "y.dcm"));
  EXPECT_THROW(write_dicom_document("", DocumentFormat::Stl, folder / "z.dcm"), std::invalid_argument);
  EXPECT_THROW(write_dicom_document("solid", DocumentFormat::Stl, folder / "z.dcm", {.label = ""}),
               std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "z.dcm"));
}

}  // namespace
}  // namespace octotomy::voxel
