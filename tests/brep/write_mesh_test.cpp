// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/write_mesh.h"

#include <fstream>
#include <gtest/gtest.h>

#include "brep/read_mesh.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

std::filesystem::path folder() {
  const auto path = std::filesystem::path(testing::TempDir()) / "octotomy_write_mesh";
  std::filesystem::create_directories(path);
  return path;
}

TEST(WriteMesh, DoublesComeBackToTheLastBit) {
  const Mesh mesh = mesh_of(shapes::sphere({1e-3, -1e5, 1.0 / 3.0}, 7.0, 2));
  const Triangles wanted = triangles_of(mesh);
  for (const char* name : {"sphere.ply", "sphere.obj", "sphere.OFF"}) {
    write_mesh(mesh, folder() / name);
    const Triangles back = read_triangles(folder() / name);
    EXPECT_EQ(back.points_mm, wanted.points_mm) << name;
    EXPECT_EQ(back.faces, wanted.faces) << name;
  }
}

TEST(WriteMesh, StlComesBackWeldedInSinglePrecision) {
  const Mesh mesh = mesh_of(shapes::sphere({1, 2, 3}, 7.0, 2));
  write_mesh(mesh, folder() / "sphere.stl");
  EXPECT_EQ(std::filesystem::file_size(folder() / "sphere.stl"), 84u + 50u * mesh.n_faces());
  const Triangles back = read_triangles(folder() / "sphere.stl"), wanted = triangles_of(mesh);
  ASSERT_EQ(back.points_mm.size(), wanted.points_mm.size());
  ASSERT_EQ(back.faces.size(), wanted.faces.size());
  for (std::size_t f = 0; f < back.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LT(glm::distance(back.points_mm[back.faces[f][k]], wanted.points_mm[wanted.faces[f][k]]),
                10 * std::numeric_limits<float>::epsilon());
}

TEST(WriteMesh, ColoursAndScalarsGoIntoPlyBesideThePlaces) {
  const Mesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 2, 3}));
  VertexData data;
  data.scalar_name = "distance_mm";
  for (unsigned v = 0; v < mesh.n_vertices(); ++v) {
    data.colours.emplace_back(v, 2 * v, 255 - v);
    data.scalars.push_back(-0.5 * v);
  }
  write_mesh(mesh, folder() / "coloured.ply", data);
  EXPECT_EQ(read_triangles(folder() / "coloured.ply").points_mm, triangles_of(mesh).points_mm);
  std::ifstream file(folder() / "coloured.ply", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(bytes.find("property uchar red\nproperty uchar green\nproperty uchar blue\n"
                       "property double distance_mm\nelement face"),
            std::string::npos);
  const std::size_t body = bytes.find("end_header\n") + 11, stride = 3 * 8 + 3 + 8;
  EXPECT_EQ(static_cast<unsigned char>(bytes[body + 5 * stride + 24]), 5);
  EXPECT_EQ(static_cast<unsigned char>(bytes[body + 5 * stride + 25]), 10);
  EXPECT_EQ(static_cast<unsigned char>(bytes[body + 5 * stride + 26]), 250);

  EXPECT_THROW(write_mesh(mesh, folder() / "coloured.stl", data), std::runtime_error);
  data.colours.pop_back();
  EXPECT_THROW(write_mesh(mesh, folder() / "coloured.ply", data), std::invalid_argument);
  data.colours.clear();
  data.scalar_name = "two words";
  EXPECT_THROW(write_mesh(mesh, folder() / "coloured.ply", data), std::invalid_argument);
}

TEST(WriteMesh, AFailureLeavesWhatWasThere) {
  const Mesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THROW(write_mesh(mesh, folder() / "box.xyz"), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder() / "box.xyz"));
  EXPECT_THROW(write_mesh(mesh, folder() / "missing" / "box.stl"), std::runtime_error);
  std::filesystem::create_directories(folder() / "taken.stl");
  EXPECT_THROW(write_mesh(mesh, folder() / "taken.stl"), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_directory(folder() / "taken.stl"));
  for (const auto& entry : std::filesystem::directory_iterator(folder()))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST(WriteMesh, AnEmptyMeshIsAFileWithoutTriangles) {
  for (const char* name : {"none.stl", "none.ply", "none.obj", "none.off"}) {
    write_mesh(Mesh(), folder() / name);
    EXPECT_TRUE(read_triangles(folder() / name).faces.empty()) << name;
  }
}

}  // namespace
}  // namespace octotomy::brep
