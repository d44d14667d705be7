// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxelise.h"

#include "brep/health.h"
#include "brep/read_mesh.h"
#include "convert/voxelise_partial.h"
#include "convert/winding_number.h"
#include "planner/answer.h"
#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"

namespace octotomy::planner::cli {
namespace {

struct VoxeliseText {
  std::filesystem::path mesh, out, like;
  double voxel_mm = 1.0;
  std::string digitise = "centre";
};

voxel::Box box_of(const brep::Triangles& triangles) {
  voxel::Box box{triangles.points_mm.front(), triangles.points_mm.front()};
  for (const glm::dvec3& p : triangles.points_mm) {
    box.low_mm = glm::min(box.low_mm, p);
    box.high_mm = glm::max(box.high_mm, p);
  }
  return box;
}

voxel::Universe universe_of(const VoxeliseText& text, const brep::Triangles& triangles, Timings& timings) {
  if (!text.like.empty()) return voxel::universe(read_timed(text.like, timings));
  try {
    return voxel::universe_around(box_of(triangles), text.voxel_mm);
  } catch (const std::length_error& error) {
    throw std::runtime_error(text.mesh.string() + ": " + error.what() +
                             ": is its unit millimetres? Give larger voxels by --voxel");
  }
}

decltype(voxel::OctreeFile::tree) of_solid(const voxel::Universe& universe, const brep::Mesh& solid,
                                           const std::string& digitise,
                                           const convert::VoxeliseOptions& options) {
  if (digitise == "centre") return convert::voxelise(universe, solid);
  voxel::PartialOctree partial = convert::voxelise_partial(universe, solid, options);
  if (digitise == "inside") return partial.inside;
  if (digitise == "touching") return partial.touching;
  if (digitise == "half") return voxel::at_least_half(partial);
  return partial;
}

bool is_nothing(const decltype(voxel::OctreeFile::tree)& tree) {
  if (const auto* octree = std::get_if<voxel::Octree>(&tree)) return octree->is_empty();
  return std::get<voxel::PartialOctree>(tree).touching.is_empty();
}

int voxelise(const Program& program, const VoxeliseText& text) {
  need_octree_extension(text.out);
  need_folder_of(text.out);
  Timings timings;
  brep::Triangles triangles;
  {
    const Stopwatch watch(timings, "read");
    triangles = brep::read_triangles(text.mesh);
  }
  if (triangles.faces.empty()) throw std::runtime_error(text.mesh.string() + ": holds no triangles");
  const voxel::Universe universe = universe_of(text, triangles, timings);
  brep::Health health;
  {
    const Stopwatch watch(timings, "health");
    health = brep::health(triangles);
  }

  std::vector<std::string> findings;
  if (!health.solid()) {
    if (text.digitise != "centre")
      throw std::runtime_error(text.mesh.string() + ": is not a solid (" + health.findings.front() +
                               "), so that the share of a voxel it fills is not known: mend it, or take the "
                               "voxels' centres by --digitise centre");
    findings.push_back(
        "method: " + text.mesh.string() + " is not a solid (" + health.findings.front() +
        "); voxels are those about whose centre it winds more than a half (generalised winding "
        "number), which guesses across holes");
  }
  convert::VoxeliseOptions options;
  options.stop = program.stop.get_token();
  if (const auto progress = program.progress())
    options.progress = [progress](double share) { progress("voxelising", share); };
  voxel::OctreeFile file{voxel::Octree::empty(universe), text.mesh.stem().string(), ""};
  {
    const Stopwatch watch(timings, "voxelise");
    if (health.solid())
      file.tree = of_solid(universe, brep::mesh_of(triangles), text.digitise, options);
    else
      file.tree = convert::voxelise_by_winding_number(universe, triangles, options);
  }
  if (is_nothing(file.tree))
    throw std::runtime_error(text.mesh.string() +
                             ": encloses no voxel: take smaller voxels by --voxel; where the mesh is inside "
                             "out, flip its triangles");
  file.metadata = Json{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                       {"mesh", text.mesh.filename().string()},
                       {"digitise", text.digitise},
                       {"method", health.solid() ? "parity" : "winding number"}}
                      .dump();
  return write_and_say(program, file, text.out, timings, findings);
}

}  // namespace

void add_voxelise(Program& program) {
  const auto text = std::make_shared<VoxeliseText>();
  CLI::App& verb =
      program.verb("voxelise", "Makes an octree of a mesh",
                   "octotomy voxelise maxilla.stl -o maxilla.octree --voxel 0.5\n"
                   "  octotomy voxelise plate.stl -o plate.octree --like skull.octree --digitise partial",
                   [&program, text] { return voxelise(program, *text); });
  verb.add_option("mesh", text->mesh,
                  "A .stl, .ply, .obj, .off or .vtk file; where it is no solid, its holes and crossings are "
                  "bridged by the winding number")
      ->required()
      ->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "An .octree file")->required();
  CLI::Option* voxel = verb.add_option("--voxel", text->voxel_mm, "Edge of a voxel, mm")
                           ->check(above_zero())
                           ->capture_default_str();
  verb.add_option("--like", text->like, "Take the universe of this .octree file, to combine with it")
      ->check(CLI::ExistingFile)
      ->excludes(voxel);
  verb.add_option("--digitise", text->digitise,
                  "Which voxels: inside (D1), touching (D2), centre (D3), half (D4), or partial, with the "
                  "share of each that is filled")
      ->check(CLI::IsMember({"inside", "touching", "centre", "half", "partial"}))
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
