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
  std::uint32_t size = 1;  ///< number of nodes in the subtree, this node included
};

/// The masked binary octree (thesis 3.3.1): each node stores the set of its faces that are covered, so that
/// no observer can see them. In the intersection of two objects a node's covered faces are those covered in
/// both. In their union at least the faces covered in either are covered. The complement's covered faces
/// cannot be computed from the object's, so the thesis gave this code up (9.1).
struct MaskedOctree {
  Universe universe;
  std::vector<MaskedNode> nodes;  ///< in preorder, the root first
};

/// The masked octree of an object. Cost: one walk through the nodes; for each face of a node it also reads
/// the Partial nodes in front of the face.
MaskedOctree masked_octree(const Octree& octree);
/// The octree from which a masked octree was made. Precondition: made by masked_octree().
Octree octree_of(const MaskedOctree& masked);

/// The nodes as one word: a status, E, F or P, its covered faces as two hexadecimal digits, and the eight children of
/// a P in parentheses: `P00(E02F1f...)`.
std::string text(const MaskedOctree& masked);
/// The inverse of text(). Throws std::invalid_argument with the position of the character that is wrong, or
/// of the node whose stored faces differ from those that the neighbouring nodes cover. Cost: that of
/// masked_octree().
MaskedOctree parse_masked_octree(const Universe& universe, std::string_view text);

/// The faces that an observer beyond an octant sees (table 4.1). Precondition: the octant is in 0..7.
FaceSet view_code(int octant);
/// A letter for each face in the order of equation 3.2, x- x+ y- y+ z- z+: F if the set contains the face,
/// else E. Example: `E F F E E F`.
std::string face_text(FaceSet faces);

/// The costs of drawing back to front (thesis 4.4.3.1).
struct MaskedDrawing {
  std::vector<LevelCount> visits;  ///< number of visited nodes on levels 1..n, by status
  std::uint64_t drawn_faces = 0;   ///< of Full nodes
};
/// Counts the work of drawing back to front. A node whose faces in `seen` are all covered is visited, but
/// neither it nor its children are drawn. `seen` is the view code, or any set of faces; with `is_masked`
/// false the stored faces are ignored.
MaskedDrawing draw_back_to_front(const MaskedOctree& masked, FaceSet seen, bool is_masked = true);

/// The neighbours of a voxel at its faces and edges, as a code of 18 bits, 1 for a neighbour in the object,
/// in the order of thesis 5.2: W E S N D U UW UE US UN DW DE DS DN SW SE NW NE, the first is the highest bit;
/// east is x+, north y+, up z+. Voxels outside the universe count as Empty.
std::uint32_t neighbour_code(const Octree& octree, const glm::ivec3& voxel);
/// The bits of neighbour_code() for the eight voxels on which a face's normal depends (table 5.2).
std::uint32_t neighbour_mask(Direction face);

}  // namespace octotomy::voxel
