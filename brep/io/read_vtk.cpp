// SPDX-License-Identifier: AGPL-3.0-or-later
// VTK's legacy format (The VTK User's Guide, "Simple legacy formats"), polydata only; version 5.1 stores
// cells as offsets and connectivity, earlier ones as counts and corners in one list. Binary numbers are
// big-endian.
#include <cmath>
#include <stdexcept>

#include "brep/io/mesh_scanner.h"

namespace octotomy::brep {
namespace {

struct VtkReader {
  MeshScanner scanner;
  bool binary = false;
  bool offsets = false;  ///< version 5 and later

  std::size_t bytes_of(std::string_view type) const {
    if (!binary) return 1;
    if (type == "float" || type == "int" || type == "vtktypeint32") return 4;
    if (type == "double" || type == "vtktypeint64" || type == "long") return 8;
    scanner.fail("numbers of type '" + std::string(type.substr(0, 40)) + "' are not read");
  }
  double number(std::string_view type) {
    if (!binary) return scanner.number();
    return type == "float" ? scanner.binary<float>(std::endian::big)
                           : scanner.binary<double>(std::endian::big);
  }
  long long integer(std::string_view type) {
    if (!binary) return scanner.integer();
    return bytes_of(type) == 4 ? scanner.binary<std::int32_t>(std::endian::big)
                               : scanner.binary<std::int64_t>(std::endian::big);
  }

  std::vector<long long> integers(std::size_t count, const std::string& type) {
    std::vector<long long> values;
    values.reserve(scanner.bounded(static_cast<long long>(count), bytes_of(type)));
    for (std::size_t i = 0; i < count; ++i) values.push_back(integer(type));
    return values;
  }

  /// Lists of corners, of whichever layout.
  std::vector<std::vector<long long>> cells() {
    const std::size_t first = scanner.count(1), second = scanner.count(1);
    std::vector<std::vector<long long>> cells;
    if (!offsets) {
      scanner.line();
      const std::vector<long long> list = integers(second, "int");
      for (std::size_t at = 0; cells.size() < first;) {
        if (at >= list.size() || list[at] < 0 || static_cast<std::size_t>(list[at]) > list.size() - at - 1)
          scanner.fail("a cell reaches beyond the list of cells");
        const auto size = static_cast<std::ptrdiff_t>(list[at]);
        const auto begin = list.begin() + static_cast<std::ptrdiff_t>(at) + 1;
        cells.emplace_back(begin, begin + size);
        at += 1 + static_cast<std::size_t>(size);
      }
      return cells;
    }
    const auto part = [&](std::string_view name, std::size_t count) {
      if (scanner.word() != name) scanner.fail("'" + std::string(name) + "' is missing");
      const std::string type(scanner.word());
      scanner.line();
      return integers(count, type);
    };
    const std::vector<long long> ends = part("OFFSETS", first), list = part("CONNECTIVITY", second);
    for (std::size_t i = 1; i < ends.size(); ++i) {
      if (ends[i - 1] < 0 || ends[i] < ends[i - 1] || ends[i] > static_cast<long long>(list.size()))
        scanner.fail("a cell reaches beyond the list of cells");
      cells.emplace_back(list.begin() + ends[i - 1], list.begin() + ends[i]);
    }
    return cells;
  }
};

}  // namespace

Triangles read_vtk(std::string_view bytes) {
  VtkReader reader{MeshScanner(bytes)};
  MeshScanner& scanner = reader.scanner;
  const std::string_view signature = scanner.line();
  constexpr std::string_view wanted = "# vtk DataFile Version ";
  if (!signature.starts_with(wanted)) scanner.fail("a legacy VTK file starts with '# vtk DataFile Version'");
  reader.offsets = signature.size() > wanted.size() && signature[wanted.size()] >= '5';
  scanner.line();
  const std::string_view format = scanner.word();
  if (format != "ASCII" && format != "BINARY") scanner.fail("neither ASCII nor BINARY");
  reader.binary = format == "BINARY";
  if (scanner.word() != "DATASET" || scanner.word() != "POLYDATA")
    scanner.fail("the data set is not POLYDATA; export a surface");

  Triangles triangles;
  std::vector<std::vector<long long>> polygons, strips;
  while (!scanner.at_end()) {
    const std::string_view key = scanner.word();
    if (key.empty() || key == "POINT_DATA" || key == "CELL_DATA") break;
    if (key == "POINTS") {
      const long long count = scanner.integer();
      const std::string type(scanner.word());
      if (type != "float" && type != "double") scanner.fail("points of type '" + type.substr(0, 40) + "'");
      scanner.line();
      const std::size_t points = scanner.bounded(count, reader.binary ? 3 * reader.bytes_of(type) : 5);
      triangles.points_mm.reserve(points);
      for (std::size_t i = 0; i < points; ++i) {
        glm::dvec3 p;
        for (int axis = 0; axis < 3; ++axis) p[axis] = reader.number(type);
        if (!(std::abs(p.x) < INFINITY && std::abs(p.y) < INFINITY && std::abs(p.z) < INFINITY))
          scanner.fail("point " + std::to_string(i) + " is not finite");
        triangles.points_mm.push_back(p);
      }
    } else if (key == "POLYGONS") {
      polygons = reader.cells();
    } else if (key == "TRIANGLE_STRIPS") {
      strips = reader.cells();
    } else if (key == "VERTICES" || key == "LINES") {
      reader.cells();
    } else if (key == "METADATA") {
      scanner.line();
      while (!scanner.at_end() && !scanner.line().empty()) continue;
    } else {
      scanner.fail("'" + std::string(key.substr(0, 40)) + "' is no part of polydata");
    }
  }
  for (const auto& corners : polygons) add_fan(triangles, corners);
  for (const auto& corners : strips) add_strip(triangles, corners);
  return triangles;
}

}  // namespace octotomy::brep
