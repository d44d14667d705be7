// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/calculix_result.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "voxel/space/regular_file.h"

// The text form of CalculiX's result: a block begins with " -4 DISP" and ends with " -3". Each of its lines
// holds " -1", the node in 10 characters and three values in 12 each, without space between them. Source:
// CalculiX GraphiX manual, "Result format".

namespace octotomy::convert {
namespace {

constexpr std::size_t node_at = 3;
constexpr std::size_t node_width = 10;
constexpr std::size_t value_width = 12;

[[noreturn]] void refuse(const std::filesystem::path& path, std::size_t line, const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Input, path.string() + ", line " + std::to_string(line) + ": " + why);
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Input, path.string() + ": " + why);
}

std::ifstream opened(const std::filesystem::path& path) {
  voxel::need_regular_file(path);
  std::ifstream in(path);
  if (!in) refuse(path, "cannot be read");
  return in;
}

double bytes_of(const std::filesystem::path& path) {
  return std::max(1.0, static_cast<double>(std::filesystem::file_size(path)));
}

/// A line of a result and its number.
struct Line {
  const std::filesystem::path& path;
  const voxel::Progress& progress;
  double bytes = 1.0;  ///< of the file
  std::size_t number = 0;
  std::string text{};

  bool next(std::ifstream& in) {
    constexpr std::size_t look_every = 16384;  // lines: some milliseconds
    if (number++ % look_every == 0) progress.at(std::min(1.0, static_cast<double>(in.tellg()) / bytes));
    return static_cast<bool>(std::getline(in, text));
  }
  bool begins(const char* with) const { return text.rfind(with, 0) == 0; }
  void need(std::size_t size) const {
    if (text.size() < size) refuse(path, number, "is cut short");
  }
  /// The whole number in a field.
  long whole(std::size_t at, std::size_t width) const {
    return std::strtol(text.substr(at, width).c_str(), nullptr, 10);
  }
  /// The three values of a node.
  glm::dvec3 vector() const {
    need(node_at + node_width + 3 * value_width);
    glm::dvec3 v(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string field =
          text.substr(node_at + node_width + static_cast<std::size_t>(axis) * value_width, value_width);
      char* end = nullptr;
      v[axis] = std::strtod(field.c_str(), &end);
      if (end == field.c_str() || !std::isfinite(v[axis]))
        refuse(path, number, "'" + field + "' is no number");
    }
    return v;
  }
};

/// Reads the block of nodes. Node n is on the n-th line, as write_deck() numbers nodes.
void read_nodes(std::ifstream& in, Line& line, Tetrahedra& tetrahedra) {
  while (line.next(in) && !line.begins(" -3")) {
    const glm::dvec3 p_mm = line.vector();
    if (line.whole(node_at, node_width) != static_cast<long>(tetrahedra.nodes_mm.size()) + 1)
      refuse(line.path, line.number,
             "nodes are not numbered from 1 on: only results of octotomy's decks can be read");
    tetrahedra.nodes_mm.push_back(p_mm);
  }
}

/// Divides a second-order tetrahedron, by its ten nodes, into eight linear ones: one at each corner, and four
/// around the line that joins the middles of the first and the last side. Neighbours divide their common face
/// in the same way.
constexpr std::array<std::array<std::uint8_t, 4>, 8> linear_parts{{{0, 4, 6, 7},
                                                                   {1, 5, 4, 8},
                                                                   {2, 6, 5, 9},
                                                                   {3, 7, 9, 8},
                                                                   {4, 9, 5, 6},
                                                                   {4, 9, 6, 7},
                                                                   {4, 9, 7, 8},
                                                                   {4, 9, 8, 5}}};

/// Reads the block of elements. Each has two lines: its type and its nodes.
void read_elements(std::ifstream& in, Line& line, Tetrahedra& tetrahedra) {
  constexpr std::size_t type_at = node_at + node_width, type_width = 5;
  constexpr long linear_tetrahedron = 3, quadratic_tetrahedron = 6;
  while (line.next(in) && !line.begins(" -3")) {
    line.need(type_at + type_width);
    const long type = line.whole(type_at, type_width);
    if (type != linear_tetrahedron && type != quadratic_tetrahedron)
      refuse(line.path, line.number, "is no tetrahedron");
    const std::size_t count = type == linear_tetrahedron ? 4 : 10;
    if (!line.next(in)) refuse(line.path, line.number, "ends within an element");
    line.need(node_at + count * node_width);
    std::array<std::uint32_t, 10> nodes{};
    for (std::size_t i = 0; i < count; ++i) {
      const long node = line.whole(node_at + i * node_width, node_width);
      if (node < 1 || static_cast<std::size_t>(node) > tetrahedra.nodes_mm.size())
        refuse(line.path, line.number, "node " + std::to_string(node) + " is not in the file");
      nodes.at(i) = static_cast<std::uint32_t>(node - 1);
    }
    if (type == linear_tetrahedron) {
      tetrahedra.tets.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
      continue;
    }
    for (const auto& [a, b, c, d] : linear_parts)
      tetrahedra.tets.push_back({nodes.at(a), nodes.at(b), nodes.at(c), nodes.at(d)});
  }
}

/// The displacements of the last step, from the current line on.
std::vector<std::optional<glm::dvec3>> displacements_from(std::ifstream& in, Line& line,
                                                          std::size_t node_count) {
  std::vector<std::optional<glm::dvec3>> result(node_count);
  bool within = false;
  bool found = false;
  do {
    if (line.begins(" -4")) {
      within = line.text.find("DISP") != std::string::npos;
      found = found || within;
    } else if (line.begins(" -3")) {
      within = false;
    } else if (within && line.begins(" -1")) {
      const glm::dvec3 displacement = line.vector();
      const long node = line.whole(node_at, node_width);
      if (node < 1 || static_cast<std::size_t>(node) > node_count)
        refuse(line.path, line.number,
               "node " + std::to_string(node) + " is not among the deck's nodes, 1 to " +
                   std::to_string(node_count));
      result[static_cast<std::size_t>(node - 1)] = displacement;
    }
  } while (line.next(in));
  if (!found)
    refuse(line.path, "holds no displacements: the solver ended before it completed the step; see its log");
  line.progress.at(1.0);
  return result;
}

}  // namespace

std::vector<std::optional<glm::dvec3>> read_displacements(const std::filesystem::path& frd,
                                                          std::size_t node_count,
                                                          const voxel::Progress& progress) {
  std::ifstream in = opened(frd);
  Line line{frd, progress, bytes_of(frd)};
  return displacements_from(in, line, node_count);
}

SolvedDeck read_solved_deck(const std::filesystem::path& frd, const voxel::Progress& progress) {
  std::ifstream in = opened(frd);
  Line line{frd, progress, bytes_of(frd)};
  SolvedDeck deck;
  while (line.next(in) && !line.begins(" -4")) {
    if (line.begins("    2C")) read_nodes(in, line, deck.tetrahedra);
    if (line.begins("    3C")) read_elements(in, line, deck.tetrahedra);
  }
  if (deck.tetrahedra.tets.empty())
    refuse(frd, "holds no elements: give the .frd file that CalculiX wrote of the deck");
  deck.tetrahedra.boundary_nodes = boundary_nodes(deck.tetrahedra.tets);
  deck.tetrahedra.method = "CalculiX";
  const auto displacements = displacements_from(in, line, deck.tetrahedra.nodes_mm.size());
  for (std::size_t node = 0; node < displacements.size(); ++node) {
    if (!displacements[node]) refuse(frd, "node " + std::to_string(node + 1) + " has no displacement");
    deck.displacement_mm.push_back(*displacements[node]);
  }
  return deck;
}

}  // namespace octotomy::convert
