// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/mesh_bytes.h"

namespace octotomy::brep {
namespace {

/// Arrays appended after the XML, each preceded by its length.
class Appended {
 public:
  /// The XML element that refers to an array. `write` appends the array to the bytes.
  template <typename Write>
  std::string array(const std::string& type, const std::string& name, int components, const Write& write) {
    std::string element = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                          std::to_string(components) + "\" format=\"appended\" offset=\"" +
                          std::to_string(bytes_.size()) + "\"/>\n";
    std::string values;
    write(values);
    append_little(bytes_, static_cast<std::uint64_t>(values.size()));
    bytes_ += values;
    return element;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The frame, as 3D Slicer reads it, and the names of the parts. Texts are stored as in VTK: character codes,
/// each text ended by 0.
std::string field_data(const CellData& cells) {
  const std::string frame =
      "<FieldData>\n<DataArray type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" format=\"ascii\">76 80 83 "
      "0"
      "</DataArray>\n";
  if (cells.part_numbers.empty()) return frame + "</FieldData>\n";
  const std::string count = "NumberOfTuples=\"" + std::to_string(cells.part_numbers.size()) + "\"";
  std::string numbers, letters;
  for (const int number : cells.part_numbers) numbers += std::to_string(number) + " ";
  for (const std::string& name : cells.part_names) {
    for (const char letter : name) letters += std::to_string(static_cast<unsigned char>(letter)) + " ";
    letters += "0 ";
  }
  return frame + "<DataArray type=\"Int32\" Name=\"part_numbers\" " + count + " format=\"ascii\">" + numbers +
         "</DataArray>\n<DataArray type=\"String\" Name=\"part_names\" " + count + " format=\"ascii\">" +
         letters + "</DataArray>\n</FieldData>\n";
}

std::string cell_data(const CellData& cells, Appended& appended) {
  std::string xml;
  for (const auto& [name, numbers] : cells.numbers)
    xml += appended.array("Int32", name, 1, [&numbers = numbers](std::string& values) {
      for (const std::int32_t number : numbers) append_little(values, number);
    });
  return xml.empty() ? xml : "<CellData>\n" + xml + "</CellData>\n";
}

}  // namespace

std::string vtp_of(const Triangles& triangles, const VertexData& data, const CellData& cells) {
  Appended appended;
  std::string xml =
      "<?xml version=\"1.0\"?>\n<!-- octotomy, LPS millimetres -->\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<PolyData>\n" +
      field_data(cells) + "<Piece NumberOfPoints=\"" + std::to_string(triangles.points_mm.size()) +
      "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
      std::to_string(triangles.faces.size()) + "\">\n<PointData" +
      (cells.numbers.empty() ? " Normals=\"Normals\"" : "") + ">\n";
  if (cells.numbers.empty())
    xml += appended.array("Float32", "Normals", 3, [&](std::string& values) {
      for (const glm::vec3& n : vertex_normals(triangles))
        for (int axis = 0; axis < 3; ++axis) append_little(values, n[axis]);
    });
  if (!data.colours.empty())
    xml += appended.array("UInt8", "Colours", 3, [&](std::string& values) {
      for (const glm::u8vec3& colour : data.colours)
        for (int channel = 0; channel < 3; ++channel) append_little(values, colour[channel]);
    });
  if (!data.scalars.empty())
    xml += appended.array("Float64", data.scalar_name, 1, [&](std::string& values) {
      for (const double scalar : data.scalars) append_little(values, scalar);
    });
  xml += "</PointData>\n" + cell_data(cells, appended) + "<Points>\n";
  xml += appended.array("Float64", "Points", 3, [&](std::string& values) {
    for (const glm::dvec3& p : triangles.points_mm)
      for (int axis = 0; axis < 3; ++axis) append_little(values, p[axis]);
  });
  xml += "</Points>\n<Polys>\n";
  xml += appended.array("Int64", "connectivity", 1, [&](std::string& values) {
    for (const auto& face : triangles.faces)
      for (const std::uint32_t v : face) append_little(values, static_cast<std::int64_t>(v));
  });
  xml += appended.array("Int64", "offsets", 1, [&](std::string& values) {
    for (std::size_t f = 1; f <= triangles.faces.size(); ++f)
      append_little(values, static_cast<std::int64_t>(3 * f));
  });
  xml += "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  return xml + appended.bytes() + "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace octotomy::brep
