// SPDX-License-Identifier: AGPL-3.0-or-later
//
// VTK, meshio and numpy: what they write is read to its place, and what we write they read to its place.
#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"
#include "tests/run_command.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

namespace fs = std::filesystem;

constexpr const char* script = "/usr/bin/python3 " OCTOTOMY_SOURCE_DIR "/tests/brep/io/other_programs.py ";

bool has_programs(const fs::path& folder) {
  return tests::run_command("/usr/bin/python3 -c 'import vtk, meshio, numpy'", folder).status == 0;
}

TEST(OtherMeshPrograms, EveryFormThatTheyWriteIsReadToItsPlace) {
  const tests::ScratchFolder folder;
  if (!has_programs(folder.path())) GTEST_SKIP() << "VTK and meshio for Python are not installed";
  const auto written = tests::run_command(script + ("write " + folder.path().string()), folder.path());
  ASSERT_EQ(written.status, 0) << written.errors;
  int read = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    if (!is_mesh_file(entry.path())) continue;
    SCOPED_TRACE(entry.path().filename().string());
    const MeshFile file = read_mesh(entry.path());
    EXPECT_EQ(file.extent().low_mm, glm::dvec3(10, 30, -5));
    EXPECT_EQ(file.extent().high_mm, glm::dvec3(20, 50, 25));
    EXPECT_NEAR(size_of(file.triangles).volume_mm3, 6000.0, 1e-9);
    EXPECT_TRUE(health(file.triangles).solid()) << health(file.triangles).findings.front();
    ++read;
  }
  EXPECT_GT(read, 200);
}

TEST(OtherMeshPrograms, WhatWeWriteTheyReadToTheSamePlace) {
  const tests::ScratchFolder folder;
  if (!has_programs(folder.path())) GTEST_SKIP() << "VTK and meshio for Python are not installed";
  std::string command = std::string(script) + "read";
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.off", "a.vtp", "a.glb"}) {
    write_mesh(shapes::box({10, 30, -5}, {20, 50, 25}), folder / name);
    command += " " + (folder / name).string();
  }
  const auto read = tests::run_command(command, folder.path());
  EXPECT_EQ(read.status, 0) << read.errors;
  EXPECT_NE(read.out.find("all 6"), std::string::npos) << read.out;
}

}  // namespace
}  // namespace octotomy::brep
