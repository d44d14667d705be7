// SPDX-License-Identifier: AGPL-3.0-or-later
// Objects that are thinner than the voxels which count them.
#include <cmath>
#include <gtest/gtest.h>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"
#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/brep/shapes.h"
#include "tests/planner/ct_scene.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

const Json& named(const Json& measured, const std::string& id) {
  for (const Json& one : measured)
    if (one.at("id") == id) return one;
  throw std::invalid_argument("no measurement is called " + id);
}

/// The count's half-width reaches the mesh's volume, by a term and with a finding.
void expect_widened(const Json& size) {
  const double counted_mm3 = size.at("volume_mm3"), mesh_mm3 = size.at("mesh").at("volume_mm3");
  EXPECT_EQ(size.at("volume_half_width_mm3").get<double>(), std::abs(mesh_mm3 - counted_mm3)) << size;
  EXPECT_EQ(size.at("volume_half_width_terms").back().at("name"), "mesh") << size;
  ASSERT_TRUE(size.contains("finding")) << size;
  EXPECT_NE(size.at("finding").get<std::string>().find("too coarse"), std::string::npos) << size;
  const Json& recommended = size.at("volume");
  EXPECT_NEAR(recommended.at("value").get<double>(), mesh_mm3, recommended.at("half_width").get<double>());
}

class MeasureStep : public testing::Test {
 protected:
  /// A plate of 0.2 mm between the planes of voxel centres, and a cube of 10 mm.
  MeasureStep() {
    brep::write_mesh(brep::mesh_of(brep::shapes::box({-10, -10, 0.2}, {10, 10, 0.4})), folder_ / "plate.stl");
    brep::write_mesh(brep::mesh_of(brep::shapes::box({-5, -5, -5}, {5, 5, 5})), folder_ / "cube.stl");
  }
  Json measured(const Plan& plan) const { return measurements_json(plan, evaluate(plan)); }

  ScratchFolder folder_;
};

TEST_F(MeasureStep, VoxelsThatPassOverAnImportedPlateSayHowMuchTheyMiss) {
  const Json all = measured(ball_plan(folder_, R"(
      {"id": "plate", "do": "import", "path": "plate.stl"},
      {"id": "cube", "do": "import", "path": "cube.stl"},
      {"id": "both", "do": "combine", "expression": "plate | cube"},
      {"id": "plate_size", "do": "measure", "object": "plate"},
      {"id": "cube_size", "do": "measure", "object": "cube"},
      {"id": "ball_size", "do": "measure", "object": "ball"},
      {"id": "gap", "do": "measure", "object": "plate", "to": "cube"},
      {"id": "touch", "do": "contacts", "object": "cube", "against": "plate"})"));
  const Json& plate = named(all, "plate_size");
  EXPECT_EQ(plate.at("volume_mm3"), 0.0) << "the plate meets voxel centres";
  EXPECT_NEAR(plate.at("volume_half_width_mm3").get<double>(), 80.0, 1e-4);
  expect_widened(plate);
  // The mesh is what was imported, whatever the voxels pass over.
  EXPECT_NEAR(plate.at("area").at("value").get<double>(), 816.0, 1e-3);
  EXPECT_LT(plate.at("area").at("half_width").get<double>(), 0.01);
  for (const char* id : {"cube_size", "ball_size"}) {
    EXPECT_FALSE(named(all, id).contains("finding")) << id;
    EXPECT_NE(named(all, id).at("volume_half_width_terms").back().at("name"), "mesh") << id;
  }
  EXPECT_NE(named(all, "gap").at("finding").get<std::string>().find("its mesh encloses 80.0"),
            std::string::npos)
      << named(all, "gap");
  EXPECT_NE(named(all, "touch").at("findings").dump().find("its mesh encloses 80.0"), std::string::npos)
      << named(all, "touch");
}

TEST(FloatScans, AMapOfSharesIsCutAtItsOwnValuesInBothKernels) {
  const ScratchFolder folder;
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({24, 24, 24}, glm::dvec3(1.0), glm::dvec3(0.0));
  voxel::FloatSamples samples;
  const auto share = [](const glm::ivec3& v) {
    const glm::ivec3 off = glm::abs(2 * v - 23);
    const int most = std::max({off.x, off.y, off.z});
    return most < 4 ? 0.95F : most < 8 ? 0.7F : most < 12 ? 0.3F : 0.0F;
  };
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) samples.push_back(share({x, y, z}));
  scene.samples = std::move(samples);
  voxel::write_scene(scene, folder / "map.nrrd");
  const Evaluation evaluation = evaluate(parse_plan(
      R"({"octotomy_plan": 1, "name": "map", "scans": {"ct": {"path": "map.nrrd"}}, "steps": [
      {"id": "some", "do": "window", "scan": "ct", "low": 0.3},
      {"id": "most", "do": "window", "scan": "ct", "low": 0.7},
      {"id": "all", "do": "window", "scan": "ct", "low": 0.9},
      {"id": "between", "do": "window", "scan": "ct", "low": 0.25, "high": 0.5}]})",
      folder.path()));
  for (const auto& [id, voxels] : {std::pair("some", 1728U), std::pair("most", 512U), std::pair("all", 64U),
                                   std::pair("between", 1728U - 512U)}) {
    const Object& object = evaluation.object(id);
    EXPECT_EQ(object.voxel.measures.voxel_count, voxels) << id;
    EXPECT_NE(object.certificate->verdict, voxel::Verdict::Fail)
        << id << testing::PrintToString(object.certificate->reasons);
  }
}

/// A scan of 1 x 1 x 0.1 mm with a plate of two samples between the planes of the universe's voxel centres,
/// and perhaps a block beside it.
Plan plan_of_thin_scan(const ScratchFolder& folder, bool has_block) {
  const auto value = [&](const glm::ivec3& at, const glm::dvec3& /*p_mm*/) {
    const bool is_plate = at.z / 2 == 27 && at.x >= 5 && at.x < 35 && at.y >= 5 && at.y < 35;
    const bool is_block = has_block && at.z >= 50 && at.z < 80 && at.x / 3 == 5 && at.y / 3 == 5;
    return is_plate || is_block ? 1000 : -1000;
  };
  voxel::write_scene(tests::ct_scene({40, 40, 120}, {1, 1, 0.1}, {-19.5, -19.5, -5.95}, value),
                     folder / "thin.nrrd");
  return parse_plan(R"({"octotomy_plan": 1, "name": "thin", "scans": {"ct": {"path": "thin.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [
      {"id": "thin", "do": "window", "scan": "ct", "low": 0},
      {"id": "thin_size", "do": "measure", "object": "thin"}]})",
                    folder.path());
}

TEST_F(MeasureStep, VoxelsThatPassOverAPlateOfAScanSayHowMuchTheyMiss) {
  const Json all = measured(plan_of_thin_scan(folder_, true));
  const Json& size = named(all, "thin_size");
  EXPECT_NEAR(size.at("volume_mm3").get<double>(), 27.0, 9.0) << "the block alone";
  EXPECT_GT(size.at("volume_half_width_mm3").get<double>(), 100.0);
  expect_widened(size);
}

TEST_F(MeasureStep, AWindowWhoseSamplesAllVoxelsPassOverIsToldFromOneWithoutSamples) {
  try {
    evaluate(plan_of_thin_scan(folder_, false));
    FAIL() << "has voxels";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("choose smaller voxels"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
