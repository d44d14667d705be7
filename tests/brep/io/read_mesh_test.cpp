// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/read_mesh.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <zlib.h>

#include "brep/io/write_mesh.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

std::filesystem::path file(const std::string& name, const std::string& bytes) {
  static const tests::ScratchFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return folder / name;
}

Triangles read(const std::string& name, const std::string& bytes) {
  return read_triangles(file(name, bytes));
}

std::string refusal_of(const std::string& name, const std::string& bytes) {
  try {
    read(name, bytes);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

template <typename T>
std::string big(T value) {
  std::string raw(sizeof(T), '\0');
  std::memcpy(raw.data(), &value, sizeof(T));
  if (std::endian::native == std::endian::little) std::reverse(raw.begin(), raw.end());
  return raw;
}

/// A unit square in two triangles, whatever the format says of it.
void expect_square(const Triangles& t) {
  ASSERT_EQ(t.points_mm.size(), 4u);
  ASSERT_EQ(t.faces.size(), 2u);
  const Measures m = measure(mesh_of(t));
  EXPECT_EQ(m.area_mm2, 1.0);
  EXPECT_EQ(m.low_mm, glm::dvec3(0, 0, 0.5));
  EXPECT_EQ(m.high_mm, glm::dvec3(1, 1, 0.5));
  const auto& f = t.faces[0];
  EXPECT_GT(glm::cross(t.points_mm[f[1]] - t.points_mm[f[0]], t.points_mm[f[2]] - t.points_mm[f[0]]).z, 0.0);
}

TEST(ReadMesh, AsciiStlWeldsEqualPoints) {
  expect_square(read(
      "a.stl",
      "solid square with a name\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 5e-1\n   vertex 1 0 .5\n"
      "   vertex +1 1 0.5\n  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   vertex -0 0 0.5\n"
      "   vertex 1 1 0.5\n   vertex 0 1 0.5\n  endloop\n endfacet\nendsolid\n"));
}

TEST(ReadMesh, ABinaryStlMayStartWithTheWordSolid) {
  const auto path = file("b.stl", "");
  write_mesh(mesh_of(shapes::box({0, 0, 0}, {1, 2, 3})), path);
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary) << "solid";
  EXPECT_EQ(read_triangles(path).points_mm.size(), 8u);
}

TEST(ReadMesh, ObjTakesTexturesNegativeNumbersAndPolygons) {
  expect_square(
      read("a.obj",
           "# square\r\nmtllib none\r\nv 0 0 0.5 1.0\r\nv 1 0 0.5\r\nv 1 1 0.5\r\nv 0 1 0.5\r\nvn 0 0 1\r\n"
           "g side\r\nf 1/1/1 2//1 -2 -1\r\nl 1 2\r\n"));
}

TEST(ReadMesh, ObjNamesTheSurfacesLinesAndFilesThatItLeavesOut) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto of_file = [&](const std::string& more) {
    std::string found;
    for (const MeshFinding& each : read_mesh(file("left.obj", triangle + more)).audit)
      if (each.check == "file") found += to_string(each.verdict) + " " + each.detail + "\n";
    return found;
  };
  EXPECT_EQ(of_file("cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 3\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n"),
            "WARN 1 free-form surface is left out, because only polygons are read: export triangles\n");
  EXPECT_NE(of_file("bzp 1 2 3 1 2 3 1 2 3 1 2 3 1 2 3 1\nbsp 1 2 3 1 2 3 1 2 3 1 2 3 1 2 3 1\n")
                .find("WARN 2 free-form surfaces are"),
            std::string::npos);
  EXPECT_NE(of_file("call other.obj\n").find("WARN 1 other file is"), std::string::npos);
  EXPECT_EQ(of_file("l 1 2\nl 2 3\np 1\n"),
            "PASS 2 lines are left out\nPASS 1 element of points is left out\n");
  EXPECT_EQ(of_file("vn 0 0 1\nusemtl surf\ng surf\n"), "");
}

TEST(ReadMesh, OffTakesCommentsColoursAndPolygons) {
  expect_square(read(
      "a.off", "OFF # square\n\n4 1 4\n0 0 0.5\n1 0 0.5\n# half\n1 1 0.5\n0 1 0.5\n4 0 1 2 3 255 0 0\n"));
  expect_square(
      read("b.off",
           "COFF\n4 1 4\n0 0 0.5 1 2 3 4\n1 0 0.5 1 2 3 4\n1 1 0.5 1 2 3 4\n0 1 0.5 1 2 3 4\n4 0 1 2 3\n"));
}

TEST(ReadMesh, BinaryOffSkipsWhatStandsBesideThePlaces) {
  for (const auto& [magic, beside] : {std::pair("OFF", 0), std::pair("COFF", 4), std::pair("STCNOFF", 9)}) {
    std::string bytes = std::string(magic) + " BINARY\n" + big(4) + big(1) + big(0);
    for (const auto& [x, y] : {std::pair{0.f, 0.f}, {1.f, 0.f}, {1.f, 1.f}, {0.f, 1.f}}) {
      bytes += big(x) + big(y) + big(0.5f);
      for (int i = 0; i < beside; ++i) bytes += big(0.25f);
    }
    bytes += big(4);
    for (int i = 0; i < 4; ++i) bytes += big(i);
    bytes += big(1) + big(7);  // its colour's number
    expect_square(read(std::string(magic) + "_binary.off", bytes));
    EXPECT_NE(refusal_of("short.off", bytes.substr(0, 60)), "");
  }
  EXPECT_NE(refusal_of("n.off", "NCOFF BINARY\n" + big(0) + big(0) + big(0)).find("in this order"),
            std::string::npos);
}

TEST(ReadMesh, PlyTakesStripsInBothByteOrders) {
  const std::string elements =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n";
  std::string body;
  for (const auto& [x, y] : {std::pair{0.f, 0.f}, {1.f, 0.f}, {0.f, 1.f}, {1.f, 1.f}})
    body += big(x) + big(y) + big(0.5f);
  body += big(5);
  for (int i = 0; i < 4; ++i) body += big(i);
  body += big(-1);
  expect_square(read("strip.ply", "ply\nformat binary_big_endian 1.0\n" + elements + body));
  expect_square(read("strip_text.ply", "ply\nformat ascii 1.0\n" + elements +
                                           "0 0 0.5\n1 0 0.5\n0 1 0.5\n1 1 0.5\n5 0 1 2 3 -1\n"));
}

TEST(ReadMesh, PlyTakesBothByteOrdersAndSkipsWhatItDoesNotKnow) {
  const std::string elements =
      "comment made by hand\nelement vertex 4\nproperty uchar red\nproperty float x\nproperty double y\n"
      "property float z\nelement extra 1\nproperty list uchar short many\nelement face 1\nproperty list "
      "uchar int "
      "vertex_indices\nproperty short material\nend_header\n";
  expect_square(read("a.ply", "ply\nformat ascii 1.0\n" + elements +
                                  "9 0 0 0.5\n9 1 0 0.5\n9 1 1 0.5\n9 0 1 0.5\n3 7 8 9\n4 0 1 2 3 6\n"));
  std::string body;
  for (const auto& [x, y] : {std::pair{0.f, 0.0}, {1.f, 0.0}, {1.f, 1.0}, {0.f, 1.0}})
    body += big(std::uint8_t{9}) + big(x) + big(y) + big(0.5f);
  body += big(std::uint8_t{2}) + big(std::int16_t{7}) + big(std::int16_t{8});
  body += big(std::uint8_t{4});
  for (int i = 0; i < 4; ++i) body += big(i);
  body += big(std::int16_t{6});
  expect_square(read("b.ply", "ply\nformat binary_big_endian 1.0\n" + elements + body));
  EXPECT_NE(
      refusal_of("c.ply", "ply\nformat binary_big_endian 1.0\n" + elements + body.substr(0, body.size() - 3))
          .find("cut short or damaged"),
      std::string::npos);
}

TEST(ReadMesh, ATextThatIsNoStlIsNamedSo) {
  std::string obj = "# a box\n";
  for (int i = 0; i < 20; ++i) obj += "v 0 0 " + std::to_string(i) + "\n";
  const std::string why = refusal_of("box.stl", obj);
  EXPECT_NE(why.find("text but not STL"), std::string::npos) << why;
  EXPECT_NE(why.find("'# a box'"), std::string::npos) << why;
}

TEST(ReadMesh, LegacyVtkTakesBothLayoutsBinaryAndStrips) {
  const std::string points = "DATASET POLYDATA\nPOINTS 4 float\n0 0 0.5 1 0 0.5 1 1 0.5\n0 1 0.5\n";
  expect_square(
      read("a.vtk", "# vtk DataFile Version 3.0\nsquare\nASCII\n" + points +
                        "LINES 1 3\n2 0 1\nPOLYGONS 1 5\n4 0 1 2 3\nPOINT_DATA 4\nSCALARS s float\n"));
  expect_square(read("b.vtk", "# vtk DataFile Version 5.1\nsquare\nASCII\n" + points +
                                  "METADATA\nINFORMATION 0\n\nPOLYGONS 2 4\nOFFSETS vtktypeint64\n0 4\n"
                                  "CONNECTIVITY vtktypeint64\n0 1 2 3\n"));
  expect_square(read(
      "c.vtk", "# vtk DataFile Version 2.0\nsquare\nASCII\n" + points + "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n"));
  std::string binary = "# vtk DataFile Version 3.0\nsquare\nBINARY\nDATASET POLYDATA\nPOINTS 4 double\n";
  for (const double value : {0., 0., .5, 1., 0., .5, 1., 1., .5, 0., 1., .5}) binary += big(value);
  binary += "\nPOLYGONS 1 5\n";
  for (const int value : {4, 0, 1, 2, 3}) binary += big(value);
  expect_square(read("d.vtk", binary + "\n"));
}

TEST(ReadMesh, CountsBeyondTheFileAreRefusedBeforeAnythingIsAllocated) {
  std::string stl(80, ' ');
  stl += std::string("\xff\xff\xff\x7f", 4) + std::string(50, '\0');
  for (const std::string& refusal :
       {refusal_of("huge.stl", stl), refusal_of("huge.off", "OFF\n2000000000 1 0\n0 0 0\n"),
        refusal_of("faces.off", "OFF\n3 2000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        refusal_of("huge.ply",
                   "ply\nformat ascii 1.0\nelement vertex 2000000000\nproperty float x\nproperty float "
                   "y\nproperty float z\nend_header\n0 0 0\n"),
        refusal_of(
            "huge.vtk",
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2000000000 float\n0 0 0\n")})
    EXPECT_NE(refusal.find("can hold"), std::string::npos) << refusal;
}

TEST(ReadMesh, WhatIsBadIsToldWithPathAndPlace) {
  EXPECT_NE(
      refusal_of("x.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 frog 0\n3 0 1 2\n").find("x.off: line 5: 'frog'"),
      std::string::npos);
  EXPECT_NE(refusal_of("x.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n").find("refers to point 3 of 3"),
            std::string::npos);
  EXPECT_NE(refusal_of("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n")
                .find("line 4: a face refers to point 4, and 3 stand before it"),
            std::string::npos);
  EXPECT_NE(refusal_of("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n").find("polygon of 2"),
            std::string::npos);
  EXPECT_NE(refusal_of("x.gltf", "{\"asset\":{\"version\":\"2.0\"}}").find("save it as .glb"),
            std::string::npos);
  EXPECT_NE(refusal_of("x.obj", "v 0 0 nan\n").find("number"), std::string::npos);
  EXPECT_NE(
      refusal_of("x.stl", "solid cut\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n").find("cut short"),
      std::string::npos);
  EXPECT_NE(
      refusal_of("x.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\n").find("POLYDATA"),
      std::string::npos);
  EXPECT_NE(refusal_of("x.dxf", "0").find("is not a mesh format"), std::string::npos);
  EXPECT_NE(refusal_of("x.ply", "").find("empty"), std::string::npos);
  EXPECT_THROW(read_triangles("/nowhere/at/all.stl"), std::runtime_error);
}

TEST(ReadMesh, CoordinatesWhoseProductsOverflowAreRefused) {
  const auto tetrahedron = [](const std::string& far) {
    return "OFF\n4 4 0\n0 0 0\n" + far + " 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  };
  EXPECT_EQ(read("far.off", tetrahedron("1e19")).points_mm.size(), 4u);
  for (const char* far : {"2e19", "-1e38", "1e300"})
    EXPECT_NE(refusal_of("far.off", tetrahedron(far)).find("far.off: point 1 has a coordinate of "),
              std::string::npos)
        << far;
}

TEST(ReadMesh, NoPrefixOfAFileCrashesTheReader) {
  // Every cut of a small file either reads as fewer triangles or is refused with the path.
  const Mesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 2, 3}));
  for (const char* name : {"cut.ply", "cut.stl", "cut.obj", "cut.off", "cut.vtp"}) {
    const auto path = file(name, "");
    write_mesh(mesh, path);
    std::string bytes(std::filesystem::file_size(path), '\0');
    std::ifstream(path, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    int refused = 0;
    for (std::size_t size = 0; size < bytes.size(); size += 11) {
      try {
        EXPECT_LE(read(name, bytes.substr(0, size)).faces.size(), 12u);
      } catch (const std::runtime_error& e) {
        ++refused;
        EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
      }
    }
    EXPECT_GT(refused, 0) << name;
  }
}

std::string base64(const std::string& bytes) {
  constexpr const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : letters[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

template <typename T>
std::string raw(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

/// A tetrahedron's arrays, each as `array` writes its bytes.
template <typename Array>
std::string vtp(const std::string& attributes, const Array& array) {
  return "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" " + attributes +
         "><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\"><Points>" +
         array("type=\"Float32\" Name=\"P\"", raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1.5F})) +
         "</Points><Polys>" +
         array("type=\"Int32\" Name=\"connectivity\"",
               raw<std::int32_t>({0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3})) +
         array("type=\"Int32\" Name=\"offsets\"", raw<std::int32_t>({3, 6, 9, 12})) +
         "</Polys></Piece></PolyData></VTKFile>";
}

TEST(ReadMesh, VtpAsTextBase64AndPackedIsTheSameTetrahedron) {
  const std::string text = vtp("", [](const std::string& names, const std::string& bytes) {
    std::string numbers;
    for (std::size_t i = 0; i < bytes.size(); i += 4) {
      float real;
      std::int32_t whole;
      std::memcpy(&real, bytes.data() + i, 4);
      std::memcpy(&whole, bytes.data() + i, 4);
      numbers += (names.find("Float") != names.npos ? std::to_string(real) : std::to_string(whole)) + "\n ";
    }
    return "<DataArray " + names + " format=\"ascii\">\n" + numbers + "</DataArray>";
  });
  const std::string inlined =
      vtp("header_type=\"UInt64\"", [](const std::string& names, const std::string& bytes) {
        return "<DataArray " + names + " format=\"binary\">\n  " +
               base64(raw<std::uint64_t>({bytes.size()}) + bytes) + "\n</DataArray>";
      });
  const std::string packed =
      vtp("compressor=\"vtkZLibDataCompressor\"", [](const std::string& names, const std::string& bytes) {
        // Two blocks, the last one shorter.
        std::string blocks;
        std::vector<std::uint32_t> header = {
            2, 20, static_cast<std::uint32_t>(bytes.size() > 20 ? bytes.size() - 20 : 0)};
        if (bytes.size() <= 20) header = {1, static_cast<std::uint32_t>(bytes.size()), 0};
        for (std::size_t at = 0; at < bytes.size(); at += 20) {
          const std::string part = bytes.substr(at, header[0] == 1 || at == 0 ? 20 : bytes.npos);
          std::string small(compressBound(part.size()), ' ');
          uLongf length = small.size();
          compress(reinterpret_cast<Bytef*>(small.data()), &length,
                   reinterpret_cast<const Bytef*>(part.data()), part.size());
          header.push_back(static_cast<std::uint32_t>(length));
          blocks += small.substr(0, length);
          if (at > 0) break;
        }
        return "<DataArray " + names + " format=\"binary\">" + base64(raw(header)) + base64(blocks) +
               "</DataArray>";
      });
  for (const std::string& bytes : {text, inlined, packed}) {
    const Triangles triangles = read("tetrahedron.vtp", bytes);
    EXPECT_EQ(triangles.points_mm.size(), 4u);
    EXPECT_NEAR(size_of(triangles).volume_mm3, 0.25, 1e-12);
  }
  EXPECT_NE(
      refusal_of("lzma.vtp", "<VTKFile type=\"PolyData\" compressor=\"vtkLZMADataCompressor\">").find("LZMA"),
      std::string::npos);
  EXPECT_NE(refusal_of("grid.vtp", "<VTKFile type=\"ImageData\">").find("PolyData"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::brep
