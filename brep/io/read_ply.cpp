// SPDX-License-Identifier: AGPL-3.0-or-later
// Source: Turk, The PLY polygon file format, 1994: elements in the header's order, each with scalar and list
// properties. Only x, y, z of "vertex" and the corner lists of "face" and "tristrips" are used.
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "brep/io/mesh_scanner.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

enum class Scalar { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct Property {
  std::string name;
  Scalar type = Scalar::Float32;
  std::optional<Scalar> list_count;  ///< type of a list's count; none if the property is not a list
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::optional<std::endian> binary;  ///< byte order; none for ASCII
  std::vector<Element> elements;
};

Scalar scalar_of(std::string_view name, const MeshScanner& scanner) {
  if (name == "char" || name == "int8") return Scalar::Int8;
  if (name == "uchar" || name == "uint8") return Scalar::Uint8;
  if (name == "short" || name == "int16") return Scalar::Int16;
  if (name == "ushort" || name == "uint16") return Scalar::Uint16;
  if (name == "int" || name == "int32") return Scalar::Int32;
  if (name == "uint" || name == "uint32") return Scalar::Uint32;
  if (name == "float" || name == "float32") return Scalar::Float32;
  if (name == "double" || name == "float64") return Scalar::Float64;
  scanner.fail("'" + std::string(name.substr(0, 40)) + "' is not a type of PLY");
}

std::size_t byte_count(Scalar type) {
  switch (type) {
    case Scalar::Int8:
    case Scalar::Uint8:
      return 1;
    case Scalar::Int16:
    case Scalar::Uint16:
      return 2;
    case Scalar::Int32:
    case Scalar::Uint32:
    case Scalar::Float32:
      return 4;
    case Scalar::Float64:
      return 8;
  }
  throw std::logic_error("a PLY type without size");
}

Header read_header(MeshScanner& scanner, MeshStatements& says) {
  Header header;
  if (scanner.word() != "ply") scanner.fail("a PLY file starts with 'ply'");
  bool has_format = false;
  while (!scanner.at_end()) {
    const std::string_view key = scanner.word();
    if (key == "format") {
      const std::string_view format = scanner.word();
      if (format == "binary_little_endian") {
        header.binary = std::endian::little;
      } else if (format == "binary_big_endian") {
        header.binary = std::endian::big;
      } else if (format != "ascii") {
        scanner.fail("'" + std::string(format.substr(0, 40)) + "' is not a format of PLY");
      }
      has_format = true;
    } else if (key == "element") {
      Element element;
      element.name = scanner.word();
      element.count = scanner.integer();
      header.elements.push_back(element);
    } else if (key == "property") {
      if (header.elements.empty()) scanner.fail("a property stands before the first element");
      Property property;
      std::string_view type = scanner.word();
      if (type == "list") {
        property.list_count = scalar_of(scanner.word(), scanner);
        type = scanner.word();
      }
      property.type = scalar_of(type, scanner);
      property.name = scanner.word();
      header.elements.back().properties.push_back(property);
    } else if (key == "end_header") {
      if (!has_format) scanner.fail("the header names no format");
      scanner.line();
      return header;
    } else if (key != "comment" && key != "obj_info") {
      scanner.fail("'" + std::string(key.substr(0, 40)) + "' is not a keyword of PLY");
    }
    const std::string_view rest = scanner.line();
    if (key == "comment" || key == "obj_info") {
      says.read_text(rest, "a comment");
      says.add_writer(rest);
    }
  }
  scanner.fail("the header does not end");
}

double read_scalar(MeshScanner& scanner, Scalar type, const std::optional<std::endian>& binary) {
  if (!binary) return scanner.number();
  switch (type) {
    case Scalar::Int8:
      return scanner.binary<std::int8_t>(*binary);
    case Scalar::Uint8:
      return scanner.binary<std::uint8_t>(*binary);
    case Scalar::Int16:
      return scanner.binary<std::int16_t>(*binary);
    case Scalar::Uint16:
      return scanner.binary<std::uint16_t>(*binary);
    case Scalar::Int32:
      return scanner.binary<std::int32_t>(*binary);
    case Scalar::Uint32:
      return scanner.binary<std::uint32_t>(*binary);
    case Scalar::Float32:
      return scanner.binary<float>(*binary);
    case Scalar::Float64:
      return scanner.binary<double>(*binary);
  }
  throw std::logic_error("a PLY type without reader");
}

/// The least number of bytes in a row of an element: in text, a digit and a space for each number.
std::size_t least_row_bytes(const Element& element, bool binary) {
  std::size_t bytes = 0;
  for (const Property& property : element.properties)
    bytes += binary ? byte_count(property.list_count.value_or(property.type)) : 2;
  // The last number of a text may have no space after it.
  return std::max<std::size_t>(binary ? bytes : bytes - std::min<std::size_t>(bytes, 1), 1);
}

/// Reads an element's rows. Calls `take` with the index of each property and its values.
template <typename Take, typename EndRow>
void read_rows(MeshScanner& scanner, const Header& header, const Element& element, const Take& take,
               const EndRow& end_row) {
  if (element.properties.empty()) return;
  const std::size_t rows =
      scanner.bounded(element.count, least_row_bytes(element, header.binary.has_value()));
  std::vector<double> values;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      std::size_t count = 1;
      if (property.list_count) {
        const double given = read_scalar(scanner, *property.list_count, header.binary);
        if (!(given >= 0.0 && given < 4294967296.0))
          scanner.fail("the count of a list is negative or too large");
        count = scanner.bounded(static_cast<long long>(given), header.binary ? byte_count(property.type) : 1);
      }
      values.clear();
      for (std::size_t i = 0; i < count; ++i)
        values.push_back(read_scalar(scanner, property.type, header.binary));
      take(p, values);
    }
    end_row();
  }
}

/// The numbers of lists, one list after the other.
struct Lists {
  std::vector<long long> corners;
  std::vector<std::size_t> ends;

  template <typename Take>
  void for_each(const Take& take) const {
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      take(std::span(corners).subspan(begin, end - begin));
      begin = end;
    }
  }
};

void read_vertices(MeshScanner& scanner, const Header& header, const Element& element, Triangles& triangles) {
  int coordinates = 0;
  std::vector<int> axis_of;
  for (const Property& p : element.properties) {
    const bool is_place = !p.list_count && (p.name == "x" || p.name == "y" || p.name == "z");
    axis_of.push_back(is_place ? p.name[0] - 'x' : -1);
    coordinates += is_place ? 1 : 0;
  }
  if (coordinates != 3) scanner.fail("the vertices have no x, y and z");
  glm::dvec3 point(0.0);
  read_rows(
      scanner, header, element,
      [&](std::size_t p, const std::vector<double>& values) {
        if (axis_of[p] >= 0) point[axis_of[p]] = values[0];
      },
      [&] {
        if (!(std::abs(point.x) < INFINITY && std::abs(point.y) < INFINITY && std::abs(point.z) < INFINITY))
          scanner.fail("point " + std::to_string(triangles.points_mm.size()) + " is not finite");
        triangles.points_mm.push_back(point);
      });
}

/// Reads lists of point numbers; in strips, -1 ends one strip and begins the next.
void read_lists(MeshScanner& scanner, const Header& header, const Element& element, bool with_strips,
                Lists& lists) {
  std::vector<bool> is_list;
  for (const Property& p : element.properties)
    is_list.push_back(p.list_count && (p.name == "vertex_indices" || p.name == "vertex_index"));
  read_rows(
      scanner, header, element,
      [&](std::size_t p, const std::vector<double>& values) {
        if (!is_list[p]) return;
        for (const double value : values) {
          if (with_strips && value == -1.0) {
            lists.ends.push_back(lists.corners.size());
            continue;
          }
          if (!(value >= 0.0 && value < 4294967296.0)) scanner.fail("a corner is not the number of a point");
          lists.corners.push_back(static_cast<long long>(value));
        }
        lists.ends.push_back(lists.corners.size());
      },
      [] {});
}

}  // namespace

MeshContent read_ply(std::string_view bytes) {
  MeshContent made;
  MeshScanner scanner(bytes);
  const Header header = read_header(scanner, made.says);
  Lists polygons, strips;
  bool has_points = false;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      has_points = true;
      read_vertices(scanner, header, element, made.triangles);
    } else if (element.name == "face") {
      read_lists(scanner, header, element, false, polygons);
    } else if (element.name == "tristrips") {
      read_lists(scanner, header, element, true, strips);
    } else {
      read_rows(
          scanner, header, element, [](std::size_t, const std::vector<double>&) {}, [] {});
    }
  }
  if (!has_points) scanner.fail("the file has no vertices");
  made.triangles.faces.reserve(polygons.ends.size());
  PolygonSplitter splitter(made.triangles, made.polygons);
  polygons.for_each([&](std::span<const long long> corners) { splitter.add(corners); });
  strips.for_each([&](std::span<const long long> corners) { splitter.add_strip(corners); });
  return made;
}

}  // namespace octotomy::brep
