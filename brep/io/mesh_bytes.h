// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"

// Writers of the formats that have normals. Precondition: vertex data have one entry per point.
namespace octotomy::brep {

/// Data of a .vtp: named lists with one number per triangle, and the parts in the file.
struct CellData {
  std::vector<std::pair<std::string, std::vector<std::int32_t>>> numbers;
  std::vector<int> part_numbers;
  std::vector<std::string> part_names;
};

/// Collects a file's text and writes it in pieces, so that the whole file need not be in memory.
struct Sink {
  std::ofstream& file;
  std::string bytes{};

  /// Writes the collected text if it is large. Called between items.
  void let_go() {
    if (bytes.size() >= (1u << 20)) flush();
  }
  void flush() {
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.clear();
  }
};

/// Calls `write`, which writes to a temporary file, and renames that file to `path`. Throws Error with path
/// and reason.
void replace_file(const std::filesystem::path& path, const std::function<void(Sink&)>& write);

/// VTK's XML polydata with raw data appended: points and vertex data as doubles, normals in single precision.
/// Normals are omitted if `cells` has numbers.
void write_vtp(const Triangles& triangles, const VertexData& data, const CellData& cells, Sink& sink);

/// glTF 2.0, binary: single precision millimetres, and a node that transforms them to the format's metres
/// with y to the head and z to the front. Scalars are not written.
std::string glb_of(const Triangles& triangles, const VertexData& data);

/// Triangles with a name.
struct GlbPart {
  std::string name;
  std::vector<std::array<std::uint32_t, 3>> faces;
};
/// A GLB file with one named node per part; all parts share the points and have no normals.
std::string glb_of(const std::vector<glm::dvec3>& points_mm, const std::vector<GlbPart>& parts);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& path);

/// As replace_file().
void write_bytes(const std::filesystem::path& path, const std::string& bytes);

/// Unit normals of the points: means of the surrounding triangles' normals, weighted by area. (0, 0, 1) where
/// these cancel or a point has no triangles, because the formats require unit length.
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
