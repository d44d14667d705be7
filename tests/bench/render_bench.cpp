// SPDX-License-Identifier: AGPL-3.0-or-later
// Whole pictures of the head phantom's skull, partial-volume depth and shading included, and what the same
// picture takes elsewhere: the isosurface mesh in Embree, its level set in OpenVDB and NanoVDB, the scan in
// VTK. What each builds once is not counted. Peers light a pixel by one head light on the surface they met.
#include <limits>
#include <string>
#include <tbb/global_control.h>

#include "convert/surface/isosurface.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/picture_plane.h"
#include "tests/bench/subjects.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/expression.h"
#include "voxel/view/camera.h"
#include "voxel/view/render.h"
#ifdef OCTOTOMY_HAS_EMBREE
#include "tests/bench/embree_peer.h"
#endif
#ifdef OCTOTOMY_HAS_NANOVDB
#include "tests/bench/nanovdb_peer.h"
#endif
#ifdef OCTOTOMY_HAS_OPENVDB
#include "tests/bench/openvdb_peer.h"
#endif
#ifdef OCTOTOMY_HAS_VTK
#include "tests/bench/flat_scan.h"
#include "tests/bench/vtk_peer.h"
#endif

namespace octotomy::bench {
namespace {

constexpr double bone_hu = 300.0;

struct Case {
  std::string algorithm;  ///< node_trace or ray_cast
  std::string view;       ///< anterior or oblique
  int side_px = 512;
  int side = 512;
  bool planned = false;  ///< cut and moved instead of as it is

  std::string name() const {
    return "render/" + algorithm + "/" + view + (planned ? "_planned" : "") + "/" + std::to_string(side_px) +
           "px/" + std::to_string(side);
  }
  voxel::View axes() const { return voxel::parse_view(view == "oblique" ? "35,15" : view); }
};

voxel::DrawnObject drawn_skull(int side) {
  const voxel::GreyOctree grey = grey_skull(side);
  return {"skull", voxel::combine(universe(side), voxel::Window{grey, bone_hu, 32767.0}), {}, grey, bone_hu};
}

/// The skull with its upper jaw cut off by a mask of two regions and moved, as while a piece is dragged: no
/// octree is built for either part.
std::vector<voxel::DrawnObject> planned_skull(const voxel::DrawnObject& skull) {
  static const voxel::Expression cut(
      voxel::RegionMask{{{voxel::parse_view("anterior"), {{{{-40, -60}, {40, -60}, {40, -25}, {-40, -25}}}}},
                         {voxel::parse_view("left"), {{{{-90, -60}, {-20, -60}, {-20, -25}, {-90, -25}}}}}}});
  static const glm::dmat4 advance = voxel::moved_from_still({{0, -6, 2}, 5.0, {1, 0, 0}, {0, -40, -30}});
  const voxel::Universe& universe = skull.octree.universe();
  const voxel::Expression bone(skull.octree);
  voxel::DrawnObject rest = skull;
  rest.octree = voxel::Octree::empty(universe);
  rest.unbuilt = bone - cut;
  voxel::DrawnObject jaw = skull;
  jaw.name = "jaw";
  jaw.octree = voxel::Octree::empty(universe);
  jaw.unbuilt = voxel::moved(bone & cut, advance);
  jaw.moved_from_still = advance;
  return {rest, jaw};
}

voxel::RenderOptions options_of(const Case& the) {
  voxel::RenderOptions options;
  options.view = the.axes();
  options.size_px = glm::ivec2(the.side_px);
  options.algorithm = the.algorithm == "node_trace" ? voxel::Algorithm::NodeTrace : voxel::Algorithm::RayCast;
  options.antialias = false;  // a ray a pixel, as everywhere
  return options;
}

void run(benchmark::State& state, const Case& the) {
  const std::vector<voxel::DrawnObject> objects{drawn_skull(the.side)};
  voxel::RenderOptions options = options_of(the);
  const voxel::Frame frame = voxel::frame_about(objects, options.view, options.size_px);
  options.centre_mm = frame.centre_mm;
  options.width_mm = frame.width_mm;
  std::uint64_t lit = 0;
  for (auto _ : state)
    lit = voxel::render(the.planned ? planned_skull(objects.front()) : objects, options).lit_pixels;
  state.counters["lit"] = static_cast<double>(lit);
}

[[maybe_unused]] Triple triple(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

// Unused if no peer is installed.
[[maybe_unused]] PicturePlane plane_of(const Case& the) {
  const std::vector<voxel::DrawnObject> objects{{"skull", skull(the.side)}};
  const glm::ivec2 size_px(the.side_px);
  const voxel::Frame frame = voxel::frame_about(objects, the.axes(), size_px);
  const voxel::ImagePlane image = voxel::image_plane(universe(the.side), the.axes(), size_px, frame);
  PicturePlane plane;
  plane.side_px = the.side_px;
  plane.first_mm = triple(image.lps_mm({0.5, 0.5}, 0.0));
  plane.per_px_x_mm = triple(image.view.right * image.pixel_mm);
  plane.per_px_y_mm = triple(image.view.up * -image.pixel_mm);
  plane.look = triple(image.view.look);
  plane.up = triple(image.view.up);
  plane.centre_mm = triple(image.lps_mm(glm::dvec2(0.5 * the.side_px), 0.5 * image.depth_range_mm));
  plane.width_mm = frame.width_mm;
  plane.range_mm = image.depth_range_mm;
  return plane;
}

[[maybe_unused]] FlatMesh mesh_of(int side) {
  const brep::Triangles triangles =
      convert::isosurface(head(side), bone_hu, std::numeric_limits<double>::infinity());
  FlatMesh mesh;
  for (const glm::dvec3& p : triangles.points_mm)
    for (int axis = 0; axis < 3; ++axis) mesh.points_mm.push_back(static_cast<float>(p[axis]));
  for (const auto& face : triangles.faces) mesh.faces.insert(mesh.faces.end(), face.begin(), face.end());
  return mesh;
}

#ifdef OCTOTOMY_HAS_EMBREE
void run_embree(benchmark::State& state, const Case& the) {
  const EmbreePeer peer(mesh_of(the.side));
  const PicturePlane plane = plane_of(the);
  std::vector<std::uint8_t> rgb;
  int lit = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lit = peer.draw(plane, rgb));
  state.counters["lit"] = lit;
}
#endif

#ifdef OCTOTOMY_HAS_NANOVDB
void run_nanovdb(benchmark::State& state, const Case& the) {
  const NanoVdbPeer peer(mesh_of(the.side), universe(the.side).lattice().spacing_mm().x);
  const PicturePlane plane = plane_of(the);
  std::vector<std::uint8_t> rgb;
  int lit = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lit = peer.draw(plane, rgb));
  state.counters["lit"] = lit;
}
#endif

#ifdef OCTOTOMY_HAS_OPENVDB
void run_openvdb(benchmark::State& state, const Case& the) {
  const OpenVdbSurface peer(mesh_of(the.side), universe(the.side).lattice().spacing_mm().x);
  const PicturePlane plane = plane_of(the);
  int lit = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lit = peer.draw(plane));
  state.counters["lit"] = lit;
}
#endif

#ifdef OCTOTOMY_HAS_VTK
void run_vtk(benchmark::State& state, const Case& the) {
  const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const VtkPeer peer(flat_scan(head(the.side)), bone_hu, static_cast<int>(threads));
  const PicturePlane plane = plane_of(the);
  int lit = 0;
  for (auto _ : state) benchmark::DoNotOptimize(lit = peer.draw(plane));
  state.counters["lit"] = lit;
}
#endif

}  // namespace

void register_render() {
  for (const char* algorithm : {"node_trace", "ray_cast"})
    for (const char* view : {"anterior", "oblique"}) {
      const bool traces = std::string(algorithm) == "node_trace";
      if (traces && std::string(view) == "oblique") continue;  // node tracing is for views along the axes
      for (const int side_px : {512, 1024})
        for (const int side : {256, 512}) {
          Case the{algorithm, view, side_px, side, true};
          add(the.name(), [=](benchmark::State& state) { run(state, the); });
          the.planned = false;
          add(the.name(), [=](benchmark::State& state) { run(state, the); });
#ifdef OCTOTOMY_HAS_EMBREE
          add("peer/embree/" + the.name(), [=](benchmark::State& state) { run_embree(state, the); });
#endif
#ifdef OCTOTOMY_HAS_NANOVDB
          add("peer/nanovdb/" + the.name(), [=](benchmark::State& state) { run_nanovdb(state, the); });
#endif
#ifdef OCTOTOMY_HAS_OPENVDB
          add("peer/openvdb/" + the.name(), [=](benchmark::State& state) { run_openvdb(state, the); });
#endif
#ifdef OCTOTOMY_HAS_VTK
          add("peer/vtk/" + the.name(), [=](benchmark::State& state) { run_vtk(state, the); });
#endif
        }
    }
}

}  // namespace octotomy::bench
