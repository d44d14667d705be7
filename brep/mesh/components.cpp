// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/components.h"

#include <algorithm>
#include <cassert>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/mesh_point.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

struct Shell {
  std::vector<std::uint32_t> faces;
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  glm::dvec3 probe_mm{0.0};  ///< a vertex; if possible, one that no other shell touches
};

/// Labels faces connected across edges; labels ascend with a shell's first face.
std::vector<std::uint32_t> labels_of(DisjointSets& shells, std::size_t face_count,
                                     std::uint32_t& shell_count) {
  std::vector<std::uint32_t> label(face_count);
  shell_count = 0;
  for (std::uint32_t f = 0; f < face_count; ++f) {
    const std::uint32_t first = shells.set_of(f);
    label[f] = first == f ? shell_count++ : label[first];
  }
  return label;
}

/// Shells with their integrals, computed relative to the first point of each to preserve digits.
std::vector<Shell> measure_shells(const Triangles& triangles, const std::vector<std::uint32_t>& label,
                                  std::uint32_t shell_count) {
  std::vector<Shell> shells(shell_count);
  assert(label.size() == triangles.faces.size());
  for (std::uint32_t f = 0; f < label.size(); ++f) {
    assert(label[f] < shell_count);
    shells[label[f]].faces.push_back(f);
  }
  // A point that coincides with one of another shell is unsuitable: whether it is inside that shell is
  // arbitrary.
  const std::vector<std::uint8_t> touching =
      shell_count > 1 ? shared_points(triangles, first_equal_points(triangles.points_mm), label)
                      : std::vector<std::uint8_t>(triangles.points_mm.size(), 0);
  for (Shell& shell : shells) {
    std::optional<glm::dvec3> origin;
    bool probe_touches = true;
    for (const std::uint32_t f : shell.faces) {
      const auto& face = triangles.faces[f];
      const glm::dvec3 &a = triangles.points_mm[face[0]], &b = triangles.points_mm[face[1]],
                       &c = triangles.points_mm[face[2]];
      if (!origin) {
        origin = a;
        shell.probe_mm = a;
      }
      if (probe_touches && !touching[face[0]]) {
        shell.probe_mm = a;
        probe_touches = false;
      }
      const glm::dvec3 normal = glm::cross(b - a, c - a);
      shell.volume_mm3 += glm::dot(a - *origin, normal) / 6.0;
      shell.area_mm2 += 0.5 * glm::length(normal);
    }
  }
  return shells;
}

/// The smallest outward shell around a cavity's shell.
std::optional<std::uint32_t> shell_around(std::uint32_t cavity, const std::vector<Shell>& shells,
                                          const std::vector<std::uint32_t>& label, const SurfaceTree& tree) {
  assert(cavity < shells.size() && shells[cavity].volume_mm3 < 0.0);
  std::map<std::uint32_t, bool> odd;
  for (const Crossing& crossing : tree.crossings(shells[cavity].probe_mm)) {
    bool& parity = odd[label[crossing.face]];
    parity = !parity;
  }
  std::optional<std::uint32_t> around;
  for (const auto& [shell, inside] : odd) {
    if (!inside || shell == cavity || shells[shell].volume_mm3 < 0.0) continue;
    if (!around || shells[shell].volume_mm3 < shells[*around].volume_mm3) around = shell;
  }
  return around;
}

std::vector<Component> components_of(const Triangles& triangles, DisjointSets& joined,
                                     const std::function<const SurfaceTree&()>& tree) {
  std::uint32_t shell_count = 0;
  const std::vector<std::uint32_t> label = labels_of(joined, triangles.faces.size(), shell_count);
  const std::vector<Shell> shells = measure_shells(triangles, label, shell_count);

  std::vector<std::uint32_t> owner(shell_count);
  for (std::uint32_t s = 0; s < shell_count; ++s) {
    owner[s] = s;
    if (shells[s].volume_mm3 >= 0.0) continue;
    owner[s] = shell_around(s, shells, label, tree()).value_or(s);
  }

  assert(std::accumulate(shells.begin(), shells.end(), std::size_t{0},
                         [](std::size_t sum, const Shell& shell) { return sum + shell.faces.size(); }) ==
         triangles.faces.size());
  std::vector<Component> by_shell(shell_count);
  for (std::uint32_t s = 0; s < shell_count; ++s) {
    Component& component = by_shell[owner[s]];
    component.faces.insert(component.faces.end(), shells[s].faces.begin(), shells[s].faces.end());
    component.volume_mm3 += shells[s].volume_mm3;
    component.area_mm2 += shells[s].area_mm2;
    if (owner[s] != s) ++component.cavities;
  }
  std::erase_if(by_shell, [](const Component& component) { return component.faces.empty(); });
  for (Component& component : by_shell) std::sort(component.faces.begin(), component.faces.end());
  std::sort(by_shell.begin(), by_shell.end(), [](const Component& a, const Component& b) {
    return a.volume_mm3 != b.volume_mm3 ? a.volume_mm3 > b.volume_mm3 : a.faces.front() < b.faces.front();
  });
  return by_shell;
}

}  // namespace

std::vector<Component> components(const Linked& linked, const std::function<const SurfaceTree&()>& tree) {
  DisjointSets joined(linked.triangles.faces.size());
  for (std::uint32_t side = 0; side < linked.opposite.size(); ++side) {
    if (linked.opposite[side] == Linked::none)
      throw InvalidInput("components of an open surface have no volume: triangle " +
                         std::to_string(side / 3) +
                         " has a side without a neighbour; close the surface first");
    if (linked.is_inner_edge(side)) joined.join(side / 3, linked.opposite[side] / 3);
  }
  return components_of(linked.triangles, joined, tree);
}

std::vector<Component> components(const Mesh& mesh) {
  DisjointSets joined(mesh.n_faces());
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e))
      throw InvalidInput("the components of an open mesh have no volume: edge " + std::to_string(e.idx()) +
                         " belongs to one triangle only: close the mesh first");
    const auto h = mesh.halfedge_handle(e, 0);
    joined.join(static_cast<std::uint32_t>(mesh.face_handle(h).idx()),
                static_cast<std::uint32_t>(mesh.opposite_face_handle(h).idx()));
  }
  const Triangles triangles = triangles_of(mesh);
  std::optional<SurfaceTree> tree;
  return components_of(triangles, joined, [&]() -> const SurfaceTree& {
    if (!tree) tree.emplace(triangles);
    return *tree;
  });
}

Mesh part_of(const Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  Triangles part;
  std::vector<std::uint32_t> renumbered(mesh.n_vertices(), none);
  for (const std::uint32_t f : faces) {
    if (f >= mesh.n_faces())
      throw std::invalid_argument("face " + std::to_string(f) + " is not one of the mesh's " +
                                  std::to_string(mesh.n_faces()));
    std::array<std::uint32_t, 3> corners{};
    std::size_t k = 0;
    for (auto v = mesh.cfv_begin(Mesh::FaceHandle(static_cast<int>(f))); k < 3; ++v, ++k) {
      std::uint32_t& number = renumbered[static_cast<std::size_t>(v->idx())];
      if (number == none) {
        number = static_cast<std::uint32_t>(part.points_mm.size());
        part.points_mm.push_back(glm_of(mesh.point(*v)));
      }
      corners[k] = number;
    }
    part.faces.push_back(corners);
  }
  return mesh_of(part);
}

}  // namespace octotomy::brep
