// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/run_tree.h"

namespace octotomy::brep {
namespace {

std::vector<PlaneBox> boxes_of_pieces(const Contour& contour) {
  std::vector<PlaneBox> boxes(piece_count(contour));
  for (std::size_t k = 0; k < boxes.size(); ++k) boxes[k] = box_of_piece(contour, k);
  return boxes;
}

}  // namespace

std::size_t piece_count(const Contour& contour) {
  const std::size_t points = contour.points_mm.size();
  return contour.closed || points == 0 ? points : points - 1;
}

PlaneBox box_of_piece(const Contour& contour, std::size_t piece) {
  const auto& points = contour.points_mm;
  PlaneBox box;
  box.add(points[piece]);
  box.add(points[(piece + 1) % points.size()]);
  return box;
}

RunTree::RunTree(const std::vector<PlaneBox>& items) : count_(items.size()) {
  boxes_.reserve(2 * count_);
  if (count_ > 0) append(items, 0, count_);
}

RunTree::RunTree(const Contour& contour) : RunTree(boxes_of_pieces(contour)) {}

void RunTree::append(const std::vector<PlaneBox>& items, std::size_t begin, std::size_t end) {
  const std::size_t node = boxes_.size();
  if (end - begin == 1) {
    boxes_.push_back(items[begin]);
    return;
  }
  boxes_.emplace_back();
  const std::size_t middle = begin + (end - begin) / 2;
  append(items, begin, middle);
  append(items, middle, end);
  PlaneBox box = boxes_[node + 1];
  box.add(boxes_[node + 2 * (middle - begin)]);
  boxes_[node] = box;
}

}  // namespace octotomy::brep
