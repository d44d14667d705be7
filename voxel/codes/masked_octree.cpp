// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/masked_octree.h"

#include <array>
#include <cassert>

#include "voxel/space/text_cursor.h"
#include "voxel/tree/level_tally.h"
#include "voxel/tree/logical_build.h"

// The masks are computed in one walk that passes with each node its six face neighbours of the same size. A
// homogeneous node also represents its missing children, so a neighbour of the same size always exists.

namespace octotomy::voxel {
namespace {

using Neighbours = std::array<LogicalNode, direction_count>;

int axis_of(int direction) {
  return direction / 2;
}
bool is_forward(int direction) {
  return direction % 2 == 0;
}

/// Whether all voxels in the node's layer at the given face are in the object.
bool is_layer_full(const LogicalNode& node, int axis, bool at_high_face) {
  if (node.status() != Status::Partial) return node.status() == Status::Full;
  for (int k = 0; k < 8; ++k)
    if ((((k >> axis) & 1) != 0) == at_high_face && !is_layer_full(node.child(k), axis, at_high_face))
      return false;
  return true;
}

class MaskWalk {
 public:
  explicit MaskWalk(std::vector<MaskedNode>& nodes) : nodes_(nodes) {}

  void walk(const LogicalNode& node, const Neighbours& beside) {
    const std::size_t number = nodes_.size();
    nodes_.push_back({node.status(), covered(beside), 1});
    if (node.status() != Status::Partial) return;
    for (int k = 0; k < 8; ++k) {
      Neighbours around;
      for (int direction = 0; direction < direction_count; ++direction) {
        const int across = k ^ (1 << axis_of(direction));
        const bool is_sibling = (((k >> axis_of(direction)) & 1) == 0) == is_forward(direction);
        const auto i = static_cast<std::size_t>(direction);
        around[i] = is_sibling ? node.child(across) : beside[i].child(across);
      }
      walk(node.child(k), around);
    }
    nodes_[number].size = static_cast<std::uint32_t>(nodes_.size() - number);
  }

 private:
  static FaceSet covered(const Neighbours& beside) {
    FaceSet faces = 0;
    for (int direction = 0; direction < direction_count; ++direction)
      if (is_layer_full(beside[static_cast<std::size_t>(direction)], axis_of(direction),
                        !is_forward(direction)))
        faces = static_cast<FaceSet>(faces | face_bit(static_cast<Direction>(direction)));
    return faces;
  }

  std::vector<MaskedNode>& nodes_;
};

class MaskedSource {
 public:
  explicit MaskedSource(const std::vector<MaskedNode>& nodes) : node_(nodes.begin()) {}
  Status open(int /*level*/) { return (node_++)->status; }
  void close(bool /*homogeneous*/) {}

 private:
  std::vector<MaskedNode>::const_iterator node_;
};

constexpr std::string_view hex_digits = "0123456789abcdef";

char letter_of(Status status) {
  return status == Status::Partial ? 'P' : status == Status::Full ? 'F' : 'E';
}

/// Appends a subtree's text. Returns the number of the first node after the subtree.
std::size_t append_text(const std::vector<MaskedNode>& nodes, std::size_t number, std::string& text) {
  const MaskedNode& node = nodes[number];
  text += letter_of(node.status);
  text += hex_digits[node.covered >> 4];
  text += hex_digits[node.covered & 15];
  std::size_t next = number + 1;
  if (node.status != Status::Partial) return next;
  text += '(';
  for (int k = 0; k < 8; ++k) next = append_text(nodes, next, text);
  text += ')';
  return next;
}

/// Reads nodes from a text and records each node's position in the text.
class MaskedReader {
 public:
  MaskedReader(int depth, std::string_view text) : depth_(depth), cursor_("masked octree", text) {}

  void read(std::vector<MaskedNode>& nodes, std::vector<std::size_t>& positions) {
    cursor_.skip_spaces();
    node(0, nodes, positions);
    cursor_.expect_end();
  }
  [[noreturn]] void refuse_at(std::size_t position, const std::string& why) const {
    cursor_.refuse_at(position, why);
  }

 private:
  void node(int level, std::vector<MaskedNode>& nodes, std::vector<std::size_t>& positions) {
    const std::size_t number = nodes.size(), position = cursor_.position();
    MaskedNode read;
    if (cursor_.accept("P"))
      read.status = Status::Partial;
    else if (cursor_.accept("F"))
      read.status = Status::Full;
    else if (!cursor_.accept("E"))
      cursor_.refuse_unexpected("a node, E, F or P");
    const int high = digit(), low = digit();
    read.covered = static_cast<FaceSet>(16 * high + low);
    nodes.push_back(read);
    positions.push_back(position);
    if (read.status != Status::Partial) return;
    if (level == depth_) cursor_.refuse_at(position, "a voxel has no children");
    cursor_.expect("(");
    for (int k = 0; k < 8; ++k) node(level + 1, nodes, positions);
    cursor_.expect(")");
    nodes[number].size = static_cast<std::uint32_t>(nodes.size() - number);
  }

  int digit() {
    const std::size_t at = hex_digits.find(cursor_.peek());
    if (cursor_.at_end() || at == std::string_view::npos)
      cursor_.refuse_unexpected("a hexadecimal digit of its covered faces, 0 to f");
    cursor_.advance();
    return static_cast<int>(at);
  }

  int depth_;
  TextCursor cursor_;
};

class Painter {
 public:
  Painter(const MaskedOctree& masked, FaceSet seen, bool is_masked)
      : masked_(masked), seen_(seen), is_masked_(is_masked), tally_(masked.universe.depth) {}

  void visit(std::size_t number, int side_log2) {
    const MaskedNode& node = masked_.nodes[number];
    tally_.count(side_log2, node.status == Status::Full, node.status == Status::Empty);
    const auto shown = static_cast<FaceSet>(is_masked_ ? seen_ & ~node.covered : seen_);
    if (node.status == Status::Empty || shown == 0) return;
    if (node.status == Status::Full) {
      drawn_faces_ += static_cast<std::uint64_t>(std::popcount(shown));
      return;
    }
    std::size_t child = number + 1;
    for (int k = 0; k < 8; ++k, child += masked_.nodes[child].size) visit(child, side_log2 - 1);
  }
  MaskedDrawing drawing() const { return {tally_.levels(), drawn_faces_}; }

 private:
  const MaskedOctree& masked_;
  FaceSet seen_;
  bool is_masked_;
  LevelTally tally_;
  std::uint64_t drawn_faces_ = 0;
};

/// The steps to the 18 neighbours in the order of neighbour_code().
constexpr std::array<std::array<int, 3>, 18> steps{{{-1, 0, 0},
                                                    {1, 0, 0},
                                                    {0, -1, 0},
                                                    {0, 1, 0},
                                                    {0, 0, -1},
                                                    {0, 0, 1},
                                                    {-1, 0, 1},
                                                    {1, 0, 1},
                                                    {0, -1, 1},
                                                    {0, 1, 1},
                                                    {-1, 0, -1},
                                                    {1, 0, -1},
                                                    {0, -1, -1},
                                                    {0, 1, -1},
                                                    {-1, -1, 0},
                                                    {1, -1, 0},
                                                    {-1, 1, 0},
                                                    {1, 1, 0}}};

constexpr std::uint32_t neighbour_bit(std::size_t i) {
  return std::uint32_t{1} << (steps.size() - 1 - i);
}

}  // namespace

MaskedOctree masked_octree(const Octree& octree) {
  MaskedOctree masked{octree.universe(), {}};
  Neighbours outside;
  const Octree nothing = Octree::empty(octree.universe());
  outside.fill(LogicalNode::root(nothing));
  MaskWalk(masked.nodes).walk(LogicalNode::root(octree), outside);
  return masked;
}

Octree octree_of(const MaskedOctree& masked) {
  MaskedSource source(masked.nodes);
  return LogicalBuild(masked.universe, source).octree();
}

std::string text(const MaskedOctree& masked) {
  std::string text;
  append_text(masked.nodes, 0, text);
  return text;
}

MaskedOctree parse_masked_octree(const Universe& universe, std::string_view text) {
  MaskedOctree masked{universe, {}};
  std::vector<std::size_t> positions;
  MaskedReader reader(universe.depth, text);
  reader.read(masked.nodes, positions);
  const MaskedOctree right = masked_octree(octree_of(masked));
  for (std::size_t i = 0; i < masked.nodes.size(); ++i) {
    if (i >= right.nodes.size() || masked.nodes[i].status != right.nodes[i].status)
      reader.refuse_at(positions[i], "eight equal children must be stored as one node");
    if (masked.nodes[i].covered != right.nodes[i].covered)
      reader.refuse_at(positions[i], std::string("the covered faces of this node are ") +
                                         hex_digits[right.nodes[i].covered >> 4] +
                                         hex_digits[right.nodes[i].covered & 15] +
                                         " according to the neighbouring nodes");
  }
  return masked;
}

FaceSet view_code(int octant) {
  assert(octant >= 0 && octant < 8);
  FaceSet faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_high = ((octant >> axis) & 1) != 0;
    faces = static_cast<FaceSet>(faces | face_bit(static_cast<Direction>(2 * axis + (is_high ? 0 : 1))));
  }
  return faces;
}

std::string face_text(FaceSet faces) {
  std::string result;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {1, 0}) {
      const bool is_in = (faces & face_bit(static_cast<Direction>(2 * axis + side))) != 0;
      result.append(result.empty() ? "" : " ").append(is_in ? "F" : "E");
    }
  return result;
}

MaskedDrawing draw_back_to_front(const MaskedOctree& masked, FaceSet seen, bool is_masked) {
  Painter painter(masked, seen, is_masked);
  painter.visit(0, masked.universe.depth);
  return painter.drawing();
}

std::uint32_t neighbour_code(const Octree& octree, const glm::ivec3& voxel) {
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (octree.contains(voxel + glm::ivec3(steps[i][0], steps[i][1], steps[i][2]))) code |= neighbour_bit(i);
  return code;
}

std::uint32_t neighbour_mask(Direction face) {
  const int number = static_cast<int>(face);
  const auto axis = static_cast<std::size_t>(axis_of(number));
  const int outward = is_forward(number) ? 1 : -1;
  // The four face neighbours around the voxel in the face's plane, and the four edge neighbours one layer in
  // front of these.
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int length = std::abs(steps[i][0]) + std::abs(steps[i][1]) + std::abs(steps[i][2]);
    if (steps[i][axis] == (length == 1 ? 0 : outward)) mask |= neighbour_bit(i);
  }
  return mask;
}

}  // namespace octotomy::voxel
