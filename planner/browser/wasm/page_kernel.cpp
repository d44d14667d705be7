// SPDX-License-Identifier: AGPL-3.0-or-later
// What the page calls: one scan at a time, a window of it as an octree, its measures and pictures. Pointers
// stay valid until the next call of the same function. A refusal ends the instance (runtime.cpp).
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/space/lattice.h"
#include "voxel/space/scene.h"
#include "voxel/tree/build.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/view/render.h"

namespace {

using namespace octotomy::voxel;

struct PageState {
  Scene scene;
  std::optional<GreyOctree> grey;
  Octree object = Octree::empty({});
  double low = 0.0;
  std::array<double, 8> numbers{};
  std::vector<std::uint8_t> rgba;
};

PageState& page_state() {
  static PageState only;
  return only;
}

}  // namespace

extern "C" {

/// Frees the previous scan and allocates the samples of a new one with these numbers of samples, x fastest.
/// The page writes them to the returned address.
[[clang::export_name("new_scan")]] std::int16_t* new_scan(int x, int y, int z) {
  page_state() = PageState();
  page_state().scene.lattice.dims = {x, y, z};
  page_state().scene.samples = Int16Samples(page_state().scene.lattice.sample_count());
  return std::get<Int16Samples>(page_state().scene.samples).data();
}

/// The address of the 16 numbers of lps_from_voxel, column by column, to which the page writes the matrix.
[[clang::export_name("lps_from_voxel")]] double* lps_from_voxel() {
  return &page_state().scene.lattice.lps_from_voxel[0][0];
}

/// Opens the scan whose samples and matrix the page has written. The voxels are those of the scan.
[[clang::export_name("open_scan")]] void open_scan() {
  Scene& scene = page_state().scene;
  check(scene);
  Universe universe;
  universe.lps_from_voxel = scene.lattice.lps_from_voxel;
  const int longest = std::max({scene.lattice.dims.x, scene.lattice.dims.y, scene.lattice.dims.z});
  for (universe.depth = 2; universe.side() < longest; ++universe.depth) {
  }
  page_state().grey = grey_octree_of(universe, scene);
  scene.samples = Int16Samples();
}

/// Makes the voxels with samples from `low` to `high` the object. Returns eight numbers: voxels, volume in
/// mm³, area by Crofton's formula in mm², three coordinates of the centroid in LPS mm, bytes of the octree,
/// and 1 if the object is not empty.
[[clang::export_name("choose_window")]] const double* choose_window(double low, double high) {
  PageState& the = page_state();
  the.low = low;
  the.object = combine(the.grey->universe(), window_of(*the.grey, low, high));
  const Measures measures = measure(the.object);
  const glm::dvec3 centre = measures.centroid_mm.value_or(glm::dvec3(0.0));
  the.numbers = {static_cast<double>(measures.voxel_count),
                 measures.volume_mm3,
                 measures.area_crofton13_mm2,
                 centre.x,
                 centre.y,
                 centre.z,
                 static_cast<double>(bytes_memory(the.object)),
                 measures.centroid_mm ? 1.0 : 0.0};
  return the.numbers.data();
}

/// Draws the object as seen along `look` with `up` upwards, unit vectors in LPS at right angles. Returns rows
/// of RGBA from the top left. Traces nodes if the view is along an axis of the scan, else rays.
[[clang::export_name("draw")]] const std::uint8_t* draw(int width_px, int height_px, double look_x,
                                                        double look_y, double look_z, double up_x,
                                                        double up_y, double up_z) {
  PageState& the = page_state();
  RenderOptions options;
  options.size_px = {width_px, height_px};
  options.view.look = {look_x, look_y, look_z};
  options.view.up = {up_x, up_y, up_z};
  options.view.right = glm::cross(options.view.look, options.view.up);
  options.background = glm::vec3(0.07f, 0.09f, 0.11f);
  DrawnObject object{"object", the.object};
  object.grey = the.grey;
  object.threshold = the.low;
  const Picture picture = render({object}, options);
  the.rgba.resize(picture.rgb.size() / 3 * 4);
  for (std::size_t i = 0; i < picture.rgb.size() / 3; ++i) {
    std::copy_n(&picture.rgb[3 * i], 3, &the.rgba[4 * i]);
    the.rgba[4 * i + 3] = 255;
  }
  return the.rgba.data();
}

}  // extern "C"
