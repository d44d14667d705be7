// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/write_parts.h"

#include <array>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <string>

#include "brep/io/mesh_bytes.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

using Corners = std::array<std::uint32_t, 3>;

/// Calls f with the corners of each triangle of a part's surface, outward.
template <typename F>
void for_faces(const PartedSurface& parted, int part, const F& f) {
  for (std::size_t i = 0; i < parted.sides.size(); ++i) {
    const Corners& face = parted.triangles.faces[i];
    if (parted.sides[i].behind == part) f(face);
    if (parted.sides[i].front == part) f(Corners{face[0], face[2], face[1]});
  }
}

/// A name without characters that end a line or a word in a text file.
std::string word_of(std::string name) {
  for (char& letter : name)
    if (static_cast<unsigned char>(letter) <= ' ' || letter == 0x7f) letter = '_';
  return name;
}

std::string obj_of(const PartedSurface& parted) {
  std::string text = "# octotomy, LPS millimetres\n# SPACE=LPS\n";
  std::array<char, 40> buffer{};
  const auto append = [&](auto value) {
    text += ' ';
    text.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
  };
  for (const glm::dvec3& p : parted.triangles.points_mm) {
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) append(p[axis]);
    text += '\n';
  }
  for (const auto& [part, name] : parted.names) {
    text += "g " + word_of(name) + '\n';
    for_faces(parted, part, [&](const Corners& face) {
      text += 'f';
      for (const std::uint32_t corner : face) append(corner + 1);
      text += '\n';
    });
  }
  return text;
}

/// The data of a .vtp about the triangles and the parts.
CellData cells_of(const PartedSurface& parted) {
  CellData data;
  data.numbers = {{"part_behind", {}}, {"part_in_front", {}}};
  for (const PartedSurface::Sides& sides : parted.sides) {
    data.numbers[0].second.push_back(sides.behind);
    data.numbers[1].second.push_back(sides.front);
  }
  for (const auto& [part, name] : parted.names) {
    data.part_numbers.push_back(part);
    data.part_names.push_back(name);
  }
  return data;
}

}  // namespace

Triangles surface_of_part(const PartedSurface& parted, int part) {
  Triangles surface;
  std::vector<std::uint32_t> number(parted.triangles.points_mm.size(), unused);
  for_faces(parted, part, [&](const Corners& face) {
    for (const std::uint32_t corner : face) number[corner] = 0;
    surface.faces.push_back(face);
  });
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] != unused) {
      number[i] = static_cast<std::uint32_t>(surface.points_mm.size());
      surface.points_mm.push_back(parted.triangles.points_mm[i]);
    }
  for (Corners& face : surface.faces)
    for (std::uint32_t& corner : face) corner = number[corner];
  return surface;
}

bool is_parts_file(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".vtp" || extension == ".obj" || extension == ".glb";
}

void write_parts(const PartedSurface& parted, const std::filesystem::path& path) {
  if (parted.sides.size() != parted.triangles.faces.size())
    throw std::invalid_argument("write_parts: sides are for another number of triangles");
  for (const PartedSurface::Sides& sides : parted.sides)
    for (const std::int32_t part : {sides.behind, sides.front})
      if (sides.behind == sides.front || (part != 0 && !parted.names.contains(part)))
        throw std::invalid_argument("write_parts: part " + std::to_string(part) +
                                    " has no name or lies on both sides");
  const std::string extension = lower_extension(path);
  if (extension == ".vtp")
    return replace_file(path, [cells = cells_of(parted), &parted](Sink& sink) {
      write_vtp(parted.triangles, {}, cells, sink);
    });
  if (extension == ".obj") return write_bytes(path, obj_of(parted));
  if (extension != ".glb")
    throw Error(ErrorCode::Input, path.string() + ": several parts are written as .vtp, .obj or .glb");
  std::vector<GlbPart> parts;
  for (const auto& [part, name] : parted.names) {
    parts.push_back({name, {}});
    for_faces(parted, part, [&](const Corners& face) { parts.back().faces.push_back(face); });
  }
  write_bytes(path, glb_of(parted.triangles.points_mm, parts));
}

}  // namespace octotomy::brep
