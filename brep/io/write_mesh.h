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

/// Data of vertices besides their positions; each list is empty or has one entry per vertex.
struct VertexData {
  std::vector<glm::u8vec3> colours;  ///< red, green, blue, sRGB
  std::string scalar_name;           ///< a word of letters, digits and _; its unit last, as in distance_mm
  std::vector<double> scalars;
};

/// A lower bound on the bytes of a file with these numbers of vertices and triangles, by its extension; 0 for
/// formats that write_mesh() does not write.
std::uint64_t least_mesh_bytes(std::size_t vertex_count, std::size_t face_count,
                               const std::filesystem::path& path);

/// Writes .stl (binary; points in single precision), .ply (binary little-endian, double), .obj or .off (text
/// that reads back to the same doubles), .vtp (doubles, with normals) or .glb (single precision, with
/// normals; converted to that format's axes and metres by its node), by the extension; LPS millimetres.
/// Colours are written to .ply, .vtp and .glb, scalars under their own name to .ply and .vtp. Written to a
/// temporary file and renamed into place, so that readers see either the old file or the whole new one.
/// Precondition: nothing is marked as deleted. Throws std::invalid_argument if vertex data do not fit the
/// mesh; Error with path and reason: Input if the format cannot hold the data or the file cannot be written,
/// Resource if disk space is exhausted. An older file then stays unchanged.
void write_mesh(const Mesh& mesh, const std::filesystem::path& path, const VertexData& data = {});
void write_mesh(const Triangles& triangles, const std::filesystem::path& path, const VertexData& data = {});

}  // namespace octotomy::brep
