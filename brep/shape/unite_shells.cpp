// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 split the surface into shells; 2 make a solid of each, with cavities reversed; 3 find the body of each
// cavity; 4 subtract the cavities from their bodies; 5 unite the bodies whose boxes meet, group by group.
#include "brep/shape/unite_shells.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <map>
#include <utility>

#include "brep/boolean/boolean.h"
#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/shells.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {
namespace {

/// The triangles of one shell, with their own points only.
std::vector<Triangles> shells_apart(const Linked& whole) {
  std::vector<Triangles> apart;
  std::vector<std::uint32_t> number(whole.triangles.points_mm.size());
  std::vector<std::size_t> seen_in(number.size(), 0);
  for (const std::vector<std::uint32_t>& own : shells(whole)) {
    Triangles& shell = apart.emplace_back();
    for (const std::uint32_t f : own) {
      auto& face = shell.faces.emplace_back(whole.triangles.faces[f]);
      for (std::uint32_t& v : face) {
        if (seen_in[v] != apart.size()) {
          seen_in[v] = apart.size();
          number[v] = static_cast<std::uint32_t>(shell.points_mm.size());
          shell.points_mm.push_back(whole.triangles.points_mm[v]);
        }
        v = number[v];
      }
    }
  }
  return apart;
}

/// A shell as the solid that it bounds, for either orientation.
struct Body {
  Solid solid;
  bool is_cavity = false;
};

std::optional<Body> body_of(Triangles shell) {
  Body body;
  Health found = health(shell);
  if (found.first_defect == Defect::InsideOut) {
    body.is_cavity = true;
    for (auto& face : shell.faces) std::swap(face[1], face[2]);
    found = health(shell);
  }
  if (!found.solid()) return std::nullopt;
  body.solid = trusted_solid(std::move(shell), Proof::Health);
  return body;
}

bool boxes_meet(const Solid& a, const Solid& b) {
  const Size &one = a.size(), &other = b.size();
  return glm::all(glm::lessThanEqual(one.low_mm, other.high_mm)) &&
         glm::all(glm::lessThanEqual(other.low_mm, one.high_mm));
}

/// The number of the cavity's points inside the body.
std::size_t points_within(const Solid& cavity, const Solid& body) {
  if (!boxes_meet(cavity, body)) return 0;
  const std::vector<std::uint8_t> inside = body.tree().inside(cavity.triangles().points_mm);
  return static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
}

/// The number of the body that contains a cavity: the one with most of its points, and among these the
/// smallest.
std::optional<std::size_t> body_around(const Solid& cavity, const std::vector<Solid>& bodies) {
  std::optional<std::size_t> around;
  std::size_t most = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::size_t count = points_within(cavity, bodies[i]);
    if (count == 0 || count < most) continue;
    if (count == most && around && volume_mm3(bodies[i]) >= volume_mm3(bodies[*around])) continue;
    most = count;
    around = i;
  }
  return around;
}

class Uniter {
 public:
  explicit Uniter(const std::stop_token& stop) : stop_(stop) {}

  Solid combined(const std::vector<Solid>& operands, Operation operation) {
    if (operands.size() == 1) return operands.front();
    BooleanResult result = boolean(operands, operation, stop_);
    findings_.insert(findings_.end(), result.findings.begin(), result.findings.end());
    return std::move(result.solid);
  }

  Triangles united(const std::vector<Solid>& bodies) {
    DisjointSets groups(bodies.size());
    for (std::uint32_t i = 0; i < bodies.size(); ++i)
      for (std::uint32_t j = i + 1; j < bodies.size(); ++j)
        if (boxes_meet(bodies[i], bodies[j])) groups.join(i, j);
    std::map<std::uint32_t, std::vector<Solid>> members;
    for (std::uint32_t i = 0; i < bodies.size(); ++i) members[groups.set_of(i)].push_back(bodies[i]);
    Triangles all;
    for (const auto& [first, group] : members) append(combined(group, Operation::Union).triangles(), all);
    return all;
  }

  std::vector<std::string> findings() { return std::move(findings_); }

 private:
  std::stop_token stop_;
  std::vector<std::string> findings_;
};

}  // namespace

std::optional<UnitedShells> united_shells(const Triangles& surface, const std::stop_token& stop) {
  const Linked whole = linked(surface);
  if (surface.faces.empty() || !whole.is_closed()) return std::nullopt;
  std::vector<Solid> bodies, cavities;
  for (Triangles& shell : shells_apart(whole)) {
    if (stop.stop_requested()) throw Stopped("uniting shells: stopped");
    std::optional<Body> body = body_of(std::move(shell));
    if (!body) return std::nullopt;
    (body->is_cavity ? cavities : bodies).push_back(std::move(body->solid));
  }
  std::vector<std::vector<Solid>> less(bodies.size());
  for (const Solid& cavity : cavities) {
    const std::optional<std::size_t> around = body_around(cavity, bodies);
    if (!around) return std::nullopt;
    less[*around].push_back(cavity);
  }
  UnitedShells united;
  united.bodies = bodies.size();
  try {
    Uniter uniter(stop);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      less[i].insert(less[i].begin(), bodies[i]);
      bodies[i] = uniter.combined(less[i], Operation::Difference);
    }
    std::erase_if(bodies, [](const Solid& body) { return body.empty(); });
    united.surface = uniter.united(bodies);
    united.findings = uniter.findings();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Geometry) throw;
    return std::nullopt;
  }
  return united;
}

}  // namespace octotomy::brep
