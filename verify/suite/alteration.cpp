// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/alteration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <tbb/parallel_for.h>

#include "brep/mesh/components.h"
#include "verify/phantom/chance.h"
#include "verify/suite/subject.h"
#include "voxel/filter/crop.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

enum Kind {
  LostByVoxels,
  LostByMesh,
  LostByBoth,
  AddedToVoxels,
  AddedToMesh,
  AddedToBoth,
  ClippedByVoxels,
  ClippedByMesh,
  ClippedByBoth,
  SeveralTimes,
  PartLost,
  Shifted,
  BothEmpty,
  Unaltered,
  kind_count
};
constexpr std::array<const char*, kind_count> names{"box lost by the voxels",   "box lost by the mesh",
                                                    "box lost by both kernels", "box added to the voxels",
                                                    "box added to the mesh",    "box added to both kernels",
                                                    "clipped by the voxels",    "clipped by the mesh",
                                                    "clipped by both kernels",  "mesh several times",
                                                    "part lost by the mesh",    "mesh shifted",
                                                    "both kernels empty",       unaltered};

int whole_number(Chance& chance, int count) {
  return std::min(static_cast<int>(chance.between(0.0, count)), count - 1);
}

double volume_mm3(const voxel::Octree& octree) {
  return static_cast<double>(octree.voxel_count()) * octree.universe().lattice().voxel_mm3();
}
double volume_mm3(const brep::Triangles& triangles) {
  return triangles.faces.empty() ? 0.0
                                 : brep::trusted_solid(triangles, brep::Proof::Connection).size().volume_mm3;
}

/// The clean answers to one question. Alters them at random.
class Alterations {
 public:
  explicit Alterations(const Subject& subject)
      : subject_(subject),
        voxels_(subject.universe.side()),
        witness_(witness_of(subject, {.low = subject.low})),
        octree_(voxel_answer(subject, {.low = subject.low})),
        triangles_(mesh_answer(subject, {.low = subject.low})) {}

  bool is_empty() const { return octree_.is_empty() || triangles_.faces.empty(); }

  std::vector<Alteration> drawn(int count, Chance& chance) const {
    const Certificate right = certified(subject_, "clean", octree_, triangles_, witness_);
    std::vector<Alteration> made;
    for (int i = 0; i < count; ++i) made.push_back(altered(right, chance));
    return made;
  }

 private:
  glm::dvec3 vertex_by_chance(Chance& chance) const {
    return triangles_.points_mm[static_cast<std::size_t>(
        whole_number(chance, static_cast<int>(triangles_.points_mm.size())))];
  }

  /// Returns a box around a random vertex of the mesh, with sides from one voxel to a sixth of the universe's
  /// side.
  voxel::Box box_by_chance(Chance& chance) const {
    const glm::dvec3 middle_mm = vertex_by_chance(chance);
    glm::dvec3 half_mm;
    for (int axis = 0; axis < 3; ++axis)
      half_mm[axis] = 0.5 * edge_mm(subject_) * std::exp(chance.between(0.0, std::log(voxels_ / 6.0)));
    return {middle_mm - half_mm, middle_mm + half_mm};
  }

  /// Returns the part of the universe beyond a random vertex of the mesh, along a random axis.
  voxel::Box end_by_chance(Chance& chance) const {
    const voxel::Box world = voxel::bounds(subject_.universe.lattice());
    const glm::dvec3 at_mm = vertex_by_chance(chance);
    const int axis = whole_number(chance, 3);
    voxel::Box end{world.low_mm - edge_mm(subject_), world.high_mm + edge_mm(subject_)};
    (chance.even() < 0.0 ? end.low_mm : end.high_mm)[axis] = at_mm[axis] + 0.01 * edge_mm(subject_);
    return end;
  }

  Alteration altered(const Certificate& right, Chance& chance) const {
    const int kind = whole_number(chance, kind_count);
    Alteration made;
    made.kind = names[static_cast<std::size_t>(kind)];
    made.subject = subject_.name + ", " + std::to_string(voxels_) + " voxels a side";
    made.clean_verdict = right.verdict;
    voxel::Octree octree = octree_;
    brep::Triangles triangles = triangles_;
    if (kind <= ClippedByBoth) {
      const voxel::Box box = kind >= ClippedByVoxels ? end_by_chance(chance) : box_by_chance(chance);
      const bool is_added = kind >= AddedToVoxels && kind <= AddedToBoth;
      const auto operation = is_added ? brep::Operation::Union : brep::Operation::Difference;
      if (kind % 3 != LostByMesh) octree = changed(octree, box, operation);
      if (kind % 3 != LostByVoxels) triangles = changed(triangles, box, operation);
      const double of_voxels_mm3 = std::abs(volume_mm3(octree) - volume_mm3(octree_)),
                   of_mesh_mm3 = std::abs(volume_mm3(triangles) - volume_mm3(triangles_));
      made.altered_mm3 = kind % 3 == LostByVoxels ? of_voxels_mm3
                         : kind % 3 == LostByMesh ? of_mesh_mm3
                                                  : std::min(of_voxels_mm3, of_mesh_mm3);
    } else if (kind == SeveralTimes) {
      const int times = 1 + whole_number(chance, 3);
      for (int i = 0; i < times; ++i) triangles = with_shell_again(std::move(triangles), triangles_);
      made.altered_mm3 = volume_mm3(triangles_) * times;
    } else if (kind == PartLost) {
      const std::vector<brep::Component> parts =
          brep::trusted_solid(triangles_, brep::Proof::Connection).components();
      const brep::Component& lost =
          parts[static_cast<std::size_t>(whole_number(chance, static_cast<int>(parts.size())))];
      triangles.faces.clear();
      for (std::uint32_t face = 0; face < triangles_.faces.size(); ++face)
        if (!std::binary_search(lost.faces.begin(), lost.faces.end(), face))
          triangles.faces.push_back(triangles_.faces[face]);
      made.altered_mm3 = std::abs(lost.volume_mm3);
    } else if (kind == Shifted) {
      glm::dvec3 by_mm(0.0);
      const int axis = whole_number(chance, 3);
      by_mm[axis] = edge_mm(subject_) * chance.even() * 2.0;
      triangles = shifted(std::move(triangles), by_mm);
      made.is_over_limit =
          right.limit && right.limit->shift_mm && std::abs(by_mm[axis]) > *right.limit->shift_mm;
    } else if (kind == BothEmpty) {
      octree = voxel::Octree::empty(subject_.universe);
      triangles = {};
      made.altered_mm3 = volume_mm3(triangles_);
    }
    made.is_over_limit = made.is_over_limit || (right.limit && made.altered_mm3 > right.limit->volume_mm3);
    made.verdict = certified(subject_, made.kind, octree, triangles, witness_).verdict;
    return made;
  }

  const Subject& subject_;
  int voxels_;
  Witness witness_;  ///< of the clean question
  voxel::Octree octree_;
  brep::Triangles triangles_;
};

/// Returns a subject from a random block of a scan, at most about half as wide as a universe of `voxels`
/// voxels a side. The box and the motion are random.
Subject block_subject(const ScanToAlter& from, int voxels, Chance& chance) {
  const voxel::Lattice& lattice = from.scan->lattice;
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double sample_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const double voxel_mm = sample_mm * chance.between(1.0, 2.0);
  voxel::VoxelRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const int count =
        std::clamp(static_cast<int>(0.55 * voxels * voxel_mm / spacing_mm[axis]), 2, lattice.dims[axis]);
    range.low[axis] = whole_number(chance, lattice.dims[axis] - count + 1);
    range.high[axis] = range.low[axis] + count - 1;
  }
  Subject subject;
  subject.name = from.name;
  subject.scan = voxel::crop(*from.scan, range);
  subject.low = from.low;
  const voxel::Box bounds = voxel::bounds(subject.scan.lattice);
  const glm::dvec3 extent_mm = bounds.high_mm - bounds.low_mm,
                   middle_mm = 0.5 * (bounds.low_mm + bounds.high_mm);
  // The universe is larger than the block, to leave room for the motion.
  subject.universe =
      voxel::universe_around({bounds.low_mm - 0.2 * extent_mm, bounds.high_mm + 0.2 * extent_mm}, voxel_mm);
  for (int axis = 0; axis < 3; ++axis) {
    subject.box.low_mm[axis] = middle_mm[axis] + extent_mm[axis] * chance.between(-0.4, 0.0);
    subject.box.high_mm[axis] = subject.box.low_mm[axis] + extent_mm[axis] * chance.between(0.1, 0.4);
  }
  subject.motion = {0.1 * extent_mm * glm::dvec3(chance.even(), chance.even(), chance.even()),
                    chance.between(-12.0, 12.0), glm::dvec3(chance.even(), chance.even(), 0.6), middle_mm};
  return subject;
}

/// Draws blocks until one contains an object, and alters the answers for this object. Throws after 50 blocks
/// without an object.
std::vector<Alteration> altered_block(const ScanToAlter& from, int voxels, int count, Chance& chance) {
  constexpr int most_tries = 50;
  for (int tries = 0; tries < most_tries; ++tries) {
    const Subject subject = block_subject(from, voxels, chance);
    const voxel::Range range = voxel::range(subject.scan);
    if (range.high < from.low || range.low >= from.low) continue;
    const Alterations alterations(subject);
    if (!alterations.is_empty()) return alterations.drawn(count, chance);
  }
  throw voxel::InvalidInput(from.name + ": no block of the scan contains an object from " +
                            std::to_string(from.low) + " on: alter another scan");
}

}  // namespace

std::vector<Alteration> try_alterations(const AlterationOptions& options) {
  constexpr std::array<const char*, 3> phantoms{"ellipsoid", "ring", "head"};
  const std::size_t subjects = options.scans.empty()
                                   ? phantoms.size()
                                   : options.scans.size() * static_cast<std::size_t>(options.objects_of_scan);
  const int count = (options.count + static_cast<int>(subjects) - 1) / static_cast<int>(subjects);
  std::vector<std::vector<Alteration>> parts(subjects);
  voxel::SharedProgress done(options.progress, subjects);
  tbb::parallel_for(std::size_t{0}, subjects, [&](std::size_t i) {
    done.one_more();
    Chance chance(options.seed * subjects + i);
    if (!options.scans.empty()) {
      parts[i] = altered_block(options.scans[i % options.scans.size()], options.voxels, count, chance);
      return;
    }
    const std::string name = phantoms[i];
    const Subject subject =
        name == "head" ? head_subject(options.voxels) : shape_subject(name, options.voxels);
    parts[i] = Alterations(subject).drawn(count, chance);
  });
  std::vector<Alteration> all;
  for (std::vector<Alteration>& part : parts)
    all.insert(all.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
  return all;
}

}  // namespace octotomy::verify
