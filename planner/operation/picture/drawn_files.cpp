// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/drawn_files.h"

#include <algorithm>
#include <map>
#include <variant>

#include "planner/operation/file/path_checks.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/mesh_voxels.h"
#include "planner/operation/picture/ray_choice.h"
#include "planner/operation/picture/ray_pictures.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/plan_universe.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {
namespace {

/// Makes the object the window of a grey octree.
void set_window(voxel::DrawnObject& object, const voxel::GreyOctree& grey, const Render& render) {
  const SampleWindow& window = render.window;
  object.octree = voxel::combine(grey.universe(), voxel::Expression(window_on(grey, window)));
  // The depth of the surface is interpolated at the lower bound, which would be wrong inside an object with
  // an upper bound. Then samples are only kept for pictures that do not compute a depth from them.
  const bool gives_no_depth =
      is_decided(render) || render.shading == "density" || render.shading == "gradient";
  if (!window.high || gives_no_depth) object.grey = grey;
  object.threshold = window.low;
}

/// The name of a file without folder and extension; of a folder, its name.
std::string name_of(const std::filesystem::path& path) {
  const std::filesystem::path last = path.has_filename() ? path.filename() : path.parent_path().filename();
  const std::filesystem::path stem = last.stem();
  return stem.extension() == ".nii" ? stem.stem().string() : stem.string();
}

/// The object in a file, for drawing.
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
      set_window(object, *grey, render);
      object.counted_in_grey = object.grey.has_value();
    } else {
      const auto& partial = std::get<voxel::PartialOctree>(file.tree);
      // Shares are not densities, so pictures along rays find no samples here.
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
               render);
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
      // Samples on another lattice cannot be traversed along the columns of this universe.
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

std::vector<ObjectName> files_of(const Render& render) {
  std::vector<ObjectName> files = render.objects;
  std::map<std::string, std::string> bound;
  std::vector<std::string> known;
  for (const std::string& text : render.lets) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw std::runtime_error("--let: '" + text + "' has no name: write NAME=FILE");
    known.push_back(text.substr(0, equals));
    if (!bound.emplace(known.back(), text.substr(equals + 1)).second)
      throw std::runtime_error("--let: '" + known.back() + "' is bound twice");
  }
  const std::vector<std::string> names =
      render.expression.empty() ? std::vector<std::string>{} : voxel::names_in(render.expression);
  for (const std::string& name : names) {
    if (!bound.contains(name))
      throw std::runtime_error("--expression: no object is called '" + name + "'" + suggestion(name, known) +
                               ": bind it with --let " + name + "=FILE");
    files.push_back({bound[name]});
  }
  for (const std::string& name : known)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw std::runtime_error("--let " + name + ": the expression does not use this name: leave it out" +
                               suggestion(name, names) + ": leave it out");
  return files;
}

std::vector<voxel::DrawnObject> with_expression(const Render& render,
                                                std::vector<voxel::DrawnObject> objects) {
  if (render.expression.empty()) return objects;
  const std::vector<std::string> names = voxel::names_in(render.expression);
  const auto first = objects.end() - static_cast<std::ptrdiff_t>(names.size());
  const voxel::Universe universe = objects.front().octree.universe();
  voxel::DrawnObject drawn{render.expression, voxel::Octree::empty(universe)};
  drawn.unbuilt = voxel::parse_expression(render.expression,
                                          {[&](std::string_view name) {
                                             const auto at = std::find(names.begin(), names.end(), name);
                                             return voxel::Expression((first + (at - names.begin()))->octree);
                                           },
                                           {}});
  const auto has_samples = [](const voxel::DrawnObject& operand) { return operand.grey.has_value(); };
  if (std::count_if(first, objects.end(), has_samples) == 1) {
    const voxel::DrawnObject& shown = *std::find_if(first, objects.end(), has_samples);
    drawn.grey = shown.grey;
    drawn.threshold = shown.threshold;
    drawn.moved_from_still = shown.moved_from_still;
  }
  objects.erase(first, objects.end());
  objects.push_back(std::move(drawn));
  return objects;
}

void paint(const Render& render, std::vector<voxel::DrawnObject>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i].colour = i < render.colours.size() ? need_colour(render.colours[i]) : colour_of(i);
    if (i < render.opacities.size()) objects[i].opacity = static_cast<float>(render.opacities[i]);
  }
}

}  // namespace octotomy::planner
