// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/write_mesh.h"

#include <cstring>
#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "tests/brep/shapes.h"
#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

std::filesystem::path folder() {
  static const tests::ScratchFolder scratch;
  return scratch.path();
}

TEST(WriteMesh, DoublesComeBackToTheLastBit) {
  const Mesh mesh = mesh_of(shapes::sphere({1e-3, -1e5, 1.0 / 3.0}, 7.0, 2));
  const Triangles wanted = triangles_of(mesh);
  for (const char* name : {"sphere.ply", "sphere.obj", "sphere.OFF", "sphere.vtp"}) {
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
  const std::string bytes = tests::bytes_of(folder() / "coloured.ply");
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

template <typename T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

TEST(WriteMesh, AGlbHoldsPlacesNormalsColoursAndCornersAsItsHeaderSays) {
  const Mesh mesh = mesh_of(shapes::sphere({0, 0, 0}, 10.0, 1));
  VertexData data;
  for (std::size_t v = 0; v < mesh.n_vertices(); ++v) data.colours.emplace_back(0, 255, 188);
  write_mesh(mesh, folder() / "ball.glb", data);
  const std::string bytes = tests::bytes_of(folder() / "ball.glb");
  ASSERT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 8), bytes.size());
  const std::size_t json = number_at<std::uint32_t>(bytes, 12), n = mesh.n_vertices();
  ASSERT_EQ(json % 4, 0u);
  EXPECT_EQ(bytes.substr(20 + json + 4, 4), std::string("BIN\0", 4));
  const std::size_t body = 20 + json + 8;
  ASSERT_EQ(number_at<std::uint32_t>(bytes, 20 + json), n * (12 + 12 + 8) + 12 * mesh.n_faces());
  for (std::size_t v = 0; v < n; ++v)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // On a ball about the origin a point's normal is its direction.
      const auto place = number_at<float>(bytes, body + 12 * v + 4 * axis);
      EXPECT_NEAR(number_at<float>(bytes, body + 12 * (n + v) + 4 * axis), place / 10.0F, 0.01F);
    }
  EXPECT_EQ(number_at<std::uint16_t>(bytes, body + 24 * n), 0);
  EXPECT_EQ(number_at<std::uint16_t>(bytes, body + 24 * n + 2), 65535);
  EXPECT_NEAR(number_at<std::uint16_t>(bytes, body + 24 * n + 4), 32768, 700);  // half of the light
  EXPECT_EQ(number_at<std::uint32_t>(bytes, body + 32 * n), triangles_of(mesh).faces[0][0]);
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
  for (const char* name : {"none.stl", "none.ply", "none.obj", "none.off", "none.vtp"}) {
    write_mesh(Mesh(), folder() / name);
    EXPECT_TRUE(read_triangles(folder() / name).faces.empty()) << name;
  }
}

}  // namespace
}  // namespace octotomy::brep
