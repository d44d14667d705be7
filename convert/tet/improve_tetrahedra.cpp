// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/improve_tetrahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "convert/tet/element_faces.h"
#include "voxel/space/error.h"

namespace octotomy::convert {
namespace {

using Corners = std::array<glm::dvec3, 4>;

/// The cosine of the smallest dihedral angle: 1 for a flat element, 1/3 for the regular one; 2 for an element
/// without volume or turned inside out.
double flatness(const Corners& p) {
  const glm::dvec3 a = p[1] - p[0];
  const glm::dvec3 b = p[2] - p[0];
  const glm::dvec3 c = p[3] - p[0];
  const std::array<glm::dvec3, 4> normals{glm::cross(c - a, b - a), glm::cross(b, c), glm::cross(c, a),
                                          glm::cross(a, b)};
  if (!(glm::dot(normals[3], c) > 0.0)) return 2.0;
  // All four normals point to the same side, inward, so two of them enclose pi less the dihedral angle.
  double largest = -1.0;
  std::array<double, 4> lengths{};
  for (std::size_t i = 0; i < 4; ++i) lengths.at(i) = glm::length(normals.at(i));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      largest = std::max(largest, -glm::dot(normals.at(i), normals.at(j)) / (lengths.at(i) * lengths.at(j)));
  return largest;
}

/// The elements about each node, ascending.
class Stars {
 public:
  explicit Stars(const Tetrahedra& tetrahedra) : first_(tetrahedra.nodes_mm.size() + 1, 0) {
    for (const auto& tet : tetrahedra.tets)
      for (const std::uint32_t v : tet) ++first_[v + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    tets_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t)
      for (const std::uint32_t v : tetrahedra.tets[t]) tets_[next[v]++] = t;
  }
  const std::uint32_t* begin(std::uint32_t v) const { return tets_.data() + first_[v]; }
  const std::uint32_t* end(std::uint32_t v) const { return tets_.data() + first_[v + 1]; }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> tets_;
};

/// The directions from a cube's centre to its corners and to the middles of its faces.
const std::array<glm::dvec3, 14>& directions() {
  static const std::array<glm::dvec3, 14> all = [] {
    std::array<glm::dvec3, 14> made;
    std::size_t n = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        made.at(n) = glm::dvec3(0.0);
        made.at(n++)[axis] = sign;
      }
    for (int k = 0; k < 8; ++k)
      made.at(n++) =
          glm::normalize(glm::dvec3((k & 1) * 2.0 - 1.0, ((k >> 1) & 1) * 2.0 - 1.0, (k >> 2) * 2.0 - 1.0));
    return made;
  }();
  return all;
}

/// Directions in which a node of the surface may move without moving its flat face or straight edge.
struct Freedom {
  enum class Kind { Free, Plane, Line, None } kind = Kind::Free;
  glm::dvec3 axis{0.0};  ///< the plane's unit normal, or the line's unit direction

  glm::dvec3 allowed(const glm::dvec3& step) const {
    switch (kind) {
      case Kind::Free:
        return step;
      case Kind::Plane:
        return step - glm::dot(step, axis) * axis;
      case Kind::Line:
        return glm::dot(step, axis) * axis;
      case Kind::None:
        break;
    }
    return glm::dvec3(0.0);
  }
};

/// Normals with at least this cosine belong to one flat face: one degree, the effect of bumps of about 0.03
/// mm on elements of 3 mm.
constexpr double flat_cosine() {
  return 0.99985;
}

/// The different normals of the faces about each node, at most four.
class FaceNormals {
 public:
  explicit FaceNormals(const Tetrahedra& t) : t_(t), of_node_(t.nodes_mm.size()) {}

  /// On a face between regions, both directions of the normal count as one. On an outer surface, opposite
  /// normals at a node show a fold.
  void add(const ElementFace& face, bool looks_outward) {
    constexpr std::size_t most = 4;
    const auto [a, b, c] = corners_of(t_, face);
    const glm::dvec3 across = glm::cross(t_.nodes_mm[b] - t_.nodes_mm[a], t_.nodes_mm[c] - t_.nodes_mm[a]);
    const double length = glm::length(across);
    if (!(length > 0.0)) return;
    const glm::dvec3 normal = across / length;
    for (const std::uint32_t v : {a, b, c}) {
      std::vector<glm::dvec3>& known = of_node_[v];
      const bool is_known = std::any_of(known.begin(), known.end(), [&](const glm::dvec3& n) {
        const double cosine = glm::dot(n, normal);
        return (looks_outward ? cosine : std::abs(cosine)) > flat_cosine();
      });
      if (!is_known && known.size() < most) known.push_back(normal);
    }
  }

  /// About a node on a flat face all have one normal, on a straight edge two, in a corner three. More
  /// normals show a curved surface, where the node is free.
  Freedom freedom(std::size_t v) const {
    const std::vector<glm::dvec3>& n = of_node_[v];
    if (n.size() == 1) return {Freedom::Kind::Plane, n[0]};
    if (n.size() == 2 && std::abs(glm::dot(n[0], n[1])) < flat_cosine())
      return {Freedom::Kind::Line, glm::normalize(glm::cross(n[0], n[1]))};
    if (n.size() == 3 && std::abs(glm::dot(n[0], glm::cross(n[1], n[2]))) > least_corner())
      return {Freedom::Kind::None, {}};
    return {};
  }

 private:
  /// Smallest accepted value of six times the volume that three normals span: half that of a cube's corner.
  static constexpr double least_corner() { return 0.5; }

  const Tetrahedra& t_;
  std::vector<std::vector<glm::dvec3>> of_node_;
};

std::vector<Freedom> freedoms_of(const Tetrahedra& t) {
  FaceNormals normals(t);
  for (const ElementFace& face : surface_faces(t)) normals.add(face, true);
  for (const Interface& between : interfaces(t))
    for (const ElementFace& face : between.faces) normals.add(face, false);
  std::vector<Freedom> freedoms(t.nodes_mm.size());
  for (std::size_t v = 0; v < freedoms.size(); ++v) freedoms[v] = normals.freedom(v);
  return freedoms;
}

class Improving {
 public:
  Improving(Tetrahedra& tetrahedra, const ImproveOptions& options)
      : t_(tetrahedra),
        options_(options),
        goal_(std::cos(glm::radians(options.min_dihedral_deg))),
        stars_(tetrahedra),
        given_mm_(tetrahedra.nodes_mm),
        play_mm_(tetrahedra.nodes_mm.size(), std::numeric_limits<double>::infinity()) {
    for (std::size_t i = 0; i < tetrahedra.boundary_nodes.size(); ++i)
      play_mm_[tetrahedra.boundary_nodes[i]] =
          options.surface_play_mm.empty() ? 0.0 : options.surface_play_mm[i];
    if (std::any_of(options.surface_play_mm.begin(), options.surface_play_mm.end(),
                    [](double play_mm) { return play_mm > 0.0; }) &&
        options.keeps_flat)
      freedoms_ = freedoms_of(tetrahedra);
  }

  /// Returns the rounds left if it ended early, otherwise 0.
  int run() {
    double last = 0.0;
    for (int round = 0; round < options_.rounds; ++round) {
      options_.progress.at(static_cast<double>(round) / options_.rounds);
      const std::vector<std::uint32_t> flat = flat_elements();
      const auto count = static_cast<double>(flat.size());
      const int left = options_.rounds - round;
      if (options_.all_or_nothing && round > 0 && count * std::pow(std::min(0.5, count / last), left) >= 1.0)
        return left;
      last = count;
      if (!mend(flat)) return 0;
    }
    return 0;
  }

 private:
  Corners corners_of(std::uint32_t tet) const {
    Corners p;
    for (std::size_t i = 0; i < 4; ++i) p.at(i) = t_.nodes_mm[t_.tets[tet].at(i)];
    return p;
  }

  /// The elements below the goal, the flattest first.
  std::vector<std::uint32_t> flat_elements() const {
    std::vector<std::pair<double, std::uint32_t>> flat;
    for (std::uint32_t t = 0; t < t_.tets.size(); ++t)
      if (const double f = flatness(corners_of(t)); f > goal_) flat.emplace_back(-f, t);
    std::sort(flat.begin(), flat.end());
    std::vector<std::uint32_t> elements;
    elements.reserve(flat.size());
    for (const auto& [unused, tet] : flat) elements.push_back(tet);
    return elements;
  }

  /// Returns whether any node moved.
  bool mend(const std::vector<std::uint32_t>& flat) {
    bool moved = false;
    for (const std::uint32_t tet : flat)
      for (const std::uint32_t v : t_.tets[tet]) {
        if (flatness(corners_of(tet)) <= goal_) break;
        moved = move(v) || moved;
      }
    return moved;
  }

  /// The largest flatness about a node if the node were at `p_mm`, or the first value of at least `enough`.
  /// Begins with the element `worst`, because the element that is flattest at one position is mostly the
  /// flattest nearby. Sets `worst` to the flattest element.
  double flattest(std::uint32_t v, const glm::dvec3& p_mm, double enough, std::uint32_t& worst) const {
    const auto flatness_of = [&](std::uint32_t tet) {
      Corners p = corners_of(tet);
      for (std::size_t i = 0; i < 4; ++i)
        if (t_.tets[tet].at(i) == v) p.at(i) = p_mm;
      return flatness(p);
    };
    double largest = flatness_of(worst);
    for (const std::uint32_t* t = stars_.begin(v); t != stars_.end(v) && largest < enough; ++t)
      if (const double f = flatness_of(*t); f > largest) {
        largest = f;
        worst = *t;
      }
    return largest;
  }

  double shortest_edge(std::uint32_t v) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t* t = stars_.begin(v); t != stars_.end(v); ++t)
      for (const std::uint32_t other : t_.tets[*t])
        if (other != v) shortest = std::min(shortest, glm::distance(t_.nodes_mm[other], t_.nodes_mm[v]));
    return shortest;
  }

  /// Moves a node to a position where its flattest element is less flat. Returns false if none is found.
  bool move(std::uint32_t v) {
    if (play_mm_[v] <= 0.0) return false;
    glm::dvec3 best_mm = t_.nodes_mm[v];
    std::uint32_t worst = *stars_.begin(v);
    double best = flattest(v, best_mm, std::numeric_limits<double>::infinity(), worst);
    const double before = best;
    const double length = shortest_edge(v);
    double step = std::min(0.5 * length, play_mm_[v]);
    for (int halvings = 0; halvings < 7 && best > goal_;) {
      glm::dvec3 found_mm = best_mm;
      for (const glm::dvec3& direction : directions()) {
        const glm::dvec3 p_mm =
            best_mm + (freedoms_.empty() ? step * direction : freedoms_[v].allowed(step * direction));
        if (glm::distance(p_mm, given_mm_[v]) > play_mm_[v]) continue;
        if (const double f = flattest(v, p_mm, best, worst); f < best) {
          best = f;
          found_mm = p_mm;
        }
      }
      if (found_mm == best_mm) {
        step *= 0.5;
        ++halvings;
      }
      best_mm = found_mm;
    }
    t_.nodes_mm[v] = best_mm;
    return best < before;
  }

  Tetrahedra& t_;
  const ImproveOptions& options_;
  double goal_;
  Stars stars_;
  std::vector<glm::dvec3> given_mm_;
  std::vector<double> play_mm_;    ///< how far a node may move from its given place; infinite for inner nodes
  std::vector<Freedom> freedoms_;  ///< freedom of each node; empty if the surface stays
};

}  // namespace

int improve(Tetrahedra& tetrahedra, const ImproveOptions& options) {
  if (!(options.min_dihedral_deg >= 0.0 && options.min_dihedral_deg <= 60.0))
    throw voxel::InvalidInput("improve: the dihedral angle to reach must be 0 to 60 degrees");
  if (!options.surface_play_mm.empty() && options.surface_play_mm.size() != tetrahedra.boundary_nodes.size())
    throw std::invalid_argument(
        "improve: the list of distances by which surface nodes may move must be empty or have one value for "
        "each surface node");
  if (std::any_of(options.surface_play_mm.begin(), options.surface_play_mm.end(),
                  [](double play_mm) { return !(play_mm >= 0.0); }) ||
      options.rounds < 1)
    throw std::invalid_argument(
        "improve: distances by which surface nodes may move must not be negative, and rounds must be at "
        "least 1");
  if (options.all_or_nothing && !options.surface_play_mm.empty())
    throw std::invalid_argument(
        "improve: a call in which surface nodes may move cannot continue earlier rounds");
  return Improving(tetrahedra, options).run();
}

}  // namespace octotomy::convert
