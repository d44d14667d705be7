// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/solid/resampling.h"

namespace octotomy::voxel {

/// A sample, as a multiple of the step of its grey octree.
struct OwnedSample {
  double in_steps = 0.0;
  double step = 1.0;

  double value() const { return step * in_steps; }
};

/// An expression whose windows supply samples.
struct SampleSource {
  Expression expression;
  std::optional<Octree> voxels = {};  ///< the windows own no voxels outside these; none: no limit
  /// Only windows whose samples have this step supply samples; other windows only limit the voxels. None: all
  /// windows supply samples.
  std::optional<double> step = {};
};

/// A window that contains all samples of a scan, after a rigid motion or reflection of LPS.
Expression all_samples(const GreyOctree& grey, const glm::dmat4& moved_from_still = glm::dmat4(1.0));

/// Adds samples to `voxels` without changing its voxels. `samples` is a window under motions. A voxel that no
/// window of `voxels` owns gets this window's sample, if there is one. Used for voxels that were computed
/// from a scan and stored as an octree.
Expression with_samples(const Expression& voxels, const Expression& samples);
/// For a term made by with_samples(), the term of its `voxels`; otherwise the term itself.
const Expression::Term& before_samples(const Expression::Term& term);

/// The windows of an expression that supply samples to the voxels that they contain: those under an even
/// number of complements and right sides of a minus. Throws as for_each_term() does.
std::vector<Window> positive_windows(const Expression& expression);

/// Computes samples of expressions at single positions, without building a scan. Windows are tested in the
/// order of the expressions and in reading order within each. The owner of a voxel is the first window that
/// contains the voxel and is under an even number of complements and right sides of a minus. If there is
/// none, it is the first other window that does not contain the voxel. A window in an operand of a union can
/// own only voxels that this operand contains. Copies share their data.
class GreyOwners {
 public:
  /// Precondition: the sources' `voxels` have this universe. Cost: combine() for each operand of a union that
  /// contains windows and is neither a window nor a union. Memory: the octrees of these operands.
  GreyOwners(const Universe& universe, const std::vector<SampleSource>& sources,
             const Resampling& resampling = {});

  /// The sample at p_voxel, a position in voxels of the universe, of the window that owns `voxel`. The
  /// position is mapped back by the window's motions and interpolated between the window's samples. None if
  /// no window owns the voxel.
  std::optional<OwnedSample> at(const glm::ivec3& voxel, const glm::dvec3& p_voxel) const;

  const Universe& universe() const;
  /// All windows in the order in which they are tested.
  std::vector<Window> windows() const;
  /// Whether both certainly return the same samples: they have one universe, the same voxels and the same
  /// terms in memory. Windows and their motions that were created separately are compared by value.
  bool is_same(const GreyOwners& other) const;

 private:
  struct Storage;
  std::shared_ptr<const Storage> storage_;
};

}  // namespace octotomy::voxel
