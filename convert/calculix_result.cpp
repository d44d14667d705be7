// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/calculix_result.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>

// The text form of CalculiX's result: a block begins " -4  DISP", its lines are " -1", the node in 10
// characters and three values in 12 each, without space between them, and it ends " -3". Source: CalculiX
// GraphiX manual, "Result format".

namespace octotomy::convert {
namespace {

constexpr std::size_t node_at = 3;
constexpr std::size_t node_width = 10;
constexpr std::size_t value_width = 12;

[[noreturn]] void refuse(const std::filesystem::path& path, std::size_t line, const std::string& why) {
  throw std::runtime_error(path.string() + ", line " + std::to_string(line) + ": " + why);
}

bool begins(const std::string& line, const std::string& with) {
  return line.compare(0, with.size(), with) == 0;
}

}  // namespace

std::vector<std::optional<glm::dvec3>> read_displacements(const std::filesystem::path& frd,
                                                          std::size_t node_count) {
  std::ifstream in(frd);
  if (!in) throw std::runtime_error(frd.string() + ": cannot be read");
  std::vector<std::optional<glm::dvec3>> result(node_count);
  bool within = false;
  bool found = false;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (begins(line, " -4")) {
      within = line.find("DISP") != std::string::npos;
      found = found || within;
    } else if (begins(line, " -3")) {
      within = false;
    } else if (within && begins(line, " -1")) {
      if (line.size() < node_at + node_width + 3 * value_width) refuse(frd, number, "is cut short");
      const long node = std::strtol(line.substr(node_at, node_width).c_str(), nullptr, 10);
      if (node < 1 || static_cast<std::size_t>(node) > node_count)
        refuse(frd, number,
               "node " + std::to_string(node) + " is none of the deck's " + std::to_string(node_count));
      glm::dvec3 u(0.0);
      for (int axis = 0; axis < 3; ++axis) {
        const std::string text =
            line.substr(node_at + node_width + static_cast<std::size_t>(axis) * value_width, value_width);
        char* end = nullptr;
        u[axis] = std::strtod(text.c_str(), &end);
        if (end == text.c_str() || !std::isfinite(u[axis]))
          refuse(frd, number, "'" + text + "' is no displacement");
      }
      result[static_cast<std::size_t>(node - 1)] = u;
    }
  }
  if (!found)
    throw std::runtime_error(frd.string() +
                             ": holds no displacements: did the solver end before its step did?");
  return result;
}

}  // namespace octotomy::convert
