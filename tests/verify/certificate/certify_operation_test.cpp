// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/certify_operation.h"

#include <gtest/gtest.h>

#include "brep/mesh/triangles.h"
#include "convert/surface/cuberille.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

/// An ellipsoid's surface by chords, off any lattice.
brep::Solid ellipsoid_surface(const glm::dvec3& centre_mm, const glm::dvec3& radii_mm) {
  voxel::Universe universe;
  universe.depth = 5;
  const voxel::Octree octree = voxel::combine(universe, voxel::Ellipsoid{centre_mm, radii_mm});
  return brep::trusted_solid(convert::triangles_of(convert::cuberille(octree)), brep::Proof::Construction);
}

class Operations : public testing::TestWithParam<brep::Operation> {};

TEST_P(Operations, OfTerracedSolidsAgreeAtEveryCentreWhateverTheVoxels) {
  const brep::Solid a = ellipsoid_surface({15, 15, 15}, {11, 8, 6}),
                    b = ellipsoid_surface({19.3, 16, 13}, {6, 7, 9});
  for (const double voxel_mm : {0.37, 0.8, 1.3}) {
    const OperationAnswers answers = certify_operation(a, GetParam(), b, {voxel_mm});
    EXPECT_EQ(answers.certificate.verdict, Verdict::Pass)
        << voxel_mm << ": "
        << (answers.certificate.reasons.empty() ? "" : answers.certificate.reasons.front());
    EXPECT_FALSE(answers.octree->is_empty());
  }
}

TEST(CertifyOperation, StopsWhenAsked) {
  const brep::Solid a = ellipsoid_surface({15, 15, 15}, {11, 8, 6}),
                    b = ellipsoid_surface({19.3, 16, 13}, {6, 7, 9});
  std::stop_source source;
  MeshOperationOptions options;
  options.progress = {source.get_token(), [&](double fraction) {
                        if (fraction >= 0.3) source.request_stop();
                      }};
  EXPECT_THROW(certify_operation(a, brep::Operation::Union, b, options), voxel::Stopped);
}

INSTANTIATE_TEST_SUITE_P(All, Operations,
                         testing::Values(brep::Operation::Union, brep::Operation::Intersection,
                                         brep::Operation::Difference));

}  // namespace
}  // namespace octotomy::verify
