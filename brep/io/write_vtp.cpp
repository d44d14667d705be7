// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "brep/io/mesh_bytes.h"

namespace octotomy::brep {
namespace {

/// Arrays appended after the XML, each preceded by its length.
class Appended {
 public:
  /// The XML element that refers to an array of `count` numbers. `write(add)` calls add(number) for each.
  template <typename Number, typename Write>
  std::string array(const std::string& type, const std::string& name, int components, std::size_t count,
                    const Write& write) {
    std::string element = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                          std::to_string(components) + "\" format=\"appended\" offset=\"" +
                          std::to_string(offset_) + "\"/>\n";
    const std::uint64_t bytes = count * sizeof(Number);
    offset_ += sizeof(bytes) + bytes;
    arrays_.push_back([bytes, write](Sink& sink) {
      append_little(sink.bytes, bytes);
      write([&sink](Number number) {
        append_little(sink.bytes, number);
        sink.let_go();
      });
    });
    return element;
  }
  void write(Sink& sink) const {
    for (const auto& array : arrays_) array(sink);
  }

 private:
  std::uint64_t offset_ = 0;
  std::vector<std::function<void(Sink&)>> arrays_;
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
    xml +=
        appended.array<std::int32_t>("Int32", name, 1, numbers.size(), [&numbers = numbers](const auto& add) {
          for (const std::int32_t number : numbers) add(number);
        });
  return xml.empty() ? xml : "<CellData>\n" + xml + "</CellData>\n";
}

}  // namespace

void write_vtp(const Triangles& triangles, const VertexData& data, const CellData& cells, Sink& sink) {
  const std::size_t points = triangles.points_mm.size(), faces = triangles.faces.size();
  Appended appended;
  std::string xml =
      "<?xml version=\"1.0\"?>\n<!-- octotomy, LPS millimetres -->\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<PolyData>\n" +
      field_data(cells) + "<Piece NumberOfPoints=\"" + std::to_string(points) +
      "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
      std::to_string(faces) + "\">\n<PointData" + (cells.numbers.empty() ? " Normals=\"Normals\"" : "") +
      ">\n";
  const auto each_axis = [](const auto& vectors) {
    return [&vectors](const auto& add) {
      for (const auto& v : vectors)
        for (int axis = 0; axis < 3; ++axis) add(v[axis]);
    };
  };
  const std::vector<glm::vec3> normals =
      cells.numbers.empty() ? vertex_normals(triangles) : std::vector<glm::vec3>();
  if (cells.numbers.empty())
    xml += appended.array<float>("Float32", "Normals", 3, 3 * points, each_axis(normals));
  if (!data.colours.empty())
    xml += appended.array<std::uint8_t>("UInt8", "Colours", 3, 3 * points, each_axis(data.colours));
  if (!data.scalars.empty())
    xml += appended.array<double>("Float64", data.scalar_name, 1, points, [&](const auto& add) {
      for (const double scalar : data.scalars) add(scalar);
    });
  xml += "</PointData>\n" + cell_data(cells, appended) + "<Points>\n";
  xml += appended.array<double>("Float64", "Points", 3, 3 * points, each_axis(triangles.points_mm));
  xml += "</Points>\n<Polys>\n";
  xml += appended.array<std::int64_t>("Int64", "connectivity", 1, 3 * faces, each_axis(triangles.faces));
  xml += appended.array<std::int64_t>("Int64", "offsets", 1, faces, [faces](const auto& add) {
    for (std::size_t f = 1; f <= faces; ++f) add(static_cast<std::int64_t>(3 * f));
  });
  sink.bytes += xml + "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  appended.write(sink);
  sink.bytes += "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace octotomy::brep
