// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "brep/mesh/health.h"
#include "planner/plan/answers.h"
#include "planner/table/field_json.h"
#include "planner/table/operation.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// Two halves of a ball, labels 1 and 4, with a table of names beside them.
void write_halves(const ScratchFolder& folder) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(glm::ivec3(24), glm::dvec3(2.0), glm::dvec3(-23.0));
  voxel::Int16Samples samples(scene.lattice.sample_count(), 0);
  for (int i = 0; i < 24 * 24 * 24; ++i) {
    const glm::dvec3 p = scene.lattice.lps_mm({i % 24, i / 24 % 24, i / 576});
    if (glm::length(p) < 18.0) samples[static_cast<std::size_t>(i)] = p.x < 0.0 ? 1 : 4;
  }
  scene.samples = std::move(samples);
  voxel::write_scene(scene, folder / "halves.nrrd");
  std::ofstream(folder / "halves.json") << R"({"right half": 1, "left half": 4})";
}

TEST(SurfacesStep, WritesAllLabelsAsOneFile) {
  const ScratchFolder folder;
  write_halves(folder);
  const Plan plan =
      parse_plan(R"({"octotomy_plan": 1, "name": "halves", "scans": {"labels": {"path": "halves.nrrd"}},
      "universe": {"voxel_mm": 2}, "steps": [
      {"id": "parts", "do": "surfaces", "scan": "labels", "path": "parts.vtp"}]})",
                 folder.path());
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluate(plan), folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_TRUE(files[0].written);
  const auto& parts = files[0].details["parts"];
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0]["name"], "right half");
  EXPECT_EQ(parts[1]["label"], 4);
  for (const auto& part : parts)
    EXPECT_NEAR(part["volume_mm3"].get<double>(), part["volume_samples_mm3"].get<double>(),
                0.05 * part["volume_samples_mm3"].get<double>());
  ASSERT_EQ(files[0].details["contacts"].size(), 1u);
  EXPECT_NEAR(files[0].details["contacts"][0]["area_mm2"].get<double>(), 3.14 * 18 * 18, 60.0);
  EXPECT_FALSE(brep::read_triangles(folder / "parts.vtp").faces.empty());
}

TEST(SurfacesVerb, WritesAFileALabelUnderItsName) {
  const ScratchFolder folder;
  write_halves(folder);
  const Operation& operation = *find_operation("surfaces");
  const auto run = [&](const std::string& out) {
    Action action(operation);
    std::vector<Field> fields = operation.fields;
    fields.insert(fields.end(), operation.verb_fields.begin(), operation.verb_fields.end());
    read_fields(fields, {{"scan", (folder / "halves.nrrd").string()}, {"out", (folder / out).string()}},
                action.value(), {});
    Timings timings;
    FileBench bench{timings};
    bench.scan_reader = [](const std::filesystem::path& path, const voxel::SlicesFinal&) {
      return voxel::read_scene(path);
    };
    return operation.on_files(action.value(), bench);
  };
  const FileAnswer answer = run("{name}.ply");
  ASSERT_EQ(answer.json["files"].size(), 2u);
  for (const char* name : {"left_half.ply", "right_half.ply"})
    EXPECT_TRUE(brep::health(brep::read_triangles(folder / name)).solid()) << name;
  EXPECT_THROW(run("one.stl"), std::runtime_error) << "holds one surface";
  EXPECT_TRUE(answer.findings.empty());
}

}  // namespace
}  // namespace octotomy::planner
