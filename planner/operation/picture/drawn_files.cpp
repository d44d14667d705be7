// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/drawn_files.h"

#include <variant>

#include "planner/operation/file/path_checks.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/mesh_voxels.h"
#include "planner/operation/picture/ray_pictures.h"
#include "planner/operation/table/plan_universe.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {
namespace {

/// Makes the object a grey octree's window.
void set_window(voxel::DrawnObject& object, const voxel::GreyOctree& grey, const SampleWindow& window) {
  object.octree = voxel::combine(grey.universe(), voxel::Expression(window_on(grey, window)));
  // The depth is interpolated at the lower bound. An upper bound inside the object would make it wrong.
  if (!window.high) object.grey = grey;
  object.threshold = window.low;
}

/// A file's name without folder and ending; of a folder, its own name.
std::string name_of(const std::filesystem::path& path) {
  const std::filesystem::path last = path.has_filename() ? path.filename() : path.parent_path().filename();
  const std::filesystem::path stem = last.stem();
  return stem.extension() == ".nii" ? stem.stem().string() : stem.string();
}

/// The object of a file, for drawing.
voxel::DrawnObject drawn_of_file(const std::filesystem::path& path, const Render& render,
                                 const std::optional<voxel::Universe>& universe, const FileBench& bench) {
  if (is_mesh(path)) return {name_of(path), voxels_of_mesh(path, universe, render.voxel_mm, bench)};
  Timings& timings = bench.timings;
  voxel::DrawnObject object{name_of(path), voxel::Octree::empty({})};
  if (is_octree(path)) {
    const voxel::OctreeFile file = [&] {
      const Stopwatch watch(timings, "read");
      return voxel::read_octree(path);
    }();
    const Stopwatch watch(timings, "octree");
    if (const auto* octree = std::get_if<voxel::Octree>(&file.tree)) {
      object.octree = *octree;
    } else if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
      set_window(object, *grey, render.window);
      object.counted_in_grey = object.grey.has_value();
    } else {
      const auto& partial = std::get<voxel::PartialOctree>(file.tree);
      // Shares are no densities: pictures along rays find no samples.
      if (render.count || is_ray_picture(render)) {
        object.octree = partial.touching;
        object.inside = partial.inside;
      } else {
        object.octree = voxel::at_least_half(partial);
        object.grey = voxel::share_samples(partial);
        object.threshold = voxel::half_share;
      }
    }
  } else {
    const voxel::Scene scene = bench.read_scan(path);
    need_hounsfield(render.window, scene);
    const Stopwatch watch(timings, "octree");
    const voxel::Universe where = universe ? *universe : universe_of(scene, render.voxel_mm);
    set_window(object, voxel::grey_octree_of(where, scene, voxel::beyond_scan, bench.progress("octree")),
               render.window);
    if (object.octree.is_empty()) {
      const voxel::Range range = voxel::range(scene);
      throw std::runtime_error(path.string() + ": no voxel is in the window " + to_string(render.window) +
                               "; samples are from " + std::to_string(range.low) + " to " +
                               std::to_string(range.high));
    }
  }
  return object;
}

}  // namespace

std::vector<voxel::DrawnObject> drawn_of_files(const Render& render, const std::vector<ObjectName>& files,
                                               const FileBench& bench) {
  std::vector<voxel::DrawnObject> objects;
  for (const ObjectName& file : files) {
    std::optional<voxel::Universe> universe;
    if (!objects.empty()) universe = objects.front().octree.universe();
    objects.push_back(drawn_of_file(file.name, render, universe, bench));
    voxel::DrawnObject& object = objects.back();
    if (universe && object.octree.universe() != *universe) {
      // Samples of another lattice cannot be traversed along this universe's columns.
      object.octree = voxel::combine(*universe, voxel::Expression(object.octree));
      object.grey.reset();
      object.counted_in_grey = false;
      object.inside.reset();
    }
  }
  return objects;
}

voxel::DrawnObject drawn(const Object& object, const glm::vec3& colour) {
  voxel::DrawnObject drawn{object.id, object.voxel.octree, colour, std::nullopt, 0.0};
  if (!object.shown) return drawn;
  drawn.grey = object.shown->grey;
  drawn.threshold = object.shown->threshold;
  if (object.shown->moved_from_still != glm::dmat4(1.0))
    drawn.moved_from_still = object.shown->moved_from_still;
  return drawn;
}

void paint(const Render& render, std::vector<voxel::DrawnObject>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i].colour = i < render.colours.size() ? need_colour(render.colours[i]) : colour_of(i);
    if (i < render.opacities.size()) objects[i].opacity = static_cast<float>(render.opacities[i]);
  }
}

}  // namespace octotomy::planner
