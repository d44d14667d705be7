// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <unistd.h>

#include "convert/deck_format.h"

namespace octotomy::convert {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw std::invalid_argument(path.string() + ": " + why);
}

void check_name(const std::filesystem::path& path, const std::string& what, const std::string& name) {
  const auto fits = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  };
  if (name.empty() || name.size() > 80 || std::isalpha(static_cast<unsigned char>(name.front())) == 0 ||
      !std::all_of(name.begin(), name.end(), fits))
    refuse(path,
           what + " '" + name +
               "' is no name that Abaqus and CalculiX take: a letter, then letters, digits, '_', '-', at "
               "most 80 in all");
}

void check(const Tetrahedra& tetrahedra, const std::filesystem::path& path, const DeckOptions& options) {
  if (tetrahedra.tets.empty()) refuse(path, "there are no tetrahedra to write");
  const auto nodes = tetrahedra.nodes_mm.size();
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : tetrahedra.tets[t])
      if (node >= nodes)
        refuse(path, "tetrahedron " + std::to_string(t) + " names node " + std::to_string(node) + " of " +
                         std::to_string(nodes));
  for (const std::uint32_t node : tetrahedra.boundary_nodes)
    if (node >= nodes)
      refuse(path, "the surface names node " + std::to_string(node) + " of " + std::to_string(nodes));
  for (const glm::dvec3& p : tetrahedra.nodes_mm)
    if (!std::isfinite(p.x + p.y + p.z)) refuse(path, "a node is not finite");
  check_name(path, "element set", options.element_set);
  check_name(path, "node set", options.surface_node_set);
  check_name(path, "material", options.material);
  if (!(options.youngs_modulus_mpa > 0.0) || !std::isfinite(options.youngs_modulus_mpa))
    refuse(path, "Young's modulus must be positive");
  if (!(options.poisson_ratio > -1.0 && options.poisson_ratio < 0.5))
    refuse(path, "Poisson's ratio must lie between -1 and 0.5");
}

using Writer = void (*)(const Tetrahedra&, const DeckOptions&, std::ostream&);

Writer writer_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".inp") return write_inp;
  if (extension == ".vtu") return write_vtu;
  refuse(path, "'" + extension + "' is no deck this program writes: .inp or .vtu");
}

/// Removes the unfinished file unless it was renamed.
class Unfinished {
 public:
  explicit Unfinished(const std::filesystem::path& finished)
      : path_(finished.string() + "." + std::to_string(getpid()) + ".unfinished") {}
  ~Unfinished() {
    std::error_code ignored;  // it may never have been made, and there is no one left to tell
    if (!renamed_) std::filesystem::remove(path_, ignored);
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void rename_to(const std::filesystem::path& finished) {
    std::filesystem::rename(path_, finished);
    renamed_ = true;
  }

 private:
  std::filesystem::path path_;
  bool renamed_ = false;
};

}  // namespace

void write_deck(const Tetrahedra& tetrahedra, const std::filesystem::path& path, const DeckOptions& options) {
  const Writer write = writer_of(path);
  check(tetrahedra, path, options);
  Unfinished unfinished(path);
  std::ofstream out(unfinished.path(), std::ios::binary);
  if (!out) throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
  write(tetrahedra, options, out);
  out.close();
  if (!out) throw std::runtime_error(path.string() + ": cannot be written to its end: is the disk full?");
  unfinished.rename_to(path);
}

}  // namespace octotomy::convert
