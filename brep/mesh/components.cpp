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
#include <tuple>

#include "brep/mesh/distance.h"
#include "brep/mesh/mesh_point.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

struct Shell {
  std::vector<std::uint32_t> faces;
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  glm::dvec3 probe_mm{0.0};  ///< a vertex, one that no other shell touches where there is any
};

/// Labels faces connected across edges; labels ascend with a shell's first face.
std::vector<std::uint32_t> label_shells(const Mesh& mesh, std::uint32_t& shell_count) {
  std::vector<std::uint32_t> label(mesh.n_faces(), none);
  std::vector<Mesh::FaceHandle> flood;
  shell_count = 0;
  for (const auto seed : mesh.faces()) {
    if (label[static_cast<std::size_t>(seed.idx())] != none) continue;
    label[static_cast<std::size_t>(seed.idx())] = shell_count;
    flood.assign(1, seed);
    while (!flood.empty()) {
      const Mesh::FaceHandle face = flood.back();
      flood.pop_back();
      for (auto it = mesh.cff_begin(face); it != mesh.cff_end(face); ++it) {
        std::uint32_t& beyond = label[static_cast<std::size_t>(it->idx())];
        if (beyond != none) continue;
        beyond = shell_count;
        flood.push_back(*it);
      }
    }
    ++shell_count;
  }
  return label;
}

/// Marks vertices that stand where one of another shell does: whether they are inside of that is a toss.
std::vector<std::uint8_t> mark_touching(const Mesh& mesh, const std::vector<std::uint32_t>& label) {
  std::vector<Mesh::VertexHandle> order;
  for (const auto v : mesh.vertices())
    if (!mesh.is_isolated(v)) order.push_back(v);
  const auto shell_of = [&](Mesh::VertexHandle v) {
    return label[static_cast<std::size_t>(mesh.face_handle(mesh.halfedge_handle(v)).idx())];
  };
  std::sort(order.begin(), order.end(), [&](Mesh::VertexHandle v, Mesh::VertexHandle w) {
    const Mesh::Point &p = mesh.point(v), &q = mesh.point(w);
    return std::tie(p[0], p[1], p[2]) < std::tie(q[0], q[1], q[2]);
  });
  std::vector<std::uint8_t> touching(mesh.n_vertices(), 0);
  for (std::size_t i = 0, j; i < order.size(); i = j) {
    bool several = false;
    for (j = i + 1; j < order.size() && mesh.point(order[j]) == mesh.point(order[i]); ++j)
      several = several || shell_of(order[j]) != shell_of(order[i]);
    for (std::size_t k = i; several && k < j; ++k) touching[static_cast<std::size_t>(order[k].idx())] = 1;
  }
  return touching;
}

/// Shells with their integrals, about the first point of each to keep digits.
std::vector<Shell> measure_shells(const Mesh& mesh, const std::vector<std::uint32_t>& label,
                                  std::uint32_t shell_count) {
  std::vector<Shell> shells(shell_count);
  assert(label.size() == mesh.n_faces());
  for (std::uint32_t f = 0; f < label.size(); ++f) {
    assert(label[f] < shell_count);
    shells[label[f]].faces.push_back(f);
  }
  const std::vector<std::uint8_t> touching =
      shell_count > 1 ? mark_touching(mesh, label) : std::vector<std::uint8_t>(mesh.n_vertices(), 0);
  for (Shell& shell : shells) {
    std::optional<glm::dvec3> origin;
    bool probe_touches = true;
    for (const std::uint32_t f : shell.faces) {
      const Mesh::HalfedgeHandle h = mesh.halfedge_handle(Mesh::FaceHandle(static_cast<int>(f)));
      const glm::dvec3 a = glm_of(mesh.point(mesh.from_vertex_handle(h)));
      const glm::dvec3 b = glm_of(mesh.point(mesh.to_vertex_handle(h)));
      const glm::dvec3 c = glm_of(mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h))));
      if (!origin) {
        origin = a;
        shell.probe_mm = a;
      }
      if (const Mesh::VertexHandle v = mesh.from_vertex_handle(h);
          probe_touches && !touching[static_cast<std::size_t>(v.idx())]) {
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

/// The smallest outward shell around a cavity's.
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

}  // namespace

std::vector<Component> components(const Mesh& mesh) {
  for (const auto e : mesh.edges())
    if (mesh.is_boundary(e))
      throw std::invalid_argument("the components of an open mesh have no volume: edge " +
                                  std::to_string(e.idx()) + " has one triangle; close it first");
  std::uint32_t shell_count = 0;
  const std::vector<std::uint32_t> label = label_shells(mesh, shell_count);
  const std::vector<Shell> shells = measure_shells(mesh, label, shell_count);

  std::vector<std::uint32_t> owner(shell_count);
  std::optional<SurfaceTree> tree;
  for (std::uint32_t s = 0; s < shell_count; ++s) {
    owner[s] = s;
    if (shells[s].volume_mm3 >= 0.0) continue;
    if (!tree) tree.emplace(mesh);
    owner[s] = shell_around(s, shells, label, *tree).value_or(s);
  }

  assert(std::accumulate(shells.begin(), shells.end(), std::size_t{0},
                         [](std::size_t sum, const Shell& shell) { return sum + shell.faces.size(); }) ==
         mesh.n_faces());
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

Mesh largest_component(const Mesh& mesh) {
  const std::vector<Component> pieces = components(mesh);
  return pieces.empty() ? Mesh() : part_of(mesh, pieces.front().faces);
}

}  // namespace octotomy::brep
