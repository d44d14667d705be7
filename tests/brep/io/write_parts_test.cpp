// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/write_parts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "brep/io/read_mesh.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

/// Two tetrahedra on either side of one triangle.
PartedSurface twins() {
  PartedSurface parted;
  parted.triangles.points_mm = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, 4}, {1, 1, -1.5}};
  parted.triangles.faces = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  parted.sides = {{2, 7}, {7, 0}, {7, 0}, {7, 0}, {2, 0}, {2, 0}, {2, 0}};
  parted.names = {{2, "lower \"jaw\""}, {7, "upper"}};
  return parted;
}

TEST(SurfaceOfPart, IsClosedAndSharesTheFaceBetween) {
  const PartedSurface parted = twins();
  const Triangles lower = surface_of_part(parted, 2), upper = surface_of_part(parted, 7);
  for (const auto& [surface, height_mm] : {std::pair{lower, 1.5}, {upper, 4.0}}) {
    EXPECT_EQ(surface.points_mm.size(), 4u);
    EXPECT_TRUE(health(surface).solid());
    EXPECT_NEAR(volume_mm3(mesh_of(surface)), 4.5 * height_mm / 3.0, 1e-12);
  }
  EXPECT_TRUE(surface_of_part(parted, 3).faces.empty());
}

TEST(WriteParts, EveryFormatHoldsAllParts) {
  const tests::ScratchFolder folder;
  const PartedSurface parted = twins();
  for (const char* name : {"a.vtp", "a.OBJ"}) {
    write_parts(parted, folder / name);
    const Triangles read = read_triangles(folder / name);
    EXPECT_EQ(read.points_mm, parted.triangles.points_mm) << name;
    EXPECT_EQ(read.faces.size(), name == std::string("a.vtp") ? 7u : 8u) << "shared once, or in both groups";
  }
  const std::string vtp = tests::bytes_of(folder / "a.vtp"), obj = tests::bytes_of(folder / "a.OBJ");
  for (const char* word :
       {"Name=\"part_behind\"", "Name=\"part_in_front\"", ">2 7 <", "117 112 112 101 114 0 "})
    EXPECT_NE(vtp.find(word), std::string::npos) << word;
  EXPECT_NE(obj.find("g lower_\"jaw\"\nf 1 2 3\n"), std::string::npos);
  EXPECT_NE(obj.find("g upper\nf 1 3 2\n"), std::string::npos) << "turned";
  write_parts(parted, folder / "a.glb");
  const std::string glb = tests::bytes_of(folder / "a.glb");
  const auto json = nlohmann::json::parse(glb.substr(20, glb.find("BIN") - 24));
  ASSERT_EQ(json["nodes"].size(), 2u);
  EXPECT_EQ(json["nodes"][0]["name"], "lower \"jaw\"");
  EXPECT_EQ(json["scenes"][0]["nodes"], nlohmann::json({0, 1}));
  for (const auto& mesh : json["meshes"]) {
    const auto& shape = mesh["primitives"][0];
    EXPECT_EQ(shape["attributes"]["POSITION"], 0);
    EXPECT_EQ(json["accessors"][shape["indices"].get<std::size_t>()]["count"], 12);
  }
  EXPECT_EQ(json["buffers"][0]["byteLength"], 5 * 12 + 2 * 12 * 4);
}

TEST(WriteParts, SidesThatDoNotFitAreRefused) {
  const tests::ScratchFolder folder;
  PartedSurface parted = twins();
  EXPECT_THROW(write_parts(parted, folder / "a.stl"), Error);
  parted.sides[0] = {2, 2};
  EXPECT_THROW(write_parts(parted, folder / "a.vtp"), std::invalid_argument);
  parted.sides[0] = {2, 8};
  EXPECT_THROW(write_parts(parted, folder / "a.vtp"), std::invalid_argument);
  parted.sides.pop_back();
  EXPECT_THROW(write_parts(parted, folder / "a.vtp"), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
