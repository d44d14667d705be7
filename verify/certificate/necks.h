// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/witness.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// A neck with fewer voxels across is thin: noise and the position of the voxels decide whether it is
/// present. A neck is also thin if it is thinner than the spacing of the scan's samples, or if on no path
/// through it both kernels must be inside, because the kernels interpolate differently between samples.
inline constexpr int bridge_voxels = 3;
inline constexpr const char* thin_neck =
    "3 voxels, a sample or the difference of the kernels' interpolations";
static_assert(bridge_voxels == 3);

/// Finds the thin necks of two answers that chose connected parts of one object. A neck connects a part that
/// only one answer has to the voxels that both answers have. Safe to call from several threads.
class Necks {
 public:
  /// `digitised` is the mesh kernel's answer: the voxels whose centre lies inside the mesh. `whole` is a
  /// witness of the whole object from which the parts were chosen.
  Necks(voxel::Octree octree, voxel::Octree digitised, Witness whole);
  /// As above, but the mesh is digitised at the first use. A neck near one that the plan keeps or cuts is not
  /// reported.
  Necks(ChosenParts chosen, Witness whole);

  /// Returns the place of the thin neck that connects a part to the voxels of both answers. `part_mm`, in LPS
  /// millimetres, are the points of the part, which only one answer has. None in four cases: the answers
  /// agree at and around one of the points; the neck is not thin, and both kernels must be inside along it;
  /// nothing connects the part to the voxels of both answers, neither the answer's own voxels nor, for a thin
  /// neck, a path inside the witness's reading or a component of the solid; the plan decides about the neck.
  /// Cost: at the first call a labelling and an erosion of the set.
  std::optional<glm::dvec3> neck_mm(const std::vector<glm::dvec3>& part_mm) const;
  /// Whether the plan keeps a part: it names a neck to keep near `found_mm`, or near the neck that connects
  /// the part. Cost: as neck_mm().
  bool keeps(const std::vector<glm::dvec3>& part_mm, const glm::dvec3& found_mm) const;

 private:
  /// One answer's set. `whole`: the parts of the set that meet the voxels of both answers. `eroded`: such parts of
  /// the set after an erosion by a voxel or half a sample.
  struct Side {
    const voxel::Octree* set = nullptr;
    std::optional<voxel::Octree> whole, eroded;
  };
  void prepare() const;
  /// As neck_mm(), but ignores the plan's decisions.
  std::optional<glm::dvec3> any_neck_mm(const std::vector<glm::dvec3>& part_mm) const;
  /// The answer that alone has the voxel or, otherwise, one of its neighbours; null if the answers agree at
  /// all of them.
  Side* side_near(const glm::ivec3& at) const;
  bool is_thick(Side& side, const std::vector<glm::ivec3>& part) const;
  /// Whether a step across a face leads from the part to a voxel of both answers, and both kernels must be
  /// inside all along the step. Both kernels must then have connected the part, however they interpolate.
  bool is_surely_connected(const std::vector<glm::ivec3>& part) const;
  std::optional<glm::dvec3> neck_by_voxels(Side& side, const std::vector<glm::ivec3>& part) const;
  std::optional<glm::dvec3> neck_by_reading(const glm::ivec3& from) const;
  /// Returns none without a solid, and where the part and the voxels of both answers lie in separate
  /// components of the solid.
  std::optional<glm::dvec3> neck_by_mesh(const std::vector<glm::ivec3>& part) const;
  bool is_near_any(const std::vector<glm::dvec3>& places_mm, const glm::dvec3& neck_mm) const;

  voxel::Octree octree_;
  std::optional<brep::Solid> solid_;
  Witness whole_;
  std::vector<glm::dvec3> decided_mm_, kept_mm_;
  glm::dvec3 sample_mm_{0.0};
  mutable std::mutex mutex_;
  mutable std::optional<voxel::Octree> digitised_, common_;
  mutable Side by_voxels_, by_mesh_;
};

/// Whether voxel a precedes voxel b in the order by z, then y, then x.
bool before(const glm::ivec3& a, const glm::ivec3& b);

/// Groups of voxels that touch by faces, edges or corners; each group lists indices of voxels. Precondition:
/// the voxels are in the order of before(), each once. Cost: order n log n.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<glm::ivec3>& voxels);

/// A part that one answer alone has, connected to the rest by a thin neck.
struct OpenPart {
  WorstPlace bridge;                ///< the neck, with the part's volume
  std::vector<glm::dvec3> part_mm;  ///< the part's voxels, LPS
};

/// Finds the thin necks that connect parts of one answer alone, in an object and in the objects that it was
/// computed from. Keeps a reference to the octree.
class Bridges {
 public:
  Bridges(const voxel::Octree& octree, const voxel::Octree& digitised, const Witness& witness);

  /// Removes the parts that a thin neck connects (Necks::neck_mm()) from `voxels`, and returns those parts.
  /// Preconditions: only one of the answers has each voxel; the voxels are in the order of before(), each
  /// once.
  std::vector<OpenPart> take_from(std::vector<glm::ivec3>& voxels) const;

 private:
  const voxel::Octree& octree_;
  std::vector<PartChoice> choices_;
};

}  // namespace octotomy::verify
