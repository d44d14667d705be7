// SPDX-License-Identifier: AGPL-3.0-or-later
// Wavefront's OBJ and Geomview's OFF, as text. Sources: Wavefront, Advanced Visualizer, appendix B1 (Object
// Files), whose free-form surfaces (surf, or bzp, bsp and cdc of its version 2.11) are not polygons.
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// Reads the comments at the beginning of a file, in which programs state their name and unit.
void read_comments(std::string_view bytes, MeshStatements& says) {
  MeshScanner scanner(bytes.substr(0, 10000));
  while (!scanner.at_end()) {
    const std::string_view line = scanner.line();
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos || line[begin] != '#') continue;
    const std::string_view comment =
        line.substr(std::min(line.find_first_not_of("# \t", begin), line.size()));
    says.read_text(comment, "a comment");
    says.add_writer(comment);
  }
}

/// Calls `add`. If it throws, adds the line to the message.
template <typename Add>
void on_line(const MeshScanner& scanner, const Add& add) {
  try {
    add();
  } catch (const std::runtime_error& e) {
    scanner.fail(e.what());
  }
}

/// Counts of an OBJ file's contents other than polygons.
struct ObjLeftOut {
  std::size_t surfaces = 0, curves = 0, lines = 0, points = 0, files = 0;

  void count(std::string_view key) {
    surfaces += key == "surf" || key == "bzp" || key == "bsp" || key == "cdc";
    curves += key == "curv";
    lines += key == "l";
    points += key == "p";
    files += key == "call";
  }
  void report(MeshStatements& says) const {
    const auto named = [](std::size_t number, const char* one, const char* many) {
      return std::to_string(number) + (number == 1 ? one : many);
    };
    if (surfaces > 0)
      says.warn("file", named(surfaces, " free-form surface is", " free-form surfaces are") +
                            " left out, because only polygons are read: export triangles");
    if (files > 0)
      says.warn("file", named(files, " other file is", " other files are") +
                            " referred to (call) and left out: export everything as one file");
    const auto tell = [&](std::size_t number, const char* one, const char* many) {
      if (number > 0) says.tell("file", named(number, one, many) + " left out");
    };
    tell(curves, " free-form curve is", " free-form curves are");
    tell(lines, " line is", " lines are");
    tell(points, " element of points is", " elements of points are");
  }
};

glm::dvec3 point(MeshScanner& scanner) {
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.number();
  return p;
}

/// Number of bytes that a binary OFF file has for each point besides its position: two numbers of a texture,
/// four of a colour and three of a normal, as the file's prefix states. None if the prefix has other letters.
std::optional<std::size_t> bytes_beside_place(std::string_view magic) {
  std::size_t numbers = 0;
  for (const auto& [letters, count] : {std::pair("ST", 2U), std::pair("C", 4U), std::pair("N", 3U)})
    if (magic.starts_with(letters)) {
      magic.remove_prefix(std::string_view(letters).size());
      numbers += count;
    }
  return magic == "OFF" ? std::optional(numbers * sizeof(float)) : std::nullopt;
}

MeshContent read_binary_off(MeshScanner scanner, std::size_t beside_place) {
  MeshContent made;
  const auto count = [&](std::size_t bytes_each) {
    return scanner.bounded(scanner.binary<std::int32_t>(std::endian::big), bytes_each);
  };
  const std::size_t points = count(12 + beside_place), faces = count(8);
  scanner.skip(4);
  for (std::size_t i = 0; i < points; ++i) {
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = scanner.binary<float>(std::endian::big);
    scanner.skip(beside_place);
    made.triangles.points_mm.push_back(p);
  }
  PolygonSplitter polygons(made.triangles, made.polygons);
  std::vector<long long> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    corners.resize(count(4));
    for (long long& corner : corners) corner = scanner.binary<std::int32_t>(std::endian::big);
    on_line(scanner, [&] { polygons.add(corners); });
    scanner.skip(4 * count(4));  // colours
  }
  return made;
}

}  // namespace

MeshContent read_obj(std::string_view bytes) {
  MeshContent made;
  read_comments(bytes, made.says);
  MeshScanner scanner(bytes);
  scanner.comments_start_with_hash();
  Triangles& triangles = made.triangles;
  PolygonSplitter polygons(triangles, made.polygons);
  std::vector<long long> corners;
  ObjLeftOut left_out;
  while (!scanner.at_end()) {
    const std::string_view key = scanner.word();
    left_out.count(key);
    if (key == "v") {
      triangles.points_mm.push_back(point(scanner));
    } else if (key == "f") {
      corners.clear();
      for (std::string_view word = scanner.word(true); !word.empty(); word = scanner.word(true)) {
        if (word == "\\") {
          scanner.line();
          continue;
        }
        // Negative numbers count backwards from the last point read.
        const long long given = integer_of(word.substr(0, word.find('/')));
        if (given == 0) scanner.fail("a face refers to point 0; OBJ counts from 1");
        if (given > static_cast<long long>(triangles.points_mm.size()))
          scanner.fail("a face refers to point " + std::to_string(given) + ", and " +
                       std::to_string(triangles.points_mm.size()) + " stand before it");
        corners.push_back(given > 0 ? given - 1 : given + static_cast<long long>(triangles.points_mm.size()));
      }
      on_line(scanner, [&] { polygons.add(corners); });
    }
    scanner.line();
  }
  left_out.report(made.says);
  return made;
}

MeshContent read_off(std::string_view bytes) {
  MeshScanner scanner(bytes);
  scanner.comments_start_with_hash();
  // The prefix states which data follow each point: colours (C), normals (N), textures (ST). 4 and n change
  // the dimension and are refused.
  const std::string_view magic = scanner.word();
  if (!magic.ends_with("OFF") || magic.find_first_of("4n") != std::string_view::npos)
    scanner.fail("an OFF file of points in space starts with OFF, COFF, NOFF or STOFF");
  if (MeshScanner ahead = scanner; ahead.word(true) == "BINARY") {
    const std::optional<std::size_t> beside_place = bytes_beside_place(magic);
    if (!beside_place)
      scanner.fail("a binary OFF file starts with OFF; only ST, C and N may stand before it, in this order");
    ahead.line();
    return read_binary_off(ahead, *beside_place);
  }
  MeshContent made;
  read_comments(bytes, made.says);
  const long long point_count = scanner.integer(), face_count = scanner.integer();
  scanner.line();  // skips the number of edges, which is often wrong
  Triangles& triangles = made.triangles;
  // The shortest line of a point is "0 0 0", of a face "1 0", each with its line end.
  const std::size_t points = scanner.bounded(point_count, 5);
  triangles.points_mm.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    triangles.points_mm.push_back(point(scanner));
    scanner.line();
  }
  const std::size_t faces = scanner.bounded(face_count, 3);
  PolygonSplitter polygons(triangles, made.polygons);
  std::vector<long long> corners;
  for (std::size_t i = 0; i < faces; ++i) {
    corners.resize(scanner.count(1));
    for (long long& corner : corners) corner = scanner.integer();
    on_line(scanner, [&] { polygons.add(corners); });
    scanner.line();
  }
  return made;
}

}  // namespace octotomy::brep
