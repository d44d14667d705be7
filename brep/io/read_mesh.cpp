// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/read_mesh.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t stl_header_bytes = 84, stl_triangle_bytes = 50;

Triangles read_binary_stl(std::string_view bytes) {
  MeshScanner scanner(bytes);
  scanner.skip(80);
  const std::size_t count =
      scanner.bounded(scanner.binary<std::uint32_t>(std::endian::little), stl_triangle_bytes);
  Triangles triangles;
  triangles.faces.reserve(count);
  PointNumbers numbers(triangles.points_mm, count / 2);  // as a closed surface has
  constexpr std::size_t most_at_once = 64;
  std::array<glm::dvec3, 3 * most_at_once> corners;
  std::array<std::uint32_t, 3 * most_at_once> points;
  for (std::size_t begin = 0; begin < count; begin += most_at_once) {
    const std::size_t end = std::min(begin + most_at_once, count);
    for (std::size_t i = begin; i < end; ++i) {
      scanner.skip(12);
      for (std::size_t k = 0; k < 3; ++k) {
        glm::dvec3& p = corners[3 * (i - begin) + k];
        for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.binary<float>(std::endian::little);
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
          scanner.fail("triangle " + std::to_string(i) + " has a point that is not finite");
      }
      scanner.skip(2);
    }
    const std::size_t met = 3 * (end - begin);
    numbers.number({corners.data(), met}, {points.data(), met});
    for (std::size_t k = 0; k < met; k += 3)
      triangles.faces.push_back({points[k], points[k + 1], points[k + 2]});
  }
  return triangles;
}

Triangles read_ascii_stl(std::string_view bytes) {
  MeshScanner scanner(bytes);
  scanner.line();
  Triangles triangles;
  PointNumbers numbers(triangles.points_mm);
  std::vector<std::uint32_t> corners;
  bool ended = false;
  for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
    if (word == "vertex") {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.number();
      corners.push_back(numbers.number_of(p));
    } else if (word == "endloop") {
      if (corners.size() != 3)
        scanner.fail("a facet of " + std::to_string(corners.size()) + " vertices; STL has triangles only");
      triangles.faces.push_back({corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (word == "solid" || word == "endsolid") {
      ended = word == "endsolid";
      scanner.line();
    } else if (word == "facet") {
      scanner.line();
    } else if (word != "outer" && word != "loop" && word != "endfacet") {
      scanner.fail("'" + std::string(word.substr(0, 40)) + "' is no word of STL");
    }
  }
  if (!ended) scanner.fail("the file ends without 'endsolid': it is cut short");
  return triangles;
}

/// The size decides, as binary files that start with "solid" are common.
Triangles read_stl(std::string_view bytes) {
  if (bytes.size() >= stl_header_bytes) {
    MeshScanner scanner(bytes);
    scanner.skip(80);
    const std::uint64_t count = scanner.binary<std::uint32_t>(std::endian::little);
    if (stl_header_bytes + count * stl_triangle_bytes == bytes.size()) return read_binary_stl(bytes);
  }
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  if (start != std::string_view::npos && bytes.substr(start).starts_with("solid"))
    return read_ascii_stl(bytes.substr(start));
  if (bytes.size() < stl_header_bytes) throw Error(ErrorCode::Input, "too short for an STL file");
  return read_binary_stl(bytes);
}

Triangles read_obj(std::string_view bytes) {
  MeshScanner scanner(bytes);
  scanner.comments_start_with_hash();
  Triangles triangles;
  std::vector<long long> corners;
  while (!scanner.at_end()) {
    const std::string_view key = scanner.word();
    if (key == "v") {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.number();
      triangles.points_mm.push_back(p);
    } else if (key == "f") {
      corners.clear();
      for (std::string_view word = scanner.word(true); !word.empty(); word = scanner.word(true)) {
        if (word == "\\") {
          scanner.line();
          continue;
        }
        // Negative numbers count back from the last point read.
        const long long given = integer_of(word.substr(0, word.find('/')));
        if (given == 0) scanner.fail("a face refers to point 0; OBJ counts from 1");
        corners.push_back(given > 0 ? given - 1 : given + static_cast<long long>(triangles.points_mm.size()));
      }
      try {
        add_fan(triangles, corners);
      } catch (const std::runtime_error& e) {
        scanner.fail(e.what());
      }
    }
    scanner.line();
  }
  return triangles;
}

Triangles read_off(std::string_view bytes) {
  MeshScanner scanner(bytes);
  scanner.comments_start_with_hash();
  // Prefixes tell of colours (C), normals (N), textures (ST) behind each point; 4 and n change the dimension.
  const std::string_view magic = scanner.word();
  if (!magic.ends_with("OFF") || magic.find_first_of("4n") != std::string_view::npos)
    scanner.fail("an OFF file of points in space starts with OFF, COFF, NOFF or STOFF");
  const long long point_count = scanner.integer(), face_count = scanner.integer();
  scanner.line();  // the number of edges, which nobody keeps right
  Triangles triangles;
  // The least row of a point is "0 0 0", of a face "1 0", each with the end of its line.
  const std::size_t points = scanner.bounded(point_count, 5);
  triangles.points_mm.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.number();
    triangles.points_mm.push_back(p);
    scanner.line();
  }
  const std::size_t faces = scanner.bounded(face_count, 3);
  std::vector<long long> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    const std::size_t corner_count = scanner.count(1);
    corners.clear();
    for (std::size_t k = 0; k < corner_count; ++k) corners.push_back(scanner.integer());
    try {
      add_fan(triangles, corners);
    } catch (const std::runtime_error& e) {
      scanner.fail(e.what());
    }
    scanner.line();
  }
  return triangles;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::error_code error;
  // A pipe or a device may never end.
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    throw Error(ErrorCode::Input, "is no regular file: copy it into one first");
  std::ifstream file(path, std::ios::binary);
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!file || error) throw Error(ErrorCode::Input, "cannot be read; check its name and rights");
  std::string bytes(size, '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw Error(ErrorCode::Input, "reading broke off");
  return bytes;
}

/// Sums of a thousand products of sixteen coordinates are finite up to it. The longest products known are of
/// six: the oriented box compares fractions of areas by squares of sides (CGAL, Area_less_rectangle_2).
const double largest_coordinate_mm =
    std::pow(std::numeric_limits<double>::max() / 1e3, 1.0 / 16.0);  // 1.2e19

Triangles within_reach(Triangles triangles) {
  for (std::size_t i = 0; i < triangles.points_mm.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (const double x = triangles.points_mm[i][axis]; std::abs(x) > largest_coordinate_mm)
        throw Error(ErrorCode::Input, "point " + std::to_string(i) + " has a coordinate of " + short_text(x) +
                                          " mm, beyond the largest, " + short_text(largest_coordinate_mm) +
                                          " mm: is the file damaged, or its unit another one?");
  return triangles;
}

Triangles read_any(const std::string& bytes, const std::string& extension) {
  if (extension == ".stl") return read_stl(bytes);
  if (extension == ".ply") return read_ply(bytes);
  if (extension == ".obj") return read_obj(bytes);
  if (extension == ".off") return read_off(bytes);
  return extension == ".vtk" ? read_vtk(bytes) : read_vtp(bytes);
}

}  // namespace

Triangles read_triangles(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  try {
    if (extension != ".stl" && extension != ".ply" && extension != ".obj" && extension != ".off" &&
        extension != ".vtk" && extension != ".vtp")
      throw Error(
          ErrorCode::Input,
          "'" + extension + "' is no mesh format that is read; use .stl, .ply, .obj, .off, .vtk or .vtp");
    const std::string bytes = bytes_of(path);
    if (bytes.empty()) throw Error(ErrorCode::Input, "the file is empty");
    return within_reach(read_any(bytes, extension));
  } catch (const std::runtime_error& e) {
    throw Error(ErrorCode::Input, path.string() + ": " + e.what());
  }
}

}  // namespace octotomy::brep
