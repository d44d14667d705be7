// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/fuzz/sound_bytes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "tests/fuzz/mutation.h"

namespace octotomy::tests {
namespace {

/// Numbers of a header, little-endian.
template <typename Number>
void put(std::string& bytes, std::size_t at, Number number) {
  std::copy_n(reinterpret_cast<const char*>(&number), sizeof number,
              bytes.begin() + static_cast<std::ptrdiff_t>(at));
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

std::string vtk() {
  return "# vtk DataFile Version 3.0\ntetrahedron\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
         "0 0 0  30 0 0  0 30 0  0 0 30\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
}

std::string vtk_grid() {
  return "# vtk DataFile Version 5.1\nSPACE=RAS\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\n"
         "SPACE 1 1 string\nRAS\n\nn 2 1 int\n1 2\nMETADATA\nINFORMATION 0\n\nPOINTS 8 double\n"
         "0 0 0 30 0 0 30 30 0 0 30 0 0 0 30 30 0 30 30 30 30 0 30 30\nCELLS 2 8\nOFFSETS vtktypeint64\n0 8\n"
         "CONNECTIVITY vtktypeint64\n0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n";
}

std::string vtu_text() {
  const auto array = [](const std::string& head, const std::string& numbers) {
    return "<DataArray " + head + " format=\"ascii\">" + numbers + "</DataArray>\n";
  };
  return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>\n<FieldData>"
         "<Array type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">82 65 83 0</Array>"
         "</FieldData><Piece NumberOfPoints=\"8\" NumberOfCells=\"1\">\n<Points>" +
         array("type=\"Float32\" NumberOfComponents=\"3\"",
               "0 0 0 30 0 0 30 30 0 0 30 0 0 0 30 30 0 30 30 30 30 0 30 30") +
         "</Points><Cells>" + array("type=\"Int32\" Name=\"connectivity\"", "0 1 2 3 4 5 6 7") +
         array("type=\"Int32\" Name=\"offsets\"", "8") + array("type=\"UInt8\" Name=\"types\"", "12") +
         "</Cells></Piece></UnstructuredGrid></VTKFile>\n";
}

std::string obj_polygons() {
  return "# File units = mm\nv 20 0 0\nv 20 5 0\nv 5 5 0\nv 5 20 0\nv 0 20 0\nv 0 0 0\nv 20 0 10\nv 20 5 10\n"
         "v 5 5 10\nv 5 20 10\nv 0 20 10\nv 0 0 10\nf 1 6 5 4 3 2\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\n"
         "f 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf -7 -12 -6 -1\n";
}

std::string model_3mf() {
  return "<model unit=\"centimeter\"><resources><object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" "
         "z=\"0\"/><vertex x=\"3\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"3\" z=\"0\"/><vertex x=\"0\" y=\"0\" "
         "z=\"3\"/></vertices><triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" "
         "v3=\"3\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"0\" v2=\"3\" "
         "v3=\"2\"/></triangles></mesh></object><object id=\"2\"><components><component "
         "objectid=\"1\"/><component "
         "objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 9 0 "
         "0\"/></components></object></resources><build><item "
         "objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 2\"/></build></model>";
}

std::string vtk_binary() {
  std::string bytes = "# vtk DataFile Version 3.0\ntetrahedron\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n";
  const auto put_big = [&](std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift & 0xff);
  };
  for (const float coordinate : {0, 0, 0, 30, 0, 0, 0, 30, 0, 0, 0, 30})
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
         "0 0 0 30 0 0 0 30 0 0 0 30</DataArray></Points>\n<Polys>"
         "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 1 2 3 0 3 "
         "2</DataArray>"
         "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray>"
         "</Polys></Piece></PolyData></VTKFile>\n";
}

std::string stl_text() {
  std::string text = "solid tetrahedron\n";
  for (const char* facet :
       {"0 0 0:0 30 0:30 0 0", "0 0 0:30 0 0:0 0 30", "30 0 0:0 30 0:0 0 30", "0 0 0:0 0 30:0 30 0"}) {
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
         "0 0 0\n30 0 0\n0 30 0\n0 0 30\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
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
