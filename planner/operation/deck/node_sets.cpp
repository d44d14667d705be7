// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/node_sets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>

#include "brep/io/read_mesh.h"
#include "brep/mesh/distance.h"
#include "convert/deck/deck_names.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/nearest_name.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

using convert::NodeSet;

/// Nodes count as on a plane within this share of the mean side of the surface's triangles. It is so small
/// that a plane along a row of nodes selects only that row.
constexpr double on_surface_share() {
  return 0.25;
}

/// A mesher's nodes on a flat face lie within this share of near_mm_ from the face.
constexpr double rounding_share() {
  return 0.1;
}

double mean_side_mm(const brep::Triangles& surface) {
  double sum = 0.0;
  for (const auto& face : surface.faces)
    for (std::size_t k = 0; k < 3; ++k)
      sum += glm::distance(surface.points_mm[face[k]], surface.points_mm[face[(k + 1) % 3]]);
  return sum / (3.0 * static_cast<double>(surface.faces.size()));
}

class Picker {
 public:
  Picker(const std::vector<brep::Landmark>& landmarks, const convert::Tetrahedra& tetrahedra)
      : landmarks_(landmarks),
        tetrahedra_(tetrahedra),
        surface_(convert::surface_of(tetrahedra)),
        near_mm_(on_surface_share() * mean_side_mm(surface_)) {}

  std::vector<std::uint32_t> nodes_at(const std::string& where) const {
    const std::vector<double> n = comma_numbers(where);
    const auto landmark = std::find_if(landmarks_.begin(), landmarks_.end(),
                                       [&](const brep::Landmark& known) { return known.name == where; });
    if (landmark != landmarks_.end()) return nearest(landmark->p_mm);
    if (n.size() == 3 || (n.size() == 4 && n[3] == 0.0)) return nearest({n[0], n[1], n[2]});
    if (n.size() == 4)
      return chosen([&](const glm::dvec3& p) { return glm::distance(p, {n[0], n[1], n[2]}) <= n[3]; });
    if (n.size() == 6 && glm::length(glm::dvec3(n[3], n[4], n[5])) > 0.0) {
      const glm::dvec3 normal = glm::normalize(glm::dvec3(n[3], n[4], n[5]));
      return on_plane({n[0], n[1], n[2]}, normal);
    }
    if (n.empty() && std::filesystem::exists(where)) return on_mesh(where);
    throw std::runtime_error("--nodes: '" + where +
                             "' is none of these: a point x,y,z, a ball x,y,z,r, a plane x,y,z,u,v,w, a "
                             "landmark of --landmarks, a mesh file");
  }

 private:
  template <typename Choose>
  std::vector<std::uint32_t> chosen(const Choose& choose) const {
    std::vector<std::uint32_t> nodes;
    for (const std::uint32_t v : tetrahedra_.boundary_nodes)
      if (choose(tetrahedra_.nodes_mm[v])) nodes.push_back(v);
    return nodes;
  }

  std::vector<std::uint32_t> on_plane(const glm::dvec3& point_mm, const glm::dvec3& normal) const {
    const auto is_near = [&](const glm::dvec3& p) {
      return std::abs(glm::dot(p - point_mm, normal)) <= near_mm_;
    };
    constexpr double along_cosine = 0.866;
    std::vector<std::uint32_t> of_faces;
    for (const auto& [a, b, c] : surface_.faces) {
      const glm::dvec3 &p = surface_.points_mm[a], &q = surface_.points_mm[b], &r = surface_.points_mm[c];
      const glm::dvec3 across = glm::cross(q - p, r - p);
      if (is_near(p) && is_near(q) && is_near(r) &&
          std::abs(glm::dot(across, normal)) >= along_cosine * glm::length(across))
        of_faces.insert(of_faces.end(), {a, b, c});
    }
    if (of_faces.empty()) return chosen(is_near);
    std::sort(of_faces.begin(), of_faces.end());
    of_faces.erase(std::unique(of_faces.begin(), of_faces.end()), of_faces.end());
    keep_along(point_mm, normal, of_faces);
    return of_faces;
  }

  /// Removes nodes that lie more than three times as far off the plane as the median. They belong to the
  /// rounded edges of the face; if they were held, the neighbouring faces would be clamped.
  void keep_along(const glm::dvec3& point_mm, const glm::dvec3& normal,
                  std::vector<std::uint32_t>& nodes) const {
    constexpr double most_medians = 3.0;
    std::vector<double> away_mm;
    for (const std::uint32_t v : nodes)
      away_mm.push_back(std::abs(glm::dot(tetrahedra_.nodes_mm[v] - point_mm, normal)));
    std::vector<double> sorted_mm = away_mm;
    const auto middle = sorted_mm.begin() + static_cast<std::ptrdiff_t>(sorted_mm.size() / 2);
    std::nth_element(sorted_mm.begin(), middle, sorted_mm.end());
    const double most_mm = std::max(most_medians * *middle, rounding_share() * near_mm_);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (away_mm[i] <= most_mm) nodes[kept++] = nodes[i];
    nodes.resize(kept);
  }

  std::vector<std::uint32_t> nearest(const glm::dvec3& p_mm) const {
    const auto& nodes = tetrahedra_.boundary_nodes;
    return {*std::min_element(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
      return glm::distance(tetrahedra_.nodes_mm[a], p_mm) < glm::distance(tetrahedra_.nodes_mm[b], p_mm);
    })};
  }

  std::vector<std::uint32_t> on_mesh(const std::string& path) const {
    std::vector<glm::dvec3> points_mm;
    for (const std::uint32_t v : tetrahedra_.boundary_nodes) points_mm.push_back(tetrahedra_.nodes_mm[v]);
    const std::vector<double> away_mm = brep::SurfaceTree(brep::read_triangles(path)).distances_mm(points_mm);
    std::vector<std::uint32_t> nodes;
    for (std::size_t i = 0; i < away_mm.size(); ++i)
      if (away_mm[i] <= near_mm_) nodes.push_back(tetrahedra_.boundary_nodes[i]);
    return nodes;
  }

  const std::vector<brep::Landmark>& landmarks_;
  const convert::Tetrahedra& tetrahedra_;
  brep::Triangles surface_;
  double near_mm_;
};

const NodeSet& set_called(const std::string& name, const std::vector<NodeSet>& sets,
                          const std::string& option) {
  std::vector<std::string> known;
  for (const NodeSet& set : sets) {
    if (set.name == name) return set;
    known.push_back(set.name);
  }
  throw std::runtime_error(option + ": '" + name + "' is none of the sets of --nodes" +
                           (known.empty() ? std::string() : suggestion(name, known)));
}

}  // namespace

void check_set_names(const std::vector<std::string>& words) {
  std::map<std::string, std::string> known;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw std::runtime_error("--nodes: '" + word + "' names no set: for example CUT=0,0,-40,0,0,1");
    const std::string name = word.substr(0, equals);
    if (!convert::is_solver_name(name))
      throw std::runtime_error("--nodes: '" + name +
                               "' is not a name that solvers accept: use a letter, then letters, digits, '_' "
                               "or '-', at most 80 characters");
    if (convert::is_own_node_set_name(name))
      throw std::runtime_error("--nodes: '" + name +
                               "' is the name of a set that every deck has, with or without capitals: choose "
                               "another, for example MY_" +
                               name);
    const auto [earlier, is_new] = known.emplace(voxel::lower_case(name), name);
    if (!is_new)
      throw std::runtime_error(
          "--nodes: " + name +
          (earlier->second == name
               ? " comes twice"
               : " and " + earlier->second +
                     " are the same name for solvers, which ignore capitals: rename one of them"));
  }
}

std::vector<NodeSet> picked_node_sets(const std::vector<std::string>& words,
                                      const std::vector<brep::Landmark>& landmarks,
                                      const convert::Tetrahedra& tetrahedra) {
  std::vector<NodeSet> sets;
  check_set_names(words);
  if (words.empty()) return sets;
  const Picker picker(landmarks, tetrahedra);
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    NodeSet set{word.substr(0, equals), picker.nodes_at(word.substr(equals + 1))};
    if (set.nodes.empty())
      throw std::runtime_error("--nodes: no node of the surface is at " + word.substr(equals + 1) +
                               ", so that " + set.name + " would be empty");
    sets.push_back(std::move(set));
  }
  return sets;
}

std::vector<convert::Prescribed> prescribed_of(const std::vector<std::string>& fixed,
                                               const std::vector<std::string>& moved,
                                               const std::vector<NodeSet>& sets) {
  std::vector<convert::Prescribed> step;
  std::vector<std::uint32_t> taken;
  const auto take = [&](const NodeSet& set, const std::string& option) {
    for (const std::uint32_t node : set.nodes)
      if (std::find(taken.begin(), taken.end(), node) != taken.end())
        throw std::runtime_error(
            option + ": " + set.name +
            " shares nodes with another set of --fix or --move: a node can have only one motion");
    taken.insert(taken.end(), set.nodes.begin(), set.nodes.end());
  };
  for (const std::string& name : fixed) {
    take(set_called(name, sets, "--fix"), "--fix");
    step.push_back({name, {}});
  }
  for (const std::string& word : moved) {
    const std::size_t equals = word.find('=');
    const std::vector<double> by =
        equals == std::string::npos ? std::vector<double>{} : comma_numbers(word.substr(equals + 1));
    if (by.size() != 3)
      throw std::runtime_error("--move: '" + word + "' is not a motion: for example PIN=0,0,-0.5");
    const NodeSet& set = set_called(word.substr(0, equals), sets, "--move");
    take(set, "--move");
    step.push_back({set.name, std::vector<glm::dvec3>(set.nodes.size(), {by[0], by[1], by[2]})});
  }
  if (fixed.empty() && !moved.empty())
    throw std::runtime_error(
        "--move: no nodes are fixed, so the whole body would move: name a set that stays by --fix");
  return step;
}

}  // namespace octotomy::planner
