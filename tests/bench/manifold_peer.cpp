// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/manifold_peer.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tests/bench/workspace.h"

namespace octotomy::bench {
namespace {

namespace fs = std::filesystem;

/// Appends a surface in the form that manifold_peer.mjs reads: two counts, points in single precision, which
/// is Manifold's, and corners.
void append(std::ofstream& out, const brep::Triangles& surface) {
  const auto put = [&](auto value) { out.write(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(surface.points_mm.size()));
  put(static_cast<std::uint32_t>(surface.faces.size()));
  for (const glm::dvec3& p : surface.points_mm)
    for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(p[axis]));
  for (const auto& face : surface.faces)
    for (const std::uint32_t corner : face) put(corner);
}

}  // namespace

fs::path manifold_folder() {
  const char* named = std::getenv("OCTOTOMY_MANIFOLD");
  for (const fs::path& folder :
       {fs::path(named == nullptr ? "" : named), fs::path("/usr/local/lib/node_modules/manifold-3d"),
        fs::path("/usr/lib/node_modules/manifold-3d")})
    if (!folder.empty() && fs::exists(folder / "manifold.js")) return fs::absolute(folder);
  return {};
}

ManifoldAnswer manifold_boolean(const brep::Triangles& a, const brep::Triangles& b, bool is_union) {
  const fs::path operands = workspace() / "operands.bin";
  {
    std::ofstream out(operands, std::ios::binary);
    append(out, a);
    append(out, b);
  }
  const std::string command = "node '" OCTOTOMY_SOURCE_DIR "/tests/bench/manifold_peer.mjs' '" +
                              manifold_folder().string() + "' '" + operands.string() + "' " +
                              (is_union ? "union" : "difference");
  ManifoldAnswer answer;
  std::FILE* said = ::popen(command.c_str(), "r");
  const int read = said == nullptr ? 0 : std::fscanf(said, "%lf %zu", &answer.seconds, &answer.triangles);
  const int status = said == nullptr ? 1 : ::pclose(said);
  fs::remove(operands);
  if (read != 2 || status != 0) throw std::runtime_error("Manifold did not answer: " + command);
  return answer;
}

}  // namespace octotomy::bench
