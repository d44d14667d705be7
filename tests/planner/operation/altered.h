// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <string>

#include "brep/mesh/solid.h"
#include "planner/operation/object/certify.h"
#include "planner/plan/evaluate.h"
#include "voxel/measure/measure.h"

namespace octotomy::tests {

enum class Altered { Voxels, Mesh, Both };

/// The certificate of an object whose answer is replaced by that of another object of the plan. An empty name
/// stands for nothing at all.
inline verify::Certificate altered_certificate(const planner::Evaluation& evaluation, const std::string& id,
                                               const std::string& by, Altered which = Altered::Both) {
  planner::Object object = evaluation.object(id);
  const voxel::Universe universe = object.voxel.octree.universe();
  if (which != Altered::Mesh) {
    object.voxel.octree = by.empty() ? voxel::Octree::empty(universe) : evaluation.object(by).voxel.octree;
    object.voxel.measures = voxel::measure(object.voxel.octree);
  }
  if (which != Altered::Voxels)
    object.mesh.whole = object.mesh.within =
        by.empty() ? brep::Solid() : evaluation.object(by).mesh.within.value();
  planner::certify(object, "altered");
  return *object.certificate;
}

/// In either kernel and in both, another object's answer must fail.
inline void expect_fails_as(const planner::Evaluation& evaluation, const std::string& id,
                            const std::string& by) {
  for (const Altered which : {Altered::Voxels, Altered::Mesh, Altered::Both}) {
    const verify::Certificate certificate = altered_certificate(evaluation, id, by, which);
    EXPECT_EQ(verify::to_string(certificate.verdict), "FAIL")
        << id << " as '" << by << "', case " << static_cast<int>(which)
        << testing::PrintToString(certificate.reasons);
  }
}

}  // namespace octotomy::tests
