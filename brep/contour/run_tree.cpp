// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/run_tree.h"

namespace octotomy::brep {
namespace {

std::vector<PlaneBox> boxes_of_pieces(const Contour& contour) {
  const auto& points = contour.points_mm;
  std::vector<PlaneBox> boxes(contour.closed || points.empty() ? points.size() : points.size() - 1);
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    boxes[k].add(points[k]);
    boxes[k].add(points[(k + 1) % points.size()]);
  }
  return boxes;
}

}  // namespace

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
