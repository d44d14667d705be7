// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/openvdb_peer.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/RayIntersector.h>
#include <openvdb/tools/RayTracer.h>

namespace octotomy::bench {

struct OpenVdbPeer::Grids {
  openvdb::MaskGrid::Ptr mask = openvdb::MaskGrid::create();
  openvdb::BoolGrid::Ptr values = openvdb::BoolGrid::create(false);
};

OpenVdbPeer::OpenVdbPeer(int side, const std::vector<std::uint64_t>& words)
    : grids_(std::make_unique<Grids>()) {
  openvdb::initialize();
  auto accessor = grids_->values->getAccessor();
  const int words_per_row = (side + 63) / 64;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const int row = static_cast<int>(i) / words_per_row;
    const int first = 64 * (static_cast<int>(i) % words_per_row);
    for (std::uint64_t rest = words[i]; rest != 0; rest &= rest - 1)
      accessor.setValue({first + __builtin_ctzll(rest), row % side, row / side}, true);
  }
  openvdb::tools::prune(grids_->values->tree());
  grids_->mask->tree().topologyUnion(grids_->values->tree());
}

OpenVdbPeer::~OpenVdbPeer() = default;

std::uint64_t OpenVdbPeer::combine(Operation operation, const OpenVdbPeer& other, bool count) const {
  openvdb::MaskTree result(grids_->mask->tree());
  const openvdb::MaskTree& operand = other.grids_->mask->tree();
  switch (operation) {
    case Operation::Union:
      result.topologyUnion(operand);
      break;
    case Operation::Intersection:
      result.topologyIntersection(operand);
      break;
    case Operation::Difference:
      result.topologyDifference(operand);
      break;
  }
  return count ? result.activeVoxelCount() : result.empty();
}

std::uint64_t OpenVdbPeer::transform(const std::array<double, 16>& target_from_source, bool count) const {
  openvdb::Mat4R row_vectors;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) row_vectors(i, j) = target_from_source[static_cast<std::size_t>(4 * i + j)];
  const openvdb::BoolGrid::Ptr moved = openvdb::BoolGrid::create(false);
  openvdb::tools::GridTransformer(row_vectors)
      .transformGrid<openvdb::tools::PointSampler>(*grids_->values, *moved);
  return count ? moved->activeVoxelCount() : moved->empty();
}

std::uint64_t OpenVdbPeer::bytes() const {
  return grids_->mask->memUsage();
}

struct OpenVdbSurface::Grid {
  openvdb::FloatGrid::Ptr level_set;
  std::unique_ptr<openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid>> intersector;
};

OpenVdbSurface::OpenVdbSurface(const FlatMesh& mesh, double voxel_mm) : grid_(std::make_unique<Grid>()) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  for (std::size_t i = 0; i < mesh.points_mm.size(); i += 3)
    points.emplace_back(mesh.points_mm[i], mesh.points_mm[i + 1], mesh.points_mm[i + 2]);
  std::vector<openvdb::Vec3I> triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); i += 3)
    triangles.emplace_back(mesh.faces[i], mesh.faces[i + 1], mesh.faces[i + 2]);
  grid_->level_set = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(voxel_mm), points, triangles);
  grid_->intersector =
      std::make_unique<openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid>>(*grid_->level_set);
}

struct OpenVdbVoxeliser::Mesh {
  double voxel_mm = 1.0;
  std::vector<openvdb::Vec3s> points;  // of voxels, as meshToVolume takes them
  std::vector<openvdb::Vec3I> triangles;
};

OpenVdbVoxeliser::OpenVdbVoxeliser(const FlatMesh& mesh, double voxel_mm) : mesh_(std::make_unique<Mesh>()) {
  openvdb::initialize();
  mesh_->voxel_mm = voxel_mm;
  const auto scale = static_cast<float>(1.0 / voxel_mm);
  for (std::size_t i = 0; i < mesh.points_mm.size(); i += 3)
    mesh_->points.emplace_back(scale * static_cast<float>(mesh.points_mm[i]),
                               scale * static_cast<float>(mesh.points_mm[i + 1]),
                               scale * static_cast<float>(mesh.points_mm[i + 2]));
  for (std::size_t i = 0; i < mesh.faces.size(); i += 3)
    mesh_->triangles.emplace_back(mesh.faces[i], mesh.faces[i + 1], mesh.faces[i + 2]);
}

OpenVdbVoxeliser::~OpenVdbVoxeliser() = default;

std::uint64_t OpenVdbVoxeliser::band_voxels() const {
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(mesh_->points,
                                                                                        mesh_->triangles);
  // The narrowest band for which its signs are correct.
  const openvdb::FloatGrid::Ptr grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      mesh, *openvdb::math::Transform::createLinearTransform(mesh_->voxel_mm), 1.0f, 1.0f);
  return grid->activeVoxelCount();
}

OpenVdbSurface::~OpenVdbSurface() = default;

int OpenVdbSurface::draw(const PicturePlane& plane) const {
  const auto vec = [](const Triple& p) { return openvdb::Vec3R(p[0], p[1], p[2]); };
  const openvdb::Vec3R centre = vec(plane.centre_mm);
  const auto side = static_cast<std::size_t>(plane.side_px);
  openvdb::tools::Film film(side, side, openvdb::tools::Film::RGBA(1.0f, 1.0f, 1.0f, 0.0f));
  openvdb::tools::OrthographicCamera camera(film, openvdb::Vec3R(0.0),
                                            centre - plane.range_mm * vec(plane.look), plane.width_mm);
  camera.lookAt(centre, vec(plane.up));
  const openvdb::tools::DiffuseShader<> shader(openvdb::tools::Film::RGBA(0.9f, 0.9f, 0.9f));
  openvdb::tools::rayTrace(*grid_->level_set, *grid_->intersector, shader, camera, 1, 0, true);
  int lit = 0;  // the shader's white is 0.9, the background's 1
  for (std::size_t i = 0; i < side * side; ++i) lit += film.pixels()[i].r < 0.95f;
  return lit;
}

}  // namespace octotomy::bench
