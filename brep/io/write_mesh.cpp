// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/write_mesh.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>

#include "brep/io/mesh_bytes.h"
#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

/// Appends the shortest text that reads back to the same number.
template <typename T>
void append_text(std::string& bytes, T value) {
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  bytes.append(buffer, result.ptr);
}

void append_point(std::string& bytes, const glm::dvec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) bytes += ' ';
    append_text(bytes, p[axis]);
  }
  bytes += '\n';
}

void write_stl(const Triangles& triangles, Sink& sink) {
  std::string& bytes = sink.bytes;
  bytes = "octotomy, binary STL, LPS millimetres, SPACE=LPS";
  bytes.resize(80, ' ');
  append_little(bytes, static_cast<std::uint32_t>(triangles.faces.size()));
  for (const auto& face : triangles.faces) {
    const glm::dvec3 &a = triangles.points_mm[face[0]], &b = triangles.points_mm[face[1]],
                     &c = triangles.points_mm[face[2]];
    glm::dvec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    // In this format a zero vector means "no normal".
    normal = length > 0.0 ? normal / length : glm::dvec3(0.0);
    for (const glm::dvec3& v : {normal, a, b, c})
      for (int axis = 0; axis < 3; ++axis) append_little(bytes, static_cast<float>(v[axis]));
    append_little(bytes, std::uint16_t{0});
    sink.let_go();
  }
}

void write_ply(const Triangles& triangles, const VertexData& data, Sink& sink) {
  std::string& bytes = sink.bytes;
  bytes =
      "ply\nformat binary_little_endian 1.0\ncomment octotomy, LPS millimetres\ncomment SPACE=LPS\nelement "
      "vertex ";
  append_text(bytes, triangles.points_mm.size());
  bytes += "\nproperty double x\nproperty double y\nproperty double z";
  if (!data.colours.empty()) bytes += "\nproperty uchar red\nproperty uchar green\nproperty uchar blue";
  if (!data.scalars.empty()) bytes += "\nproperty double " + data.scalar_name;
  bytes += "\nelement face ";
  append_text(bytes, triangles.faces.size());
  bytes += "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t v = 0; v < triangles.points_mm.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) append_little(bytes, triangles.points_mm[v][axis]);
    if (!data.colours.empty())
      for (int channel = 0; channel < 3; ++channel) append_little(bytes, data.colours[v][channel]);
    if (!data.scalars.empty()) append_little(bytes, data.scalars[v]);
    sink.let_go();
  }
  for (const auto& face : triangles.faces) {
    append_little(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : face) append_little(bytes, static_cast<std::int32_t>(corner));
    sink.let_go();
  }
}

void write_obj(const Triangles& triangles, Sink& sink) {
  std::string& bytes = sink.bytes;
  bytes = "# octotomy, LPS millimetres\n# SPACE=LPS\n";
  for (const glm::dvec3& p : triangles.points_mm) {
    bytes += "v ";
    append_point(bytes, p);
    sink.let_go();
  }
  for (const auto& face : triangles.faces) {
    bytes += 'f';
    for (const std::uint32_t corner : face) {
      bytes += ' ';
      append_text(bytes, corner + 1);
    }
    bytes += '\n';
    sink.let_go();
  }
}

void write_off(const Triangles& triangles, Sink& sink) {
  std::string& bytes = sink.bytes;
  bytes = "OFF\n# octotomy, LPS millimetres\n";
  append_text(bytes, triangles.points_mm.size());
  bytes += ' ';
  append_text(bytes, triangles.faces.size());
  bytes += " 0\n";
  for (const glm::dvec3& p : triangles.points_mm) {
    append_point(bytes, p);
    sink.let_go();
  }
  for (const auto& face : triangles.faces) {
    bytes += '3';
    for (const std::uint32_t corner : face) {
      bytes += ' ';
      append_text(bytes, corner);
    }
    bytes += '\n';
    sink.let_go();
  }
}

/// The code of a failed system call: Resource if memory, the disk or one of their limits is exhausted.
ErrorCode code_of(int number) {
  return number == ENOSPC || number == EDQUOT || number == EFBIG || number == EIO || number == ENOMEM ||
                 number == EMFILE
             ? ErrorCode::Resource
             : ErrorCode::Input;
}

/// Throws Error with the file, the reason from the failed call's error number, and a remedy.
[[noreturn]] void refuse_unwritten(const std::filesystem::path& path, int number) {
  throw Error(code_of(number),
              path.string() + ": cannot be written: " + std::generic_category().message(number) +
                  (number == EFBIG ? "; raise the limit on the size of files (ulimit -f)"
                                   : "; check that its folder exists, may be written and has room"));
}

void check(const VertexData& data, std::size_t vertex_count) {
  const auto fits = [&](std::size_t count) { return count == 0 || count == vertex_count; };
  if (!fits(data.colours.size()) || !fits(data.scalars.size()))
    throw std::invalid_argument("write_mesh: vertex data are for another number of vertices than " +
                                std::to_string(vertex_count));
  const bool is_word = !data.scalar_name.empty() &&
                       std::all_of(data.scalar_name.begin(), data.scalar_name.end(),
                                   [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  if (!data.scalars.empty() && !is_word)
    throw std::invalid_argument("write_mesh: '" + data.scalar_name + "' is not a name for scalars");
}

}  // namespace

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void replace_file(const std::filesystem::path& path, const std::function<void(Sink&)>& write) {
  std::filesystem::path beside = path;
  beside += "." + std::to_string(::getpid()) + ".part";
  std::error_code ignored, error;
  {
    errno = 0;
    std::ofstream file(beside, std::ios::binary);
    Sink sink{file};
    write(sink);
    sink.flush();
    file.close();
    if (!file) {
      const int number = errno;
      std::filesystem::remove(beside, ignored);
      refuse_unwritten(path, number);
    }
  }
  std::filesystem::rename(beside, path, error);
  if (error) {
    std::filesystem::remove(beside, ignored);
    throw Error(code_of(error.value()), path.string() + ": cannot be replaced: " + error.message());
  }
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  replace_file(
      path, [&](Sink& sink) { sink.file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
}

std::uint64_t least_mesh_bytes(std::size_t vertex_count, std::size_t face_count,
                               const std::filesystem::path& path) {
  struct Least {
    std::string_view extension;
    std::uint64_t head, a_vertex, a_face;
  };
  // For formats as text, the bounds count the shortest lines: "v 0 0 0", "f 1 2 3", "0 0 0" and "3 0 1 2".
  constexpr std::array<Least, 6> formats{{{".stl", 84, 0, 50},
                                          {".ply", 0, 24, 13},
                                          {".obj", 0, 8, 8},
                                          {".off", 0, 6, 8},
                                          {".vtp", 0, 36, 32},
                                          {".glb", 0, 24, 12}}};
  const std::string extension = lower_extension(path);
  for (const Least& least : formats)
    if (least.extension == extension)
      return least.head + vertex_count * least.a_vertex + face_count * least.a_face;
  return 0;
}

void write_mesh(const Triangles& triangles, const std::filesystem::path& path, const VertexData& data) {
  const std::string extension = lower_extension(path);
  check(data, triangles.points_mm.size());
  if (extension == ".ply") return replace_file(path, [&](Sink& sink) { write_ply(triangles, data, sink); });
  if (extension == ".vtp")
    return replace_file(path, [&](Sink& sink) { write_vtp(triangles, data, {}, sink); });
  if (extension == ".glb" && data.scalars.empty())
    return replace_file(path, [&](Sink& sink) { sink.bytes = glb_of(triangles, data); });
  if (!data.colours.empty() || !data.scalars.empty())
    throw Error(ErrorCode::Input,
                path.string() +
                    ": colours of vertices go into .ply, .vtp and .glb, scalars into .ply and "
                    ".vtp");
  if (extension == ".stl") return replace_file(path, [&](Sink& sink) { write_stl(triangles, sink); });
  if (extension == ".obj") return replace_file(path, [&](Sink& sink) { write_obj(triangles, sink); });
  if (extension == ".off") return replace_file(path, [&](Sink& sink) { write_off(triangles, sink); });
  throw Error(ErrorCode::Input,
              path.string() + ": '" + extension +
                  "' is not a mesh format that can be written; use .stl, .ply, .obj, .off, .vtp or .glb");
}

void write_mesh(const Mesh& mesh, const std::filesystem::path& path, const VertexData& data) {
  write_mesh(triangles_of(mesh), path, data);
}

}  // namespace octotomy::brep
