// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <set>

#include "brep/io/write_parts.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::convert {

struct LabelSurfaceOptions {
  std::set<int> labels = {};  ///< the parts; empty: all but 0. Samples with other labels belong to no part.
  /// Radius s, in voxels, 0..4, of the neighbourhood that decides where a surface passes between two samples.
  /// 0: half-way. A larger radius is smoother, and shrinks a ball of radius r by s / 2r voxels.
  int smooth_voxels = 1;
  voxel::Progress progress = {};
};

/// The surfaces of all labels of a label map at once, in LPS millimetres. A part without a name is in `names`
/// with an empty one. Labels that overlap (Scene::overlaps) each get their whole surface; then the guarantees
/// below hold within each of voxel::label_layers().
/// The surfaces partition space: two labels that touch share the triangles between them, three meet in lines
/// and four in points. So there is no gap and no overlap, and the parts' volumes add up to the volume that
/// their outer surface encloses. The surface of each label is closed, manifold, oriented and free of
/// self-intersection for any labels. It passes between neighbouring samples of different labels, at least a
/// tenth of their distance from each; samples that only touch across a cell's diagonal are joined along one
/// of its diagonals, apart along the others. A part that reaches the scan's border is closed half a voxel
/// beyond the outermost samples.
///
/// Throws std::invalid_argument if the scene fails check(), a sample is no label, or an option is out of
/// range; std::length_error as voxel::label_layers(); voxel::Error (Input) if a requested label has no
/// sample, (Resource) if there are more triangles than 32-bit numbers can name; voxel::Stopped. Parallel;
/// same bits on any thread count. Memory: two bytes a sample, four if labels overlap or are not int16, and 80
/// a triangle. Cost: linear in samples, and in triangles but for their numbering, n log n.
brep::PartedSurface label_surfaces(const voxel::Scene& scene, const LabelSurfaceOptions& options = {});

}  // namespace octotomy::convert
