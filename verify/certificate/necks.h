// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// A neck of fewer voxels across may be there or not: on the scan it is a matter of noise and of the voxels'
/// place. So may one that is thinner than the scan's samples are apart: between them the kernels interpolate
/// in ways of their own.
inline constexpr int bridge_voxels = 3;
inline constexpr const char* thin_neck = "3 voxels or a sample";
static_assert(bridge_voxels == 3);

/// What two answers that chose connected parts of one object leave open: how parts that one of them alone has
/// hold to what both have. Safe to call from several threads.
class Necks {
 public:
  /// Both answers, the mesh's as the voxels whose centre lies inside of it, and a reading of the object of
  /// which they chose parts.
  Necks(voxel::Octree octree, voxel::Octree digitised, Witness whole);
  /// The same; the mesh is digitised when it is needed first. `decided_mm` are the places of necks that the
  /// plan keeps or cuts, LPS: none of them is open. `sample_mm` is the spacing of the scan's samples.
  Necks(voxel::Octree octree, brep::Solid solid, Witness whole, std::vector<glm::dvec3> decided_mm,
        const glm::dvec3& sample_mm);

  /// Where the part hangs on whose points are given, LPS, all of one answer alone. None: the answers do not
  /// differ about each of these points; a neck that is no thin_neck holds one of them; no path through
  /// what the reading may have inside leads from the first one to what both answers have; or the plan has
  /// decided. Cost: of the first call a labelling and an erosion of the set.
  std::optional<glm::dvec3> neck_mm(const std::vector<glm::dvec3>& part_mm) const;

 private:
  /// One answer's set, and what of it, whole or eroded by a voxel, is connected with what both answers have.
  struct Side {
    const voxel::Octree* set = nullptr;
    std::optional<voxel::Octree> whole, eroded;
  };
  void prepare() const;
  /// Of the answer that alone has a voxel near a point; null where they do not differ.
  Side* side_near(const glm::ivec3& at) const;
  bool is_thick(Side& side, const std::vector<glm::ivec3>& part) const;
  std::optional<glm::dvec3> neck_by_voxels(Side& side, const std::vector<glm::ivec3>& part) const;
  std::optional<glm::dvec3> neck_by_reading(const glm::ivec3& from) const;
  bool is_decided(const glm::dvec3& neck_mm) const;

  voxel::Octree octree_;
  std::optional<brep::Solid> solid_;
  Witness whole_;
  std::vector<glm::dvec3> decided_mm_;
  glm::dvec3 sample_mm_{0.0};
  mutable std::mutex mutex_;
  mutable std::optional<voxel::Octree> digitised_, common_;
  mutable Side by_voxels_, by_mesh_;
};

/// The order of voxels by z, then y, then x.
bool before(const glm::ivec3& a, const glm::ivec3& b);

/// Voxels that touch by faces, edges or corners, as indices. Precondition: the voxels are in the order of
/// before(), each once. Cost: order n log n.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<glm::ivec3>& voxels);

/// A part of one answer alone, beyond a thin neck.
struct OpenPart {
  WorstPlace bridge;                ///< the neck, with the part's volume
  std::vector<glm::dvec3> part_mm;  ///< the part's voxels, LPS
};

/// Finds by which necks parts of one answer alone hang on, in an object or in what it was made of. Keeps a
/// reference to the octree.
class Bridges {
 public:
  Bridges(const voxel::Octree& octree, const voxel::Octree& digitised, const Witness& witness);

  /// Takes the parts that hang on by a thin neck (Necks::neck_mm()) from voxels that one answer alone has,
  /// and returns them. Precondition: the voxels are in the order of before(), each once.
  std::vector<OpenPart> take_from(std::vector<glm::ivec3>& voxels) const;

 private:
  const voxel::Octree& octree_;
  std::vector<PartChoice> choices_;
};

}  // namespace octotomy::verify
