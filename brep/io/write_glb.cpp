// SPDX-License-Identifier: AGPL-3.0-or-later
// The glTF 2.0 specification, Khronos Group. Its colours are linear, so sRGB is converted, with 16 bits per
// channel to preserve dark steps.
#include <cmath>
#include <limits>

#include "brep/io/mesh_bytes.h"

namespace octotomy::brep {
namespace {

std::uint16_t linear_of(std::uint8_t srgb) {
  const double share = srgb / 255.0;
  const double linear = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(65535.0 * linear));
}

/// The binary chunk and its description in JSON.
struct Buffer {
  std::string bytes, views, accessors;
  int count = 0;

  /// Adds the JSON of an array that begins at byte `from` and ends with the buffer; `more` holds further
  /// members of its accessor.
  void close(std::size_t from, int target, const std::string& more) {
    const std::string comma = count == 0 ? "" : ",";
    views += comma + "{\"buffer\":0,\"byteOffset\":" + std::to_string(from) +
             ",\"byteLength\":" + std::to_string(bytes.size() - from) +
             ",\"target\":" + std::to_string(target) + "}";
    accessors += comma + "{\"bufferView\":" + std::to_string(count) + "," + more + "}";
    ++count;
  }
};

constexpr int of_vertices = 34962, of_indices = 34963;

std::string text_of(const glm::vec3& p) {
  const auto number = [](float value) {
    std::string text(32, '\0');
    text.resize(static_cast<std::size_t>(
        std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(value))));
    return text;
  };
  return "[" + number(p.x) + "," + number(p.y) + "," + number(p.z) + "]";
}

/// Adds the points and their bounds as the first array.
void add_points(const std::vector<glm::dvec3>& points_mm, Buffer& buffer) {
  glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
  for (const glm::dvec3& point : points_mm) {
    const glm::vec3 p(point);
    low = glm::min(low, p);
    high = glm::max(high, p);
    for (int axis = 0; axis < 3; ++axis) append_little(buffer.bytes, p[axis]);
  }
  buffer.close(0, of_vertices,
               "\"componentType\":5126,\"type\":\"VEC3\",\"count\":" + std::to_string(points_mm.size()) +
                   ",\"min\":" + text_of(low) + ",\"max\":" + text_of(high));
}

void add_normals(const Triangles& triangles, Buffer& buffer) {
  const std::size_t normals = buffer.bytes.size();
  for (const glm::vec3& n : vertex_normals(triangles))
    for (int axis = 0; axis < 3; ++axis) append_little(buffer.bytes, n[axis]);
  buffer.close(
      normals, of_vertices,
      "\"componentType\":5126,\"type\":\"VEC3\",\"count\":" + std::to_string(triangles.points_mm.size()));
}

void add_corners(const std::vector<std::array<std::uint32_t, 3>>& faces, Buffer& buffer) {
  const std::size_t corners = buffer.bytes.size();
  for (const auto& face : faces)
    for (const std::uint32_t v : face) append_little(buffer.bytes, v);
  buffer.close(corners, of_indices,
               "\"componentType\":5125,\"type\":\"SCALAR\",\"count\":" + std::to_string(3 * faces.size()));
}

/// Converts LPS millimetres to metres with y to the head and z to the front.
constexpr const char* node_matrix = "\"matrix\":[0.001,0,0,0,0,0,-0.001,0,0,0.001,0,0,0,0,0,1]";
constexpr const char* material =
    "\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0.7}}]";

std::string arrays_of(const Buffer& buffer) {
  return ",\"buffers\":[{\"byteLength\":" + std::to_string(buffer.bytes.size()) + "}],\"bufferViews\":[" +
         buffer.views + "],\"accessors\":[" + buffer.accessors + "]";
}

void add_chunk(std::string& file, const char* kind, std::string chunk, char fill) {
  while (chunk.size() % 4 != 0) chunk += fill;
  append_little(file, static_cast<std::uint32_t>(chunk.size()));
  file.append(kind, 4);
  file += chunk;
}

/// The file with a scene's nodes, meshes and arrays; without a binary chunk if there is no buffer.
std::string file_of(const std::string& nodes, const std::string& json, const Buffer& buffer) {
  std::string chunks;
  add_chunk(chunks, "JSON",
            "{\"asset\":{\"version\":\"2.0\",\"generator\":\"octotomy\"},\"scene\":0,\"scenes\":[{" + nodes +
                "}]" + json + "}",
            ' ');
  if (!buffer.bytes.empty()) add_chunk(chunks, "BIN\0", buffer.bytes, '\0');
  std::string file = "glTF";
  append_little(file, std::uint32_t{2});
  append_little(file, static_cast<std::uint32_t>(12 + chunks.size()));
  return file + chunks;
}

/// A name as a JSON string.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char letter : name)
    if (letter == '"' || letter == '\\')
      text += std::string("\\") + letter;
    else
      text += static_cast<unsigned char>(letter) < ' ' ? '_' : letter;
  return text + '"';
}

}  // namespace

std::vector<glm::vec3> vertex_normals(const Triangles& triangles) {
  std::vector<glm::dvec3> sums(triangles.points_mm.size(), glm::dvec3(0.0));
  for (const auto& face : triangles.faces) {
    const glm::dvec3& a = triangles.points_mm[face[0]];
    const glm::dvec3 twice = glm::cross(triangles.points_mm[face[1]] - a, triangles.points_mm[face[2]] - a);
    for (const std::uint32_t v : face) sums[v] += twice;
  }
  std::vector<glm::vec3> normals;
  normals.reserve(sums.size());
  for (const glm::dvec3& sum : sums) {
    const double length = glm::length(sum);
    normals.emplace_back(length > 0.0 ? sum / length : glm::dvec3(0, 0, 1));
  }
  return normals;
}

std::string glb_of(const Triangles& triangles, const VertexData& data) {
  Buffer buffer;
  std::string mesh;
  // The format does not allow a mesh without points, so an empty mesh is written as a scene without nodes.
  const bool is_empty = triangles.faces.empty();
  if (!is_empty) {
    add_points(triangles.points_mm, buffer);
    add_normals(triangles, buffer);
    std::string attributes = "\"POSITION\":0,\"NORMAL\":1";
    if (!data.colours.empty()) {
      attributes += ",\"COLOR_0\":2";
      const std::size_t colours = buffer.bytes.size();
      for (const glm::u8vec3& colour : data.colours) {
        for (int channel = 0; channel < 3; ++channel) append_little(buffer.bytes, linear_of(colour[channel]));
        append_little(buffer.bytes, std::uint16_t{65535});
      }
      buffer.close(colours, of_vertices,
                   "\"componentType\":5123,\"normalized\":true,\"type\":\"VEC4\",\"count\":" +
                       std::to_string(data.colours.size()));
    }
    add_corners(triangles.faces, buffer);
    mesh = std::string(",\"nodes\":[{\"mesh\":0,") + node_matrix +
           "}],\"meshes\":[{\"primitives\":[{\"attributes\":{" + attributes +
           "},\"indices\":" + std::to_string(buffer.count - 1) + ",\"material\":0}]}]," + material +
           arrays_of(buffer);
  }
  return file_of(is_empty ? "" : "\"nodes\":[0]", mesh, buffer);
}

std::string glb_of(const std::vector<glm::dvec3>& points_mm, const std::vector<GlbPart>& parts) {
  Buffer buffer;
  std::string numbers, nodes, meshes;
  int count = 0;
  for (const GlbPart& part : parts) {
    if (part.faces.empty()) continue;
    if (count == 0) add_points(points_mm, buffer);
    add_corners(part.faces, buffer);
    const std::string comma = count == 0 ? "" : ",", number = std::to_string(count++),
                      name = "{\"name\":" + quoted(part.name) + ",";
    numbers += comma + number;
    nodes += comma + name + "\"mesh\":" + number + "," + node_matrix + "}";
    meshes += comma + name + "\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":" +
              std::to_string(buffer.count - 1) + ",\"material\":0}]}";
  }
  if (count == 0) return file_of("", "", buffer);
  return file_of("\"nodes\":[" + numbers + "]",
                 ",\"nodes\":[" + nodes + "],\"meshes\":[" + meshes + "]," + material + arrays_of(buffer),
                 buffer);
}

}  // namespace octotomy::brep
