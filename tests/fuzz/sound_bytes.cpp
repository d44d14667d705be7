// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/fuzz/sound_bytes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "tests/fuzz/mutation.h"
#include "tests/voxel/scan/dicom_bytes.h"

namespace octotomy::tests {
namespace {

/// Numbers of a header, little-endian.
template <typename Number>
void put(std::string& bytes, std::size_t at, Number number) {
  std::copy_n(reinterpret_cast<const char*>(&number), sizeof number,
              bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

constexpr std::uint32_t width = 16, height = 12;  // of pictures

/// The shade of a pixel, 0 to 255.
std::uint32_t shade(std::uint32_t pixel) {
  return (37 * pixel) % 256;
}

}  // namespace

std::string nifti2() {
  std::string bytes(544 + 6 * 5 * 4 * 2, '\0');
  put(bytes, 0, std::int32_t{540});
  bytes.replace(4, 8, std::string("n+2\0\r\n\x1a\n", 8));
  put(bytes, 12, std::int16_t{4});
  put(bytes, 14, std::int16_t{16});
  for (std::size_t axis = 0; axis < 8; ++axis)
    put(bytes, 16 + 8 * axis, std::array<std::int64_t, 8>{3, 6, 5, 4, 1, 1, 1, 1}[axis]);
  for (std::size_t axis = 0; axis < 4; ++axis) put(bytes, 104 + 8 * axis, 1.0);
  put(bytes, 168, std::int64_t{544});
  put(bytes, 176, 1.0);
  put(bytes, 344, std::int32_t{1});
  for (std::size_t i = 0; i < 6 * 5 * 4; ++i) put(bytes, 544 + 2 * i, static_cast<std::int16_t>(10 * i));
  return bytes;
}

std::string tiff() {
  std::string bytes = std::string("II*\0", 4) + DicomBytes::number(8, 4);
  const std::array<std::array<std::uint32_t, 3>, 9> entries{{{256, 3, 16},
                                                             {257, 3, 12},
                                                             {258, 3, 16},
                                                             {259, 3, 1},
                                                             {262, 3, 1},
                                                             {273, 4, 8 + 2 + 9 * 12 + 4},
                                                             {277, 3, 1},
                                                             {278, 3, 12},
                                                             {279, 4, 16 * 12 * 2}}};
  bytes += DicomBytes::number(static_cast<std::uint32_t>(entries.size()), 2);
  for (const auto& [tag, type, value] : entries)
    bytes += DicomBytes::number(tag, 2) + DicomBytes::number(type, 2) + DicomBytes::number(1, 4) +
             DicomBytes::number(value, 4);
  bytes += DicomBytes::number(0, 4);
  for (std::uint32_t i = 0; i < 16 * 12; ++i) bytes += DicomBytes::number(1000 + 37 * i % 5000, 2);
  return bytes;
}

std::string bmp() {
  std::string bytes = "BM";
  for (const std::uint32_t number : {54 + 3 * width * height, 0u, 54u, 40u, width, height})
    bytes += DicomBytes::number(number, 4);
  bytes += DicomBytes::number(1, 2) + DicomBytes::number(24, 2);
  for (const std::uint32_t number : {0u, 3 * width * height, 2835u, 2835u, 0u, 0u})
    bytes += DicomBytes::number(number, 4);
  for (std::uint32_t i = 0; i < width * height; ++i) bytes += std::string(3, static_cast<char>(shade(i)));
  return bytes;
}

std::string pgm() {
  std::string bytes = "P5\n16 12\n255\n";
  for (std::uint32_t i = 0; i < width * height; ++i) bytes += static_cast<char>(shade(i));
  return bytes;
}

std::string exr() {
  std::string bytes = DicomBytes::number(20000630, 4) + DicomBytes::number(2, 4);
  const auto attribute = [&](const std::string& name, const std::string& type, const std::string& value) {
    bytes +=
        name + '\0' + type + '\0' + DicomBytes::number(static_cast<std::uint32_t>(value.size()), 4) + value;
  };
  const auto numbers = [](std::initializer_list<std::uint32_t> all) {
    std::string text;
    for (const std::uint32_t number : all) text += DicomBytes::number(number, 4);
    return text;
  };
  const auto floating = [](float number) {
    return DicomBytes::number(std::bit_cast<std::uint32_t>(number), 4);
  };
  const std::string window = numbers({0, 0, width - 1, height - 1});
  attribute("channels", "chlist", std::string("Y\0", 2) + numbers({2, 0, 1, 1}) + '\0');  // 2: floats
  attribute("compression", "compression", std::string(1, '\0'));
  attribute("dataWindow", "box2i", window);
  attribute("displayWindow", "box2i", window);
  attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  attribute("pixelAspectRatio", "float", floating(1));
  attribute("screenWindowCenter", "v2f", floating(0) + floating(0));
  attribute("screenWindowWidth", "float", floating(1));
  bytes += '\0';
  const std::size_t rows = bytes.size() + std::size_t{8} * height;
  for (std::uint32_t y = 0; y < height; ++y)
    bytes += numbers({static_cast<std::uint32_t>(rows) + y * (8 + 4 * width), 0});
  for (std::uint32_t y = 0; y < height; ++y) {
    bytes += numbers({y, 4 * width});
    for (std::uint32_t x = 0; x < width; ++x) bytes += floating(static_cast<float>(shade(y * width + x)));
  }
  return bytes;
}

std::string vtk() {
  return "# vtk DataFile Version 3.0\ntetrahedron\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
         "0 0 0  10 0 0  0 10 0  0 0 10\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
}

std::string vtk_binary() {
  std::string bytes = "# vtk DataFile Version 3.0\ntetrahedron\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n";
  const auto put_big = [&](std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift & 0xff);
  };
  for (const float coordinate : {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10})
    put_big(std::bit_cast<std::uint32_t>(coordinate));
  bytes += "\nPOLYGONS 4 16\n";
  for (const std::uint32_t word : {3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 3, 2}) put_big(word);
  return bytes + "\n";
}

std::string vtp_text() {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n"
         "<PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\">\n"
         "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
         "0 0 0 10 0 0 0 10 0 0 0 10</DataArray></Points>\n<Polys>"
         "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 1 2 3 0 3 "
         "2</DataArray>"
         "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray>"
         "</Polys></Piece></PolyData></VTKFile>\n";
}

std::string stl_text() {
  std::string text = "solid tetrahedron\n";
  for (const char* facet :
       {"0 0 0:0 10 0:10 0 0", "0 0 0:10 0 0:0 0 10", "10 0 0:0 10 0:0 0 10", "0 0 0:0 0 10:0 10 0"}) {
    std::string vertices = facet;
    for (std::size_t at = 0; (at = vertices.find(':')) != std::string::npos;)
      vertices.replace(at, 1, "\n vertex ");
    text += "facet normal 0 0 0\n outer loop\n vertex " + vertices + "\n endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

std::string ply_text() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
}

std::string frd() {
  constexpr const char* nodes =
      " -1         1-1.00000E+00-1.00000E+00-1.00000E+00\n"
      " -1         2 4.00000E+01 0.00000E+00 0.00000E+00\n"
      " -1         3 0.00000E+00 4.00000E+01 0.00000E+00\n"
      " -1         4 0.00000E+00 0.00000E+00 4.00000E+01\n"
      " -3\n";
  return std::string("    1C\n    2C                             4\n") + nodes +
         "    3C                             1\n -1         1    3    0    1\n"
         " -2         1         2         3         4\n -3\n"
         "    1PSTEP                         1           1           1\n"
         "  100CL  101 1.000000000           4                     0    1           1\n"
         " -4  DISP        4    1\n -5  D1          1    2    1    0\n" +
         nodes + " 9999\n";
}

std::string gzip_bomb() {
  return packed(std::string(std::size_t{1} << 26, '\0'));
}

}  // namespace octotomy::tests
