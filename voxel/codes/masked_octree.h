// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/codes/cuberille_faces.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A set of a node's six faces: bit i is the face in Direction i.
using FaceSet = std::uint8_t;
/// The face's own bit.
constexpr FaceSet face_bit(Direction direction) {
  return static_cast<FaceSet>(1 << static_cast<int>(direction));
}

/// A node of the masked binary octree. A face is covered if the layer of voxels in front of it, outside the
/// node, lies wholly in the object. Voxels beyond the universe are not in the object.
struct MaskedNode {
  Status status = Status::Empty;
  FaceSet covered = 0;
  std::uint32_t size = 1;  ///< nodes of the subtree, this one included
};

/// The masked binary octree (thesis 3.3.1): each node stores which of its faces are hidden. A Boolean
/// intersection of two objects has the intersection of their face sets. A union covers at least the union of
/// their face sets. The complement's faces do not follow from the object's, which is why the thesis gave this
/// code up (9.1).
struct MaskedOctree {
  Universe universe;
  std::vector<MaskedNode> nodes;  ///< in preorder, the root first
};

/// Cost: a walk of the nodes, and for each face of a node the Partial nodes in front of the face.
MaskedOctree masked_octree(const Octree& octree);
/// The octree that a masked octree was made from. Precondition: made by masked_octree().
Octree octree_of(const MaskedOctree& masked);

/// The nodes as one word: a status, E, F or P, its covered faces as two hexadecimal digits, and the eight children of
/// a P in parentheses: `P00(E02F1f...)`.
std::string text(const MaskedOctree& masked);
/// The inverse of text(). Throws std::invalid_argument with the position of the character that is wrong, or
/// of the node whose faces differ from the faces that the other nodes cover. Cost: that of masked_octree().
MaskedOctree parse_masked_octree(const Universe& universe, std::string_view text);

/// The faces that an observer beyond an octant sees (table 4.1). Precondition: the octant is in 0..7.
FaceSet view_code(int octant);
/// The faces in the order of equation 3.2, x- x+ y- y+ z- z+: `E F F E E F`, F for a face of the set.
std::string face_text(FaceSet faces);

/// The costs of drawing back to front (4.4.3.1).
struct MaskedDrawing {
  std::vector<LevelCount> visits;  ///< to levels 1..n by status
  std::uint64_t drawn_faces = 0;   ///< of Full nodes
};
/// Draws back to front: a node whose seen faces are all covered is visited but neither drawn nor opened.
/// `seen` is the view code, or any set of faces; with `is_masked` false the stored faces are ignored.
MaskedDrawing draw_back_to_front(const MaskedOctree& masked, FaceSet seen, bool is_masked = true);

/// The voxels around one voxel that share a face or an edge with it, as a code of 18 bits in the order of
/// 5.2: W E S N D U UW UE US UN DW DE DS DN SW SE NW NE, the first the highest; east is x+, north y+, up z+.
/// Voxels outside the universe count as Empty.
std::uint32_t neighbour_code(const Octree& octree, const glm::ivec3& voxel);
/// The bits of neighbour_code() for the eight voxels on which a face's normal depends (table 5.2).
std::uint32_t neighbour_mask(Direction face);

}  // namespace octotomy::voxel
