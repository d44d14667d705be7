// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads STL. The file's length decides whether it is binary, not its first word: binary files that begin with
// "solid" are common. If the count and the length of a binary file disagree:
// - fewer bytes than a triangle has follow the counted triangles: these bytes are ignored and reported;
// - whole triangles follow: the count is too small, as when a writer stopped before updating it; they are
//   read, with a warning;
// - the count is larger than the file: it is truncated, and refused.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::uint64_t count_of(std::string_view bytes) {
  MeshScanner scanner(bytes);
  scanner.skip(80);
  return scanner.binary<std::uint32_t>(std::endian::little);
}

/// Whether 50 bytes can be a triangle: its corners are finite, of usual size and not all zero, and its normal
/// has unit length or is zero.
bool is_triangle(std::string_view bytes) {
  MeshScanner scanner(bytes);
  std::array<double, 12> numbers{};
  for (double& number : numbers) number = scanner.binary<float>(std::endian::little);
  bool any = false;
  for (const double number : numbers) {
    const double size = std::abs(number);
    if (!(size < 1e9) || (size > 0.0 && size < 1e-20)) return false;
    any = any || size > 0.0;
  }
  const double length = std::hypot(numbers[0], numbers[1], numbers[2]);
  return any && (length == 0.0 || std::abs(length - 1.0) < 0.01);
}

/// The number of triangles to read, from the header's count and the file's length.
std::size_t triangles_held(std::string_view bytes, MeshStatements& says) {
  const std::uint64_t count = count_of(bytes);
  const std::uint64_t held = (bytes.size() - header_bytes) / triangle_bytes;
  const std::string_view header = bytes.substr(0, header_bytes);
  const bool is_text = std::all_of(header.begin(), header.end(), [](unsigned char letter) {
    return (letter >= ' ' && letter < 0x7f) || letter == '\n' || letter == '\r' || letter == '\t';
  });
  if (count > held && is_text)
    throw Error(ErrorCode::Input,
                "is text but not STL, and begins with '" +
                    std::string(header.substr(0, std::min(header.find_first_of("\r\n"), std::size_t{40}))) +
                    "': give it the extension of its format");
  if (count > held)
    throw Error(ErrorCode::Input, "the header counts " + std::to_string(count) +
                                      " triangles, more than the rest of the file can hold, " +
                                      std::to_string(held) + ": it is cut short or damaged; export it again");
  const std::uint64_t behind = bytes.size() - header_bytes - count * triangle_bytes;
  if (behind == 0) return static_cast<std::size_t>(count);
  std::uint64_t more = 0;
  while (count + more < held &&
         is_triangle(bytes.substr(header_bytes + (count + more) * triangle_bytes, triangle_bytes)))
    ++more;
  if (count + more == held && more > 0) {
    says.warn("file", "the header counts " + std::to_string(count) + " triangles, the file holds " +
                          std::to_string(held) + ": all are read");
    return static_cast<std::size_t>(held);
  }
  const std::string left = std::to_string(behind) + " bytes after the " + std::to_string(count) +
                           " triangles that the header counts are left out";
  behind < triangle_bytes ? says.tell("file", left) : says.warn("file", left);
  return static_cast<std::size_t>(count);
}

MeshContent read_binary(std::string_view bytes) {
  MeshContent made;
  const std::string_view header = bytes.substr(0, 80);
  made.says.read_text(header.substr(0, header.find('\0')), "the header");
  made.says.add_writer(header);
  const std::size_t count = triangles_held(bytes, made.says);
  MeshScanner scanner(bytes);
  scanner.skip(header_bytes);
  Triangles& triangles = made.triangles;
  triangles.faces.reserve(count);
  PointNumbers numbers(triangles.points_mm, count / 2);  // the number of points of a closed surface
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
  made.polygons.faces = count;
  return made;
}

/// Accepts words in any case, separated by blanks of any kind.
MeshContent read_text(std::string_view bytes) {
  MeshScanner scanner(bytes);
  MeshContent made;
  Triangles& triangles = made.triangles;
  PointNumbers numbers(triangles.points_mm);
  std::vector<std::uint32_t> corners;
  std::size_t solids = 0;
  bool ended = false;
  for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
    const auto is = [word](std::string_view known) {
      return word.size() == known.size() && starts_in_any_case(word, known);
    };
    if (is("vertex")) {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.number();
      corners.push_back(numbers.number_of(p));
    } else if (is("endloop")) {
      if (corners.size() != 3)
        scanner.fail("a facet of " + std::to_string(corners.size()) + " vertices; STL has triangles only");
      triangles.faces.push_back({corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (is("solid")) {
      ended = false;
      const std::string_view name = scanner.line();
      made.says.read_text(name, solids++ == 0 ? "the first line" : "a solid's line");
      made.says.add_writer(name);
    } else if (is("endsolid")) {
      ended = true;
      scanner.line();
    } else if (is("facet")) {
      scanner.line();
    } else if (!is("outer") && !is("loop") && !is("endfacet")) {
      scanner.fail("'" + std::string(word.substr(0, 40)) + "' is not a word of STL");
    }
  }
  if (!ended) scanner.fail("the file ends without 'endsolid': it is cut short");
  if (solids > 1) made.says.tell("file", std::to_string(solids) + " solids are read as one mesh");
  made.polygons.faces = triangles.faces.size();
  return made;
}

}  // namespace

MeshContent read_stl(std::string_view bytes) {
  const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const bool has_word = starts_in_any_case(bytes.substr(start), "solid");
  if (bytes.size() >= header_bytes) {
    // In a text file the four bytes of the count are letters. They form a number of triangles that no text
    // file is long enough to hold.
    const bool fits = count_of(bytes) <= (bytes.size() - header_bytes) / triangle_bytes;
    const bool has_zeros = bytes.substr(0, 1000).find('\0') != std::string_view::npos;
    if (!has_word || fits || has_zeros) return read_binary(bytes);
  }
  if (has_word) return read_text(bytes.substr(start));
  throw Error(ErrorCode::Input, "too short for an STL file");
}

}  // namespace octotomy::brep
