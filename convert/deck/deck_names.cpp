// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/deck_names.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "convert/deck/deck_format.h"
#include "voxel/space/file_text.h"

namespace octotomy::convert {
namespace {

constexpr std::size_t longest_name = 80;

/// The names of one kind in use, compared without regard to case, each with a description of its holder.
class Taken {
 public:
  /// Returns the holder of an equal name, compared without regard to case. If there is none, adds the name
  /// and returns none.
  std::optional<std::string> take(const std::string& what, const std::string& name) {
    const auto [holder, is_new] = holders_.emplace(voxel::lower_case(name), what + " '" + name + "'");
    if (is_new) return std::nullopt;
    return holder->second;
  }
  bool has(const std::string& name) const { return holders_.contains(voxel::lower_case(name)); }

 private:
  std::map<std::string, std::string> holders_;
};

/// Names of node sets that every deck has: in .inp, the set of all nodes has the element set's name after an
/// N; in FEBio, it has the element set's name.
Taken own_node_sets(const DeckOptions& options) {
  Taken taken;
  taken.take("the surface's node set", options.surface_node_set);
  taken.take("the surface's array of .vtu", "surface");
  taken.take("the set of all nodes", options.element_set);
  taken.take("the set of all nodes", "N" + options.element_set);
  return taken;
}

/// Names that some format keeps in one list with surfaces: sets of elements, Gmsh's volumes, arrays of .vtu.
Taken own_surfaces(const Tetrahedra& tetrahedra, const DeckOptions& options) {
  Taken taken;
  taken.take("the element set", options.element_set);
  for (std::uint32_t r = 0; r < region_count(tetrahedra); ++r) taken.take("region", region_name(r));
  for (const char* name : {"region", "material"}) taken.take("the array", name);
  if (options.materials.size() > 1)
    for (const DeckMaterial& material : options.materials)
      taken.take("the element set of a material", "E" + material.name);
  for (const ElementField& field : options.fields) taken.take("field", field.name);
  return taken;
}

/// Calls visit(names of the same kind in use, kind, name) for each name that may be changed, in the deck's
/// order.
template <typename Options, typename Visit>
void for_each_name(const Tetrahedra& tetrahedra, Options& options, const Visit& visit) {
  Taken materials;
  for (auto& material : options.materials) visit(materials, "material", material.name);
  Taken node_sets = own_node_sets(options);
  for (auto& set : options.node_sets) visit(node_sets, "node set", set.name);
  Taken surfaces = own_surfaces(tetrahedra, options);
  for (auto& surface : options.surfaces) visit(surfaces, "surface", surface.name);
  Taken contacts;
  for (auto& pair : options.contacts) visit(contacts, "contact pair", pair.name);
}

/// A similar name that is not in use.
std::string free_name(const std::string& name, const Taken& taken) {
  std::string begin = name;
  if (begin.empty() || std::isalpha(static_cast<unsigned char>(begin.front())) == 0) begin.insert(0, "X");
  if (begin == name && name.size() <= longest_name && !taken.has(name)) return name;
  if (begin.size() <= longest_name && !taken.has(begin)) return begin;
  for (int number = 2;; ++number) {
    const std::string end = "_" + std::to_string(number);
    const std::string tried = begin.substr(0, longest_name - end.size()) + end;
    if (!taken.has(tried)) return tried;
  }
}

}  // namespace

bool is_solver_name(const std::string& name) {
  const auto fits = [](unsigned char c) { return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '-'); };
  return !name.empty() && name.size() <= longest_name && fits(static_cast<unsigned char>(name.front())) &&
         std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
         std::all_of(name.begin(), name.end(), fits);
}

bool is_own_node_set_name(const std::string& name, const DeckOptions& options) {
  return own_node_sets(options).has(name);
}

std::optional<std::string> name_clash(const Tetrahedra& tetrahedra, const DeckOptions& options) {
  std::optional<std::string> clash;
  for_each_name(tetrahedra, options, [&](Taken& taken, const std::string& what, const std::string& name) {
    const std::optional<std::string> holder = taken.take(what, name);
    if (holder && !clash) clash = what + " '" + name + "' and " + *holder;
  });
  return clash;
}

std::vector<std::string> make_names_unique(const Tetrahedra& tetrahedra, DeckOptions& options) {
  std::vector<std::string> changed;
  // A set is identified by its position in the list, because two sets may have one name.
  const auto place_of = [](const auto& list, const std::string& name) {
    std::size_t place = 0;
    while (place < list.size() && list[place].name != name) ++place;
    return place;
  };
  std::vector<std::size_t> prescribed, slaves, masters;
  for (const Prescribed& each : options.prescribed)
    prescribed.push_back(place_of(options.node_sets, each.node_set));
  for (const ContactPair& pair : options.contacts) {
    slaves.push_back(place_of(options.surfaces, pair.slave));
    masters.push_back(place_of(options.surfaces, pair.master));
  }
  for_each_name(tetrahedra, options, [&](Taken& taken, const std::string& what, std::string& name) {
    const std::string free = free_name(name, taken);
    if (free != name)
      changed.push_back(what + " '" + name + "' is written as '" + free +
                        "': solvers ignore case, and that name is in use");
    name = free;
    taken.take(what, name);
  });
  for (std::size_t i = 0; i < prescribed.size(); ++i)
    if (prescribed[i] < options.node_sets.size())
      options.prescribed[i].node_set = options.node_sets[prescribed[i]].name;
  for (std::size_t i = 0; i < options.contacts.size(); ++i) {
    if (slaves[i] < options.surfaces.size()) options.contacts[i].slave = options.surfaces[slaves[i]].name;
    if (masters[i] < options.surfaces.size()) options.contacts[i].master = options.surfaces[masters[i]].name;
  }
  return changed;
}

}  // namespace octotomy::convert
