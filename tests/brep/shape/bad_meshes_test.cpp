// SPDX-License-Identifier: AGPL-3.0-or-later
// Every bad mesh comes out as a closed solid of about the volume that is meant, or is refused with a reason.
#include "tests/brep/bad_meshes.h"

#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/split_fans.h"
#include "brep/shape/repair.h"

namespace octotomy::brep {
namespace {

class BadMeshes : public testing::TestWithParam<shapes::BadMesh> {};

std::string name_of(const testing::TestParamInfo<shapes::BadMesh>& info) {
  return info.param.name;
}

TEST_P(BadMeshes, BecomeASolidWithItsChangesListedOrAreRefused) {
  const shapes::BadMesh& bad = GetParam();
  RepairOptions options;
  options.solid = true;
  try {
    const Repair repaired = repair(bad.triangles, options);
    const Health now = health(repaired.surface);
    ASSERT_TRUE(now.solid()) << now.findings.front();
    const double volume = size_of(repaired.surface).volume_mm3;
    ASSERT_TRUE(bad.volume_mm3 || bad.any_volume)
        << "nothing is enclosed, yet there is a solid of " << volume << " mm3";
    if (bad.volume_mm3) {
      EXPECT_NEAR(volume / *bad.volume_mm3, 1.0, 0.06);
    }
    EXPECT_FALSE(repaired.changes.empty() && !health(bad.triangles).solid());
    if (std::getenv("OCTOTOMY_TABLE") != nullptr)
      std::printf("| %s | %s, %zu changes | %.4g of %.4g mm3 |\n", bad.name.c_str(),
                  repaired.enclosed_cell_mm ? "enclosed" : "mended", repaired.changes.size(), volume,
                  *bad.volume_mm3);
  } catch (const Error& error) {
    EXPECT_FALSE(bad.volume_mm3) << error.what();
    EXPECT_GT(std::string(error.what()).size(), 20u);
    if (std::getenv("OCTOTOMY_TABLE") != nullptr)
      std::printf("| %s | refused | %s |\n", bad.name.c_str(), error.what());
  }
}

TEST_P(BadMeshes, AreJoinedToAMeshUnlessAPointIsNotFinite) {
  const shapes::BadMesh& bad = GetParam();
  const bool has_finite_faces = bad.name != "not_a_number" && bad.name != "infinite";
  if (!has_finite_faces) {
    EXPECT_THROW(joined_surface(bad.triangles), Error);
    return;
  }
  const JoinedSurface joined = joined_surface(bad.triangles);
  const Mesh mesh = mesh_of(joined.surface);
  EXPECT_NEAR(size_of(mesh).area_mm2, size_of(bad.triangles).area_mm2, 1e-9 * size_of(mesh).area_mm2);
}

INSTANTIATE_TEST_SUITE_P(All, BadMeshes, testing::ValuesIn(shapes::bad_meshes()), name_of);

TEST(BadMeshes, AreFortyKindsAtLeast) {
  EXPECT_GE(shapes::bad_meshes().size(), 40u);
}

}  // namespace
}  // namespace octotomy::brep
