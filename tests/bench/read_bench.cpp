// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/mesh.h"
// Included after mesh.h, which turns OpenMesh's assertions off.
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <cstdint>
#include <filesystem>

#include "brep/io/read_mesh.h"
#include "tests/bench/benchmarks.h"
#ifdef OCTOTOMY_HAS_ITK
#include "tests/bench/itk_peer.h"
#endif
#include "tests/bench/workspace.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::bench {
namespace {

/// An uncompressed series of 512 x 512 x 300, written once.
const std::filesystem::path& series() {
  static const std::filesystem::path folder = [] {
    std::filesystem::path made = workspace() / "series";
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice({512, 512, 300}, {0.5, 0.5, 0.75}, {-128, -128, -100});
    voxel::Int16Samples samples(scene.lattice.sample_count());
    std::uint32_t noise = 1;
    for (std::int16_t& sample : samples) {
      noise = noise * 1664525U + 1013904223U;
      sample = static_cast<std::int16_t>(static_cast<int>(noise >> 22) - 1000);
    }
    scene.samples = std::move(samples);
    scene.meaning = voxel::Meaning::Hounsfield;
    scene.modality = "CT";
    voxel::write_dicom_series(scene, made);
    return made;
  }();
  return folder;
}

// Reads a folder into a grey octree, with all audits.
void run_ours(benchmark::State& state) {
  const std::filesystem::path& folder = series();
  for (auto _ : state) {
    const voxel::Scene scene = voxel::read_scene(folder);
    const voxel::Universe universe{9, scene.lattice.lps_from_voxel};
    benchmark::DoNotOptimize(voxel::grey_octree_of(universe, scene).background());
  }
}

#ifdef OCTOTOMY_HAS_ITK
void run_itk(benchmark::State& state) {
  const std::filesystem::path& folder = series();
  for (auto _ : state) benchmark::DoNotOptimize(read_series_by_itk(folder));
}
#endif

void run_stl(benchmark::State& state) {
  const std::filesystem::path path = bone_file(".stl");
  std::size_t triangles = 0;
  for (auto _ : state) triangles = brep::read_triangles(path).faces.size();
  state.counters["triangles"] = static_cast<double>(triangles);
}

void run_stl_by_openmesh(benchmark::State& state) {
  const std::filesystem::path path = bone_file(".stl");
  for (auto _ : state) {
    brep::Mesh mesh;
    if (!OpenMesh::IO::read_mesh(mesh, path.string())) state.SkipWithError("OpenMesh does not read it");
    benchmark::DoNotOptimize(mesh.n_faces());
  }
}

}  // namespace

void register_read() {
  add("read/surface/stl/500k", run_stl);
  add("peer/openmesh/read/surface/stl/500k", run_stl_by_openmesh);
  add("read/series_to_grey_octree/512x512x300", run_ours);
#ifdef OCTOTOMY_HAS_ITK
  add("peer/itk/read/series_to_grey_octree/512x512x300", run_itk);
#endif
}

}  // namespace octotomy::bench
