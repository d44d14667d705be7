// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/dicom_model.h"

#include <fstream>
#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/error.h"
#include "tests/brep/shapes.h"
#include "tests/file_bytes.h"
#include "tests/voxel/scan/dicom_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

using D = tests::DicomBytes;
using tests::ScratchFolder;

/// STL as text of a box from 0 to these coordinates, without a word on its unit.
std::string stl_box(const glm::dvec3& high) {
  const Triangles box = shapes::box({0, 0, 0}, high);
  std::string text = "solid box\n";
  for (const auto& face : box.faces) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : face)
      text += "vertex " + std::to_string(box.points_mm[v].x) + " " + std::to_string(box.points_mm[v].y) +
              " " + std::to_string(box.points_mm[v].z) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid box\n";
}

/// A file that states a unit by this code; empty: none. The sequences before the document are open.
std::string dicom(const std::string& document, const std::string& code, const std::string& type = "model/stl",
                  std::uint32_t more = 0) {
  const std::string inside =
      D::item(D::element(0x00080100, "SH", code) + D::element(0x00080102, "SH", "UCUM"), true);
  const std::string meta = D::element(0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.104.3") +
                           D::element(0x00020010, "UI", "1.2.840.10008.1.2.1");
  return std::string(128, '\0') + "DICM" +
         D::element(0x00020000, "UL", D::number(static_cast<std::uint32_t>(meta.size()), 4)) + meta +
         D::element(0x00100020, "LO", "A17") + D::element(0x00200052, "UI", "1.2.5") +
         (code.empty() ? "" : D::sequence(0x004008ea, inside, true)) +
         D::element(0x00420011, "OB", document) + D::element(0x00420012, "LO", type) +
         D::element(0x00420015, "UL", D::number(static_cast<std::uint32_t>(document.size()) + more, 4));
}

MeshFile read(const std::string& bytes) {
  const ScratchFolder folder;
  std::ofstream(folder / "x.dcm", std::ios::binary) << bytes;
  EXPECT_TRUE(is_mesh_file(folder / "x.dcm"));
  return read_mesh(folder / "x.dcm");
}

std::string refusal(const std::string& bytes) {
  try {
    read(bytes);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const MeshFinding& model_finding(const MeshFile& file, const std::string& check) {
  for (const MeshFinding& each : file.audit)
    if (each.check == check) return each;
  throw std::runtime_error("no line about " + check);
}

TEST(DicomModel, HasTheUnitOfTheDicomHeader) {
  struct Case {
    const char* code;
    double mm;
  };
  for (const auto& [code, mm] :
       {Case{"mm", 1.0}, {"um", 0.001}, {"cm", 10.0}, {"m", 1000.0}, {"[in_i]", 25.4}}) {
    SCOPED_TRACE(code);
    const MeshFile file = read(dicom(stl_box({10, 20, 30}), code));
    EXPECT_LT(glm::distance(file.extent().high_mm, mm * glm::dvec3(10, 20, 30)), 1e-6 * mm);
    EXPECT_EQ(model_finding(file, "unit").verdict, MeshVerdict::Pass);
    EXPECT_NE(model_finding(file, "unit").detail.find(code), std::string::npos);
    EXPECT_EQ(model_finding(file, "frame").verdict, MeshVerdict::Pass);
    EXPECT_NE(model_finding(file, "file").detail.find("'A17'"), std::string::npos);
  }
}

TEST(DicomModel, AMissingUnitIsAWarning) {
  const MeshFile file = read(dicom(stl_box({10, 20, 30}), ""));
  EXPECT_EQ(model_finding(file, "unit").verdict, MeshVerdict::Warn);
  EXPECT_EQ(file.extent().high_mm, glm::dvec3(10, 20, 30));
}

TEST(DicomModel, AContradictionOfTheSurfaceIsRefused) {
  const ScratchFolder folder;
  write_mesh(shapes::box({0, 0, 0}, {10, 20, 30}), folder / "x.stl");
  const std::string stl = tests::bytes_of(folder / "x.stl");  // states millimetres
  EXPECT_EQ(read(dicom(stl, "mm")).extent().high_mm, glm::dvec3(10, 20, 30));
  EXPECT_NE(refusal(dicom(stl, "um")).find("contradicts itself"), std::string::npos);
}

TEST(DicomModel, RefusesDamageWithItsReason) {
  const std::string whole = dicom(stl_box({10, 20, 30}), "mm");
  EXPECT_NE(refusal(dicom(stl_box({1, 1, 1}), "mm", "application/pdf")).find("application/pdf"),
            std::string::npos);
  EXPECT_NE(refusal(dicom(stl_box({1, 1, 1}), "mm", "model/stl", 100)).find("cut short"), std::string::npos);
  EXPECT_NE(refusal(whole.substr(0, whole.size() / 2)).find("cut short"), std::string::npos);
  // Any byte of it spoiled, and any beginning of it: read or refused.
  int refused = 0;
  for (std::size_t at = 132; at < whole.size(); at += 7) {
    std::string mutant = whole;
    mutant[at] = static_cast<char>(mutant[at] ^ 0x7f);
    for (const std::string& bytes : {mutant, whole.substr(0, at)}) {
      try {
        read_dicom_model(bytes);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Input) << error.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 50);
}

TEST(DicomModel, OtherDicomIsNoSurface) {
  const ScratchFolder folder;
  std::ofstream(folder / "x.dcm", std::ios::binary)
      << D::file("1.2.840.10008.1.2.1", D::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2"));
  EXPECT_FALSE(is_mesh_file(folder / "x.dcm"));
  EXPECT_FALSE(is_mesh_file(folder / "absent.dcm"));
}

}  // namespace
}  // namespace octotomy::brep
