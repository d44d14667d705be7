// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"

// The formats that carry normals, as the bytes of a file. What is said of vertices fits the triangles.
namespace octotomy::brep {

/// What a .vtp may say of triangles, one number each by name, and of the parts that a file holds.
struct CellData {
  std::vector<std::pair<std::string, std::vector<std::int32_t>>> numbers;
  std::vector<int> part_numbers;
  std::vector<std::string> part_names;
};

/// VTK's XML polydata with raw data appended: points and vertex data as doubles, normals in single precision,
/// which are left out with numbers of cells.
std::string vtp_of(const Triangles& triangles, const VertexData& data, const CellData& cells = {});

/// glTF 2.0, binary: single precision millimetres, and a node that turns them to the format's metres with y
/// to the head and z to the front. Scalars have no place in it.
std::string glb_of(const Triangles& triangles, const VertexData& data);

/// Triangles under a name.
struct GlbPart {
  std::string name;
  std::vector<std::array<std::uint32_t, 3>> faces;
};
/// The same with a named node a part, all over the same points and without normals.
std::string glb_of(const std::vector<glm::dvec3>& points_mm, const std::vector<GlbPart>& parts);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// Writes beside the path and renames. Throws Error with path and reason.
void write_bytes(const std::filesystem::path& path, const std::string& bytes);

/// Unit normals of the points, those of the triangles about each weighted by area; (0, 0, 1), as formats want
/// unit length, where they cancel or there are none.
std::vector<glm::vec3> vertex_normals(const Triangles& triangles);

/// Appends a number's bytes, least significant first.
template <typename T>
void append_little(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

}  // namespace octotomy::brep
