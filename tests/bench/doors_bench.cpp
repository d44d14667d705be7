// SPDX-License-Identifier: AGPL-3.0-or-later
// Octree to mesh and mesh to octree, and the same work in VTK and OpenVDB.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "brep/mesh/winding_number.h"
#include "convert/surface/isosurface.h"
#include "convert/voxel/voxelise.h"
#include "convert/voxel/winding_number.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/picture_plane.h"
#include "tests/bench/subjects.h"
#if defined(OCTOTOMY_HAS_OPENVDB)
#include "tests/bench/openvdb_peer.h"
#endif
#if defined(OCTOTOMY_HAS_VTK)
#include "tests/bench/flat_scan.h"
#include "tests/bench/vtk_contour.h"
#endif

namespace octotomy::bench {
namespace {

constexpr double bone_hu = 300.0;

/// A scan of a ball of a quarter of the side, blurred over two voxels, on the universe's lattice: about one
/// voxel in twenty of its octree's bricks lies at the boundary.
const voxel::Scene& ball_scan(int side) {
  static std::map<int, voxel::Scene> scans;
  const auto found = scans.find(side);
  if (found != scans.end()) return found->second;
  voxel::Scene scene;
  scene.lattice = universe(side).lattice();
  const double centre = 0.5 * side - 0.37;
  voxel::Int16Samples samples;
  samples.reserve(scene.lattice.sample_count());
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double depth = 0.25 * side - std::hypot(x - centre, y - centre, z - centre);
        samples.push_back(
            static_cast<std::int16_t>(std::lround(bone_hu + 500.0 * std::clamp(depth, -2.0, 2.0))));
      }
  scene.samples = std::move(samples);
  return scans.emplace(side, std::move(scene)).first->second;
}

/// A scan of the head on the universe's lattice, so that all readers read the same samples.
const voxel::Scene& head_on_universe(int side) {
  static std::map<int, voxel::Scene> scans;
  const auto found = scans.find(side);
  if (found != scans.end()) return found->second;
  const voxel::GreyOctree grey = grey_skull(side);
  voxel::Scene scene;
  scene.lattice = universe(side).lattice();
  voxel::Int16Samples samples;
  samples.reserve(scene.lattice.sample_count());
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) samples.push_back(grey.sample({x, y, z}));
  scene.samples = std::move(samples);
  return scans.emplace(side, std::move(scene)).first->second;
}

const voxel::Scene& scan_of(const std::string& name, int side) {
  return name == "skull" ? head_on_universe(side) : ball_scan(side);
}

void run_isosurface(benchmark::State& state, const std::string& name, int side) {
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe(side), scan_of(name, side));
  std::size_t faces = 0;
  for (auto _ : state) {
    const brep::Triangles surface =
        convert::isosurface(grey, bone_hu, std::numeric_limits<double>::infinity());
    faces = surface.faces.size();
    benchmark::DoNotOptimize(surface.points_mm.data());
  }
  state.counters["triangles"] = static_cast<double>(faces);
}

/// A ball of about half a million triangles that fills nine tenths of the universe's side.
brep::Triangles ball(int side) {
  constexpr int rings = 500;
  const voxel::Lattice lattice = universe(side).lattice();
  const glm::dvec3 centre = lattice.lps_mm(glm::dvec3(0.5 * side - 0.41));
  const double radius_mm = 0.45 * side * lattice.spacing_mm().x;
  brep::Triangles t;
  t.points_mm.push_back(centre + glm::dvec3(0, 0, radius_mm));
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < rings; ++i) {
      const double polar = M_PI * ring / rings;
      const double around = 2.0 * M_PI * i / rings;
      t.points_mm.push_back(centre + radius_mm * glm::dvec3(std::sin(polar) * std::cos(around),
                                                            std::sin(polar) * std::sin(around),
                                                            std::cos(polar)));
    }
  t.points_mm.push_back(centre - glm::dvec3(0, 0, radius_mm));
  const auto last = static_cast<std::uint32_t>(t.points_mm.size() - 1);
  const auto point = [&](int ring, int i) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * rings + i % rings);
  };
  for (int i = 0; i < rings; ++i) {
    t.faces.push_back({0, point(1, i), point(1, i + 1)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      t.faces.push_back({point(ring, i), point(ring + 1, i), point(ring + 1, i + 1)});
      t.faces.push_back({point(ring, i), point(ring + 1, i + 1), point(ring, i + 1)});
    }
    t.faces.push_back({last, point(rings - 1, i + 1), point(rings - 1, i)});
  }
  return t;
}

void run_voxelise(benchmark::State& state, int side) {
  const brep::Linked solid = brep::linked(ball(side));
  std::uint64_t voxels = 0;
  for (auto _ : state) voxels = convert::voxelise(universe(side), solid).voxel_count();
  state.counters["voxels"] = static_cast<double>(voxels);
  state.counters["triangles"] = static_cast<double>(solid.triangles.faces.size());
}

/// The skull's surface without its lowest quarter and without one triangle in 1,000.
brep::Triangles open_skull(int side) {
  brep::Triangles surface = convert::isosurface(voxel::grey_octree_of(universe(side), head_on_universe(side)),
                                                bone_hu, std::numeric_limits<double>::infinity());
  const double lowest_mm = universe(side).lattice().lps_mm(glm::dvec3(0.25 * side)).z;
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::size_t i = 0; i < surface.faces.size(); ++i)
    if (i % 1000 != 0 && surface.points_mm[surface.faces[i][0]].z > lowest_mm)
      kept.push_back(surface.faces[i]);
  surface.faces = std::move(kept);
  return surface;
}

void run_voxelise_open(benchmark::State& state, int side) {
  const brep::Triangles surface = open_skull(side);
  std::uint64_t voxels = 0;
  for (auto _ : state) voxels = convert::voxelise_by_winding_number(universe(side), surface).voxel_count();
  state.counters["voxels"] = static_cast<double>(voxels);
  state.counters["triangles"] = static_cast<double>(surface.faces.size());
}

/// The same voxels by sums over a tree of the triangles, within 0.05, at every centre.
void run_winding_tree(benchmark::State& state, int side) {
  const brep::Triangles surface = open_skull(side);
  const voxel::Lattice lattice = universe(side).lattice();
  std::vector<glm::dvec3> centres_mm;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) centres_mm.push_back(lattice.lps_mm(glm::dvec3(x, y, z)));
  std::ptrdiff_t voxels = 0;
  for (auto _ : state) {
    const std::vector<double> winds = brep::WindingTree(surface).at(centres_mm);
    voxels = std::count_if(winds.begin(), winds.end(), [](double w) { return w > 0.5; });
  }
  state.counters["voxels"] = static_cast<double>(voxels);
}

#if defined(OCTOTOMY_HAS_OPENVDB)
void run_openvdb(benchmark::State& state, int side) {
  const brep::Triangles solid = ball(side);
  FlatMesh mesh;
  for (const glm::dvec3& p : solid.points_mm)
    for (int axis = 0; axis < 3; ++axis) mesh.points_mm.push_back(static_cast<float>(p[axis]));
  for (const auto& face : solid.faces) mesh.faces.insert(mesh.faces.end(), face.begin(), face.end());
  const OpenVdbVoxeliser peer(mesh, universe(side).lattice().spacing_mm().x);
  std::uint64_t voxels = 0;
  for (auto _ : state) voxels = peer.band_voxels();
  state.counters["band_voxels"] = static_cast<double>(voxels);
}
#endif

#if defined(OCTOTOMY_HAS_VTK)
void run_vtk(benchmark::State& state, const std::string& name, int side) {
  const VtkContour peer(flat_scan(scan_of(name, side)), bone_hu,
                        static_cast<int>(std::thread::hardware_concurrency()));
  std::size_t triangles = 0;
  for (auto _ : state) triangles = peer.triangles();
  state.counters["triangles"] = static_cast<double>(triangles);
}
#endif

}  // namespace

void register_doors() {
  for (const std::string name : {"skull", "sphere"})
    for (const int side : {256, 512}) {
      const std::string what = "isosurface/" + name + "/" + std::to_string(side);
      add(what, [=](benchmark::State& state) { run_isosurface(state, name, side); });
#if defined(OCTOTOMY_HAS_VTK)
      add("peer/vtk/" + what, [=](benchmark::State& state) { run_vtk(state, name, side); });
#endif
    }
  add("voxelise/ball/512", [](benchmark::State& state) { run_voxelise(state, 512); });
  for (const int side : {128, 256}) {
    const std::string what = "voxelise/open_skull/" + std::to_string(side);
    add(what, [=](benchmark::State& state) { run_voxelise_open(state, side); });
    add("reference/winding_tree/" + what, [=](benchmark::State& state) { run_winding_tree(state, side); });
  }
#if defined(OCTOTOMY_HAS_OPENVDB)
  add("peer/openvdb/voxelise/ball/512", [](benchmark::State& state) { run_openvdb(state, 512); });
#endif
}

}  // namespace octotomy::bench
