// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/openvdb_peer.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/Prune.h>

namespace octotomy::bench {

struct OpenVdbPeer::Grids {
  openvdb::MaskGrid::Ptr mask = openvdb::MaskGrid::create();
  openvdb::BoolGrid::Ptr values = openvdb::BoolGrid::create(false);
};

OpenVdbPeer::OpenVdbPeer(int side, const std::vector<std::uint64_t>& words)
    : grids_(std::make_unique<Grids>()) {
  openvdb::initialize();
  auto accessor = grids_->values->getAccessor();
  const int words_per_row = (side + 63) / 64;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const int row = static_cast<int>(i) / words_per_row;
    const int first = 64 * (static_cast<int>(i) % words_per_row);
    for (std::uint64_t rest = words[i]; rest != 0; rest &= rest - 1)
      accessor.setValue({first + __builtin_ctzll(rest), row % side, row / side}, true);
  }
  openvdb::tools::prune(grids_->values->tree());
  grids_->mask->tree().topologyUnion(grids_->values->tree());
}

OpenVdbPeer::~OpenVdbPeer() = default;

std::uint64_t OpenVdbPeer::combine(Operation operation, const OpenVdbPeer& other, bool count) const {
  openvdb::MaskTree result(grids_->mask->tree());
  const openvdb::MaskTree& operand = other.grids_->mask->tree();
  switch (operation) {
    case Operation::Union:
      result.topologyUnion(operand);
      break;
    case Operation::Intersection:
      result.topologyIntersection(operand);
      break;
    case Operation::Difference:
      result.topologyDifference(operand);
      break;
  }
  return count ? result.activeVoxelCount() : result.empty();
}

std::uint64_t OpenVdbPeer::transform(const std::array<double, 16>& target_from_source, bool count) const {
  openvdb::Mat4R row_vectors;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) row_vectors(i, j) = target_from_source[static_cast<std::size_t>(4 * i + j)];
  const openvdb::BoolGrid::Ptr moved = openvdb::BoolGrid::create(false);
  openvdb::tools::GridTransformer(row_vectors)
      .transformGrid<openvdb::tools::PointSampler>(*grids_->values, *moved);
  return count ? moved->activeVoxelCount() : moved->empty();
}

std::uint64_t OpenVdbPeer::bytes() const {
  return grids_->mask->memUsage();
}

}  // namespace octotomy::bench
