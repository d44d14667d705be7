// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// What a file may say of vertices beside their places; each list is empty or has one entry a vertex.
struct VertexData {
  std::vector<glm::u8vec3> colours;  ///< red, green, blue, sRGB
  std::string scalar_name;           ///< a word of letters, digits and _; its unit last, as in distance_mm
  std::vector<double> scalars;
};

/// Bytes that a file of so many vertices and triangles takes at least, by its extension; 0 where write_mesh()
/// knows none.
std::uint64_t least_mesh_bytes(std::size_t vertex_count, std::size_t face_count,
                               const std::filesystem::path& path);

/// Writes .stl (binary; points in single precision), .ply (binary little-endian, double), .obj or .off (text
/// that reads back to the same doubles), .vtp (doubles, with normals) or .glb (single precision, with
/// normals; turned to that format's axes and metres by its node) as the extension says; LPS millimetres.
/// Colours go into .ply, .vtp and .glb, scalars under their own name into .ply and .vtp. Written beside and
/// renamed into place, so that a reader sees the old file or the whole new one. Precondition: nothing is
/// marked as deleted. Throws std::invalid_argument if vertex data do not fit the mesh; Error with path and
/// reason: Input if the format holds none or the file cannot be written, Resource if the disk gave out. What
/// was there before stays.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path, const VertexData& data = {});
void write_mesh(const Triangles& triangles, const std::filesystem::path& path, const VertexData& data = {});

}  // namespace octotomy::brep
