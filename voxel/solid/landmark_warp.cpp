// SPDX-License-Identifier: AGPL-3.0-or-later
//
//   1 The landmarks' weights: the functions' matrix is symmetric and positive definite, so that its Cholesky factor
//     solves all three axes.
//   2 A block of 16 voxels a side that is out of reach keeps its voxels. So does a block that is full or empty together
//     with all blocks from which its voxels can come.
//   3 In all other blocks the expression is read at each voxel's origin.
#include "voxel/solid/landmark_warp.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "voxel/solid/membership.h"
#include "voxel/space/shared_progress.h"
#include "voxel/tree/build.h"

namespace octotomy::voxel {
namespace {

constexpr int block_side = 16;

double share_at(const glm::dvec3& from_mm, double reach_mm) {
  const double off = glm::length(from_mm) / reach_mm;
  return off < 1.0 ? std::pow(1.0 - off, 4) * (1.0 + 4.0 * off) : 0.0;
}

void check(const std::vector<LandmarkShift>& landmarks, double reach_mm) {
  const auto is_finite = [](const glm::dvec3& p) { return std::isfinite(p.x + p.y + p.z); };
  if (landmarks.empty()) throw InvalidInput("the list of landmarks is empty: add at least one");
  if (!(reach_mm > 0.0) || !std::isfinite(reach_mm))
    throw InvalidInput("the landmarks' reach must be above 0 mm, not " + std::to_string(reach_mm) + " mm");
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    if (!is_finite(landmarks[i].p_mm) || !is_finite(landmarks[i].by_mm))
      throw InvalidInput("landmark " + std::to_string(i + 1) + " or its displacement is not finite");
}

/// The field of displacements u, and the search for the origin x of a point x + u(x).
class Shifts {
 public:
  Shifts(const std::vector<LandmarkShift>& landmarks, double reach_mm)
      : landmarks_(landmarks), reach_mm_(reach_mm) {
    const std::size_t count = landmarks.size();
    std::vector<std::vector<double>> root(count, std::vector<double>(count, 0.0));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        double rest = share_at(landmarks[i].p_mm - landmarks[j].p_mm, reach_mm);
        for (std::size_t k = 0; k < j; ++k) rest -= root[i][k] * root[j][k];
        if (i == j && !(rest > 0.0))
          throw InvalidInput("landmark " + std::to_string(i + 1) +
                             " coincides with another one: move or remove it");
        root[i][j] = i == j ? std::sqrt(rest) : rest / root[j][j];
      }
    for (std::size_t i = 0; i < count; ++i) {
      glm::dvec3 rest = landmarks[i].by_mm;
      for (std::size_t k = 0; k < i; ++k) rest -= root[i][k] * weights_mm_[k];
      weights_mm_.push_back(rest / root[i][i]);
    }
    for (std::size_t i = count; i-- > 0;) {
      for (std::size_t k = i + 1; k < count; ++k) weights_mm_[i] -= root[k][i] * weights_mm_[k];
      weights_mm_[i] /= root[i][i];
    }
    // Wendland's function is at most 1, so the sum of the weights' lengths bounds the displacement.
    for (const glm::dvec3& weight : weights_mm_) farthest_mm_ += glm::length(weight);
  }

  glm::dvec3 at(const glm::dvec3& p_mm) const {
    glm::dvec3 by_mm(0.0);
    for (std::size_t i = 0; i < weights_mm_.size(); ++i)
      by_mm += weights_mm_[i] * share_at(p_mm - landmarks_[i].p_mm, reach_mm_);
    return by_mm;
  }

  /// No point moves farther than this.
  double farthest_mm() const { return farthest_mm_; }

  bool reaches(const glm::dvec3& low_mm, const glm::dvec3& high_mm) const {
    return std::any_of(landmarks_.begin(), landmarks_.end(), [&](const LandmarkShift& each) {
      return glm::distance(each.p_mm, glm::clamp(each.p_mm, low_mm, high_mm)) < reach_mm_;
    });
  }

  glm::dvec3 origin_mm(const glm::dvec3& p_mm) const {
    // If the displacement changes by at most 0.95 mm per mm, the iteration converges within 500 rounds.
    constexpr int most_rounds = 500;
    constexpr double rest_mm = 1e-9;
    glm::dvec3 x = p_mm - at(p_mm);
    for (int round = 0; round < most_rounds; ++round) {
      const glm::dvec3 next = p_mm - at(x);
      if (glm::distance(next, x) <= rest_mm) return next;
      x = next;
    }
    throw Error(ErrorCode::Geometry, "the displacements fold the tissue at (" + std::to_string(p_mm.x) +
                                         ", " + std::to_string(p_mm.y) + ", " + std::to_string(p_mm.z) +
                                         ") mm: choose a larger reach, or smaller displacements");
  }

 private:
  const std::vector<LandmarkShift>& landmarks_;
  std::vector<glm::dvec3> weights_mm_;
  double reach_mm_, farthest_mm_ = 0.0;
};

/// The status of all blocks from `low` to `high`, both included; Partial unless all are full or all are empty.
Status status_of_blocks(const Octree& octree, const glm::ivec3& low, const glm::ivec3& high) {
  const Status first = octree.leaf_block(low).status();
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (octree.leaf_block({x, y, z}).status() != first) return Status::Partial;
  return first;
}

}  // namespace

Octree warped_by_landmarks(const Octree& still, const Expression& expression,
                           const std::vector<LandmarkShift>& landmarks, double reach_mm,
                           const Progress& progress) {
  check(landmarks, reach_mm);
  const Shifts shifts(landmarks, reach_mm);
  const Universe& universe = still.universe();
  const Lattice lattice = universe.lattice();
  const Membership contains(universe, expression);
  const glm::dvec3 voxel_mm = lattice.spacing_mm();
  const glm::ivec3 margin(glm::ceil(shifts.farthest_mm() / (static_cast<double>(block_side) * voxel_mm)));
  const int blocks = (universe.side() + block_side - 1) / block_side;
  SharedProgress shared(progress, static_cast<std::size_t>(blocks) * static_cast<std::size_t>(blocks) *
                                      static_cast<std::size_t>(blocks));

  const auto inside = [&](const glm::ivec3& voxel) {
    const glm::dvec3 p_mm = lattice.lps_mm(glm::dvec3(voxel));
    if (shifts.at(p_mm) == glm::dvec3(0.0)) return still.contains(voxel);
    return contains(shifts.origin_mm(p_mm));
  };
  const auto rows_of = [&](const glm::ivec3& block) {
    BlockRows rows{};
    const glm::ivec3 first = block_side * block;
    const glm::ivec3 count = glm::min(glm::ivec3(block_side), universe.side() - first);
    for (int z = 0; z < count.z; ++z)
      for (int y = 0; y < count.y; ++y) {
        unsigned row = 0;
        for (int x = 0; x < count.x; ++x)
          if (inside(first + glm::ivec3(x, y, z))) row |= 1u << x;
        rows[static_cast<std::size_t>(y + block_side * z)] = static_cast<std::uint16_t>(row);
      }
    return rows;
  };
  return octree_of_blocks(universe, [&](const glm::ivec3& block) {
    shared.one_more();
    // The box around the voxels' centres in LPS, because the lattice may be turned against LPS.
    glm::dvec3 low_mm(1e300), high_mm(-1e300);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 end(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
      const glm::dvec3 p_mm = lattice.lps_mm(glm::dvec3(block_side * block + (block_side - 1) * end));
      low_mm = glm::min(low_mm, p_mm);
      high_mm = glm::max(high_mm, p_mm);
    }
    if (!shifts.reaches(low_mm, high_mm) ||
        status_of_blocks(still, block - margin, block + margin) != Status::Partial)
      return Block::share(still.leaf_block(block));
    return leaf_block_of_rows(rows_of(block));
  });
}

}  // namespace octotomy::voxel
