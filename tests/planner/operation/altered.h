// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "brep/mesh/solid.h"
#include "convert/voxel/voxelise.h"
#include "planner/operation/object/certify.h"
#include "planner/plan/evaluate.h"
#include "voxel/measure/measure.h"

namespace octotomy::tests {

enum class Altered { Voxels, Mesh, Both };

/// An answer of both kernels.
struct Answer {
  voxel::Octree voxels;
  brep::Solid mesh;
};

/// The answers of both kernels for an object of the plan. An empty name means an empty object.
inline Answer answer_of(const planner::Evaluation& evaluation, const std::string& id) {
  if (id.empty()) return {voxel::Octree::empty(evaluation.universe), brep::Solid()};
  const planner::Object& object = evaluation.object(id);
  return {object.voxel.octree, object.mesh.within.value()};
}

/// An object's answer with each vertex farther from the origin.
inline Answer pushed_out(const planner::Evaluation& evaluation, const std::string& id, double by_mm) {
  brep::Triangles mesh = evaluation.object(id).mesh.within.value().triangles();
  for (glm::dvec3& p_mm : mesh.points_mm) p_mm += by_mm * glm::normalize(p_mm);
  brep::Solid solid = brep::trusted_solid(std::move(mesh), brep::Proof::Connection);
  voxel::Octree voxels = convert::voxelise(evaluation.universe, solid.linked());
  return {std::move(voxels), std::move(solid)};
}

/// The certificate of an object whose answer is replaced by another.
inline verify::Certificate altered_certificate(const planner::Evaluation& evaluation, const std::string& id,
                                               const Answer& by, Altered which = Altered::Both) {
  planner::Object object = evaluation.object(id);
  if (which != Altered::Mesh) {
    object.voxel.octree = by.voxels;
    object.voxel.measures = voxel::measure(object.voxel.octree);
  }
  if (which != Altered::Voxels) object.mesh.whole = object.mesh.within = by.mesh;
  planner::certify(object, "altered");
  return *object.certificate;
}
inline verify::Certificate altered_certificate(const planner::Evaluation& evaluation, const std::string& id,
                                               const std::string& by, Altered which = Altered::Both) {
  return altered_certificate(evaluation, id, answer_of(evaluation, by), which);
}

/// Expects that another answer fails, in either kernel and in both.
inline void expect_fails_as(const planner::Evaluation& evaluation, const std::string& id, const Answer& by,
                            const std::string& name) {
  for (const Altered which : {Altered::Voxels, Altered::Mesh, Altered::Both}) {
    const verify::Certificate certificate = altered_certificate(evaluation, id, by, which);
    EXPECT_EQ(verify::to_string(certificate.verdict), "FAIL")
        << id << " as '" << name << "', case " << static_cast<int>(which)
        << testing::PrintToString(certificate.reasons);
  }
}
inline void expect_fails_as(const planner::Evaluation& evaluation, const std::string& id,
                            const std::string& by) {
  expect_fails_as(evaluation, id, answer_of(evaluation, by), by);
}

}  // namespace octotomy::tests
