// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 find the connected parts of both surfaces; 2 join parts whose boxes overlap to groups; 3 put groups into batches;
// 4 corefine each batch; 5 put the results together.
#include "brep/boolean/corefine_batches.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "brep/boolean/patch.h"
#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/parallel_tasks.h"
#include "brep/mesh/shells.h"

namespace octotomy::brep {
namespace {

/// The numbers of some triangles of each operand.
using Faces = std::array<std::vector<std::uint32_t>, 2>;

std::size_t count_of(const Faces& faces) {
  return faces[0].size() + faces[1].size();
}

/// Adds a triangle whose bounding box is that of a part.
void add_box(const Triangles& operand, const std::vector<std::uint32_t>& part, Triangles& boxes) {
  glm::dvec3 low = operand.points_mm[operand.faces[part.front()][0]], high = low;
  for (const std::uint32_t f : part)
    for (const std::uint32_t v : operand.faces[f]) {
      low = glm::min(low, operand.points_mm[v]);
      high = glm::max(high, operand.points_mm[v]);
    }
  const auto first = static_cast<std::uint32_t>(boxes.points_mm.size());
  boxes.points_mm.insert(boxes.points_mm.end(), {low, high});
  boxes.faces.push_back({first, first + 1, first + 1});
}

/// Groups of parts whose boxes overlap, in the order of their first parts; none if there cannot be two groups
/// with parts of both operands, or if boxes overlap so often that finding the groups would cost too much.
std::vector<Faces> groups_of(const std::array<Linked, 2>& operands) {
  std::vector<std::pair<std::size_t, std::vector<std::uint32_t>>> parts;  // operand, and triangles of the
                                                                          // part
  Triangles boxes;
  for (const std::size_t side : {0u, 1u})
    for (std::vector<std::uint32_t>& part : shells(operands[side])) {
      add_box(operands[side].triangles, part, boxes);
      parts.emplace_back(side, std::move(part));
    }
  if (parts.size() < 4) return {};

  DisjointSets sets(parts.size());
  std::mutex joining;
  std::atomic<std::size_t> pairs = 0;
  const std::size_t most_pairs = 64 * parts.size();
  MortonTree(boxes).visit_own_pairs([&](std::uint32_t part, std::uint32_t other) {
    if (++pairs > most_pairs) return;
    const std::scoped_lock lock(joining);
    sets.join(part, other);
  });
  if (pairs > most_pairs) return {};

  std::vector<Faces> groups;
  std::vector<std::size_t> number(parts.size(), 0);
  for (std::uint32_t part = 0; part < parts.size(); ++part) {
    const std::uint32_t first = sets.set_of(part);
    if (first == part) {
      number[part] = groups.size();
      groups.emplace_back();
    }
    const auto& [side, faces] = parts[part];
    std::vector<std::uint32_t>& all = groups[number[first]][side];
    all.insert(all.end(), faces.begin(), faces.end());
  }
  return groups;
}

void append(const Faces& group, Faces& batch) {
  for (const std::size_t side : {0u, 1u})
    batch[side].insert(batch[side].end(), group[side].begin(), group[side].end());
}

/// Combines groups into batches. Each batch has a group with parts of both operands, because CGAL expects two
/// surfaces. Groups with parts of one operand only are added to batches that are not full yet.
std::vector<Faces> batches_of(const std::vector<Faces>& groups, std::size_t batch_size) {
  std::vector<Faces> batches;
  const auto has_both = [](const Faces& group) { return !group[0].empty() && !group[1].empty(); };
  for (const Faces& group : groups) {
    if (!has_both(group)) continue;
    if (batches.empty() || count_of(batches.back()) >= batch_size) batches.emplace_back();
    append(group, batches.back());
  }
  if (batches.size() < 2) return {};
  std::size_t batch = 0;
  for (const Faces& group : groups) {
    if (has_both(group)) continue;
    while (batch + 1 < batches.size() && count_of(batches[batch]) >= batch_size) ++batch;
    append(group, batches[batch]);
  }
  for (Faces& faces : batches)
    for (std::vector<std::uint32_t>& of_operand : faces) std::sort(of_operand.begin(), of_operand.end());
  return batches;
}

/// Joins the batches' results. A result exists only if all batches have it.
Corefined together(std::vector<Corefined> parts) {
  Corefined whole;
  for (Corefined& part : parts) {
    for (std::size_t r = 0; r < whole.films.size(); ++r) whole.films[r] += part.films[r];
    for (const std::size_t side : {0u, 1u})
      whole.uncut[side].insert(whole.uncut[side].end(), part.uncut[side].begin(), part.uncut[side].end());
    whole.has_open_film = whole.has_open_film || part.has_open_film;
    whole.meets_itself = whole.meets_itself || part.meets_itself;
    whole.flat += part.flat;
    if (whole.failure.empty()) whole.failure = part.failure;
  }
  if (!whole.failure.empty()) return whole;
  for (std::size_t r = 0; r < whole.results.size(); ++r) {
    if (!std::all_of(parts.begin(), parts.end(), [&](const Corefined& part) { return part.results[r]; }))
      continue;
    Triangles all;
    for (Corefined& part : parts) {
      append(*part.results[r], all);
      part.results[r].reset();
    }
    whole.results[r] = in_coordinate_order(std::move(all));
  }
  return whole;
}

}  // namespace

Corefined corefine_in_batches(const Mesh& a, const Mesh& b, const Wanted& wanted, const std::stop_token& stop,
                              std::size_t batch_size) {
  assert(batch_size > 0);
  const std::size_t all = a.n_faces() + b.n_faces();
  if (all <= batch_size) return corefine(a, b, wanted, stop);
  constexpr std::size_t most_batches = 64;  // every batch costs a pass over all points
  const std::array<Linked, 2> operands{linked_of(a), linked_of(b)};
  const std::vector<Faces> batches =
      batches_of(groups_of(operands), std::max(batch_size, all / most_batches));
  if (batches.empty()) return corefine(a, b, wanted, stop);

  std::vector<Corefined> parts(batches.size());
  run_parallel_tasks(batches.size(), [&](std::size_t i) {  // corefine() has one count of steps for each
                                                           // thread
    const Patch patches[] = {patch_of(operands[0].triangles, batches[i][0]),
                             patch_of(operands[1].triangles, batches[i][1])};
    parts[i] = corefine(patches[0].mesh, patches[1].mesh, wanted, stop);
    if (parts[i].flat > 0) return;  // then its points are not numbered as in the patch
    for (const std::size_t side : {0u, 1u})
      for (std::uint32_t& v : parts[i].uncut[side]) v = patches[side].points.at(v);
  });
  return together(std::move(parts));
}

}  // namespace octotomy::brep
