// SPDX-License-Identifier: AGPL-3.0-or-later
// VTK's legacy format (The VTK User's Guide, "Simple legacy formats"): polydata and unstructured grids;
// version 5 stores cells as offsets and connectivity, earlier ones as counts and corners in one list. Binary
// numbers are big-endian. Keywords are in any case. The geometry ends at the data of points or cells; before
// these, fields may occur anywhere. METADATA may follow an array, up to an empty line.
#include <cmath>
#include <stdexcept>

#include "brep/io/mesh_scanner.h"
#include "brep/io/vtk_cells.h"

namespace octotomy::brep {
namespace {

struct VtkReader {
  MeshScanner scanner;
  bool binary = false;
  bool offsets = false;  ///< version 5 and later
  MeshContent made = {};

  /// The number of bytes of a binary number of this type.
  std::size_t bytes_of(std::string_view type) const {
    if (type == "char" || type == "unsigned_char") return 1;
    if (type == "short" || type == "unsigned_short") return 2;
    if (type == "float" || type == "int" || type == "unsigned_int" || type == "vtktypeint32" ||
        type == "vtkidtype" || type == "vtktypeuint32")
      return 4;
    if (type == "double" || type == "vtktypeint64" || type == "vtktypeuint64" || type == "long" ||
        type == "unsigned_long")
      return 8;
    scanner.fail("numbers of type '" + std::string(type.substr(0, 40)) + "' are not read");
  }
  std::size_t least_bytes_of(std::string_view type) const { return binary ? bytes_of(type) : 1; }

  template <typename Number>
  Number number(std::string_view type) {
    if (!binary) {
      if constexpr (std::is_floating_point_v<Number>)
        return scanner.number();
      else
        return scanner.integer();
    }
    const auto read = [&]<typename Stored>(Stored) {
      return static_cast<Number>(scanner.binary<Stored>(std::endian::big));
    };
    if constexpr (std::is_floating_point_v<Number>) {
      if (type == "float") return read(float{});
      if (type == "double") return read(double{});
    }
    const bool is_unsigned =
        type.starts_with("unsigned") || type == "vtktypeuint32" || type == "vtktypeuint64";
    switch (bytes_of(type)) {
      case 1:
        return is_unsigned ? read(std::uint8_t{}) : read(std::int8_t{});
      case 2:
        return is_unsigned ? read(std::uint16_t{}) : read(std::int16_t{});
      case 4:
        return is_unsigned ? read(std::uint32_t{}) : read(std::int32_t{});
      default:
        return is_unsigned ? read(std::uint64_t{}) : read(std::int64_t{});
    }
  }

  std::string lower_word() { return lower_case(scanner.word()); }

  template <typename Number>
  std::vector<Number> numbers(std::size_t count, const std::string& type) {
    std::vector<Number> values;
    values.reserve(scanner.bounded(static_cast<long long>(count), least_bytes_of(type)));
    for (std::size_t i = 0; i < count; ++i) values.push_back(number<Number>(type));
    return values;
  }

  /// Skips up to the next empty line.
  void skip_metadata() {
    scanner.line();
    while (!scanner.at_end() && !scanner.line().empty()) continue;
  }

  /// Skips METADATA if it is the next word, after an array.
  void skip_own_metadata() {
    MeshScanner ahead = scanner;
    if (!starts_in_any_case(ahead.word(), "metadata")) return;
    scanner = ahead;
    skip_metadata();
  }

  /// A string of an array: a line of text or, in a binary file, a length and its bytes. The two highest bits
  /// of the length's first byte state how long the length is: 3 one byte, 2 two, 1 four, 0 eight.
  std::string text() {
    if (!binary) return std::string(scanner.line());
    const auto first = scanner.binary<std::uint8_t>(std::endian::big);
    const int more = first >> 6 == 3 ? 0 : first >> 6 == 2 ? 1 : first >> 6 == 1 ? 3 : 7;
    std::uint64_t length = first & 63;
    for (int i = 0; i < more; ++i) length = length << 8 | scanner.binary<std::uint8_t>(std::endian::big);
    return std::string(scanner.bytes(scanner.bounded(static_cast<long long>(length), 1)));
  }

  /// Reads "FIELD name count" and its arrays, each with name, components, tuples and type. SPACE names the
  /// frame.
  void fields() {
    scanner.word();
    const std::size_t arrays = scanner.count(1);
    for (std::size_t i = 0; i < arrays; ++i) {
      const std::string name(scanner.word());
      const std::size_t components = scanner.count(1), tuples = scanner.count(1);
      if (components > 0 && tuples > scanner.rest() / components) scanner.fail("the file ends too early");
      const std::size_t count = components * tuples;
      const std::string type = lower_word();
      scanner.line();
      if (type == "string") {
        for (std::size_t k = 0; k < count; ++k) take_field(name, text());
      } else if (type == "bit" && binary) {
        scanner.skip((count + 7) / 8);
      } else if (binary) {
        scanner.skip(scanner.bounded(static_cast<long long>(count), bytes_of(type)) * bytes_of(type));
      } else {
        for (std::size_t k = 0; k < count; ++k) scanner.word();
      }
      skip_own_metadata();
    }
  }

  void take_field(const std::string& name, const std::string& value) {
    const std::string key = lower_case(name);
    if (key == "space") made.says.add_frame(value, "SPACE=" + value.substr(0, 40) + " in the field");
    if (key == "unit" || key == "units")
      made.says.add_unit(value, "unit " + value.substr(0, 40) + " in the field");
  }

  void points() {
    const long long count = scanner.integer();
    const std::string type = lower_word();
    scanner.line();
    const std::size_t held = scanner.bounded(count, binary ? 3 * bytes_of(type) : 5);
    made.triangles.points_mm.clear();
    made.triangles.points_mm.reserve(held);
    for (std::size_t i = 0; i < held; ++i) {
      glm::dvec3 p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = number<double>(type);
      if (!(std::abs(p.x) < INFINITY && std::abs(p.y) < INFINITY && std::abs(p.z) < INFINITY))
        scanner.fail("point " + std::to_string(i) + " is not finite");
      made.triangles.points_mm.push_back(p);
    }
  }

  /// Reads lists of corners in either layout.
  CellCorners cells() {
    const std::size_t first = scanner.count(1), second = scanner.count(1);
    CellCorners cells;
    if (!offsets) {
      scanner.line();
      const std::vector<long long> list = numbers<long long>(second, "int");
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
      if (lower_word() != name) scanner.fail("'" + std::string(name) + "' is missing");
      const std::string type = lower_word();
      scanner.line();
      std::vector<long long> list = numbers<long long>(count, type);
      skip_own_metadata();
      return list;
    };
    const std::vector<long long> ends = part("offsets", first), list = part("connectivity", second);
    for (std::size_t i = 1; i < ends.size(); ++i) {
      if (ends[i - 1] < 0 || ends[i] < ends[i - 1] || ends[i] > static_cast<long long>(list.size()))
        scanner.fail("a cell reaches beyond the list of cells");
      cells.emplace_back(list.begin() + ends[i - 1], list.begin() + ends[i]);
    }
    return cells;
  }

  std::vector<long long> cell_types() {
    const std::size_t count = scanner.count(1);
    scanner.line();
    return numbers<long long>(count, "int");
  }

  void header() {
    const std::string_view signature = scanner.line();
    constexpr std::string_view wanted = "# vtk datafile version ";
    if (!starts_in_any_case(signature, wanted))
      scanner.fail("a legacy VTK file starts with '# vtk DataFile Version'");
    offsets = signature.size() > wanted.size() && signature[wanted.size()] >= '5';
    const std::string_view title = scanner.line();
    made.says.read_text(title, "the title");
    made.says.add_writer(title);
    const std::string format = lower_word();
    if (format != "ascii" && format != "binary") scanner.fail("neither ASCII nor BINARY");
    binary = format == "binary";
  }

  void data() {
    const std::string dataset = lower_word(), kind = lower_word();
    const bool is_grid = kind == "unstructured_grid";
    if (dataset != "dataset" || (kind != "polydata" && !is_grid))
      scanner.fail("the data set is neither POLYDATA nor UNSTRUCTURED_GRID; export a surface");
    CellCorners polygons, strips, grid;
    std::vector<long long> types;
    while (!scanner.at_end()) {
      const std::string key = lower_word();
      if (key.empty() || key == "point_data" || key == "cell_data") break;
      if (key == "points")
        points();
      else if (key == "polygons" && !is_grid)
        polygons = cells();
      else if (key == "triangle_strips" && !is_grid)
        strips = cells();
      else if ((key == "vertices" || key == "lines") && !is_grid)
        cells();
      else if (key == "cells" && is_grid)
        grid = cells();
      else if (key == "cell_types" && is_grid)
        types = cell_types();
      else if (key == "field")
        fields();
      else if (key == "metadata")
        skip_metadata();
      else
        scanner.fail("'" + key.substr(0, 40) + "' is not a part of " + (is_grid ? "a grid" : "polydata"));
    }
    if (is_grid) return add_grid_surface(grid, types, made);
    PolygonSplitter splitter(made.triangles, made.polygons);
    for (const auto& corners : polygons) splitter.add(corners);
    for (const auto& corners : strips) splitter.add_strip(corners);
  }
};

}  // namespace

MeshContent read_vtk(std::string_view bytes) {
  VtkReader reader{MeshScanner(bytes)};
  reader.header();
  reader.data();
  return std::move(reader.made);
}

}  // namespace octotomy::brep
