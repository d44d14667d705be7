// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/drawn_files.h"

#include <variant>

#include "planner/cli/scan_verbs.h"
#include "planner/cli/verb.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner::cli {
namespace {

/// The object that a grey octree's window is.
void set_window(voxel::DrawnObject& object, const voxel::GreyOctree& grey, const WindowText& window) {
  voxel::Window leaf{grey, window.low};
  if (window.high) leaf.high = *window.high;
  object.octree = voxel::combine(grey.universe(), voxel::Expression(leaf));
  // Depth is interpolated at the lower bound; an upper bound inside the object breaks that.
  if (!window.high) object.grey = grey;
  object.threshold = window.low;
}

/// A file's name without folder and ending; of a folder, its own name.
std::string name_of(const std::filesystem::path& path) {
  const std::filesystem::path last = path.has_filename() ? path.filename() : path.parent_path().filename();
  const std::filesystem::path stem = last.stem();
  return stem.extension() == ".nii" ? stem.stem().string() : stem.string();
}

/// What a file holds, as it is to be drawn.
voxel::DrawnObject drawn_of_file(const std::filesystem::path& path, const DrawnText& text,
                                 const std::optional<voxel::Universe>& universe, Timings& timings) {
  if (is_mesh(path)) throw std::runtime_error(path.string() + ": meshes are not drawn; voxelise it first");
  const WindowText window = parse_window(text.window);
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
      set_window(object, *grey, window);
      object.counted_in_grey = object.grey.has_value();
    } else {
      const auto& partial = std::get<voxel::PartialOctree>(file.tree);
      object.octree = partial.touching;
      object.inside = partial.inside;
    }
  } else {
    voxel::Scene scene;
    {
      const Stopwatch watch(timings, "read");
      scene = voxel::read_scene(path, text.read);
    }
    need_hounsfield(text.window, scene);
    const Stopwatch watch(timings, "octree");
    set_window(object,
               voxel::grey_octree_of(universe ? *universe : universe_of(scene.lattice, text.voxel_mm), scene),
               window);
    if (object.octree.is_empty()) {
      const voxel::Range range = voxel::range(scene);
      throw std::runtime_error(path.string() + ": no voxel is in the window " + text.window +
                               "; samples are from " + std::to_string(range.low) + " to " +
                               std::to_string(range.high));
    }
  }
  return object;
}

}  // namespace

std::vector<voxel::DrawnObject> drawn_of_files(const DrawnText& text, Timings& timings) {
  if (text.colours.size() > text.files.size() || text.opacities.size() > text.files.size())
    throw CLI::ValidationError("--colour and --opacity", "give at most one of each a file");
  std::vector<voxel::DrawnObject> objects;
  for (std::size_t i = 0; i < text.files.size(); ++i) {
    std::optional<voxel::Universe> universe;
    if (i > 0) universe = objects.front().octree.universe();
    objects.push_back(drawn_of_file(text.files[i], text, universe, timings));
    voxel::DrawnObject& object = objects.back();
    if (universe && object.octree.universe() != *universe) {
      // Samples of another lattice cannot be followed along this one's columns.
      object.octree = voxel::combine(*universe, voxel::Expression(object.octree));
      object.grey.reset();
      object.counted_in_grey = false;
      object.inside.reset();
    }
    object.colour = i < text.colours.size() ? parse_colour(text.colours[i]) : colour_of(i);
    if (i < text.opacities.size()) object.opacity = text.opacities[i];
  }
  return objects;
}

}  // namespace octotomy::planner::cli
