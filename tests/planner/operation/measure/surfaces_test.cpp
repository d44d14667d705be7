// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "brep/mesh/health.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/operation.h"
#include "planner/plan/plan_results.h"
#include "tests/file_bytes.h"
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

class SurfacesVerb : public testing::Test {
 protected:
  SurfacesVerb() { write_halves(folder_); }

  FileAnswer run(const std::string& out) const {
    const Operation& operation = *find_operation("surfaces");
    Action action(operation);
    std::vector<Field> fields = operation.fields;
    fields.insert(fields.end(), operation.verb_fields.begin(), operation.verb_fields.end());
    read_fields(fields, {{"scan", (folder_ / "halves.nrrd").string()}, {"out", (folder_ / out).string()}},
                action.value(), {});
    Timings timings;
    FileBench bench{timings};
    bench.scan_reader = [](const std::filesystem::path& path, const voxel::SlicesFinal&) {
      return voxel::read_scene(path);
    };
    return operation.on_files(action.value(), bench);
  }
  std::string refusal(const std::string& out) const {
    try {
      run(out);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

TEST_F(SurfacesVerb, WritesAFileALabelUnderItsName) {
  const FileAnswer answer = run("{name}.ply");
  ASSERT_EQ(answer.json["files"].size(), 2u);
  for (const char* name : {"left_half.ply", "right_half.ply"})
    EXPECT_TRUE(brep::health(brep::read_triangles(folder_ / name)).solid()) << name;
  EXPECT_THROW(run("one.stl"), std::runtime_error) << "holds one surface";
  EXPECT_TRUE(answer.findings.empty());
}

TEST_F(SurfacesVerb, ReplacesFilesThatNobodyTypedOnlyWhereItWroteThem) {
  for (const char* extension : {".stl", ".ply", ".obj", ".off", ".vtp", ".glb"}) {
    for (int i = 0; i < 2; ++i) EXPECT_EQ(refusal(std::string("{name}") + extension), "");
    const std::string name = std::string("right_half") + extension;
    std::ofstream(folder_ / name) << "mine";
    EXPECT_TRUE(
        refusal(std::string("{name}") + extension).starts_with((folder_ / name).string() + ": is there"));
    EXPECT_EQ(bytes_of(folder_ / name), "mine");
  }
  std::ofstream(folder_ / "typed.vtp") << "old";
  EXPECT_EQ(refusal("typed.vtp"), "");
  EXPECT_NE(bytes_of(folder_ / "typed.vtp"), "old");
}

TEST_F(SurfacesVerb, RefusesANameThatIsTooLongByThePathThatWasTyped) {
  std::ofstream(folder_ / "halves.json") << R"({"right half": 1, ")" << std::string(250, 'x') << R"(": 4})";
  const std::string reason = refusal("{name}.stl");
  EXPECT_NE(reason.find("x.stl: is too long a name"), std::string::npos) << reason;
  EXPECT_EQ(reason.find(".octotomy-"), std::string::npos) << reason;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "right_half.stl"));
}

}  // namespace
}  // namespace octotomy::planner
