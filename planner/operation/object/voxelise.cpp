// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes octrees and label maps of meshes: the verb of meshes in files, the step of objects' meshes.
#include "convert/voxel/voxelise.h"

#include <algorithm>

#include "brep/mesh/health.h"
#include "brep/mesh/split_fans.h"
#include "brep/shape/repair.h"
#include "convert/voxel/voxelise_partial.h"
#include "convert/voxel/winding_number.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/error.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner {
namespace {

struct Voxelise {
  std::vector<ObjectName> meshes;
  std::filesystem::path out;
  std::optional<double> voxel_mm;
  std::optional<ObjectName> like;
  std::string digitise = "centre";

  std::vector<std::string> inputs() const {
    std::vector<std::string> names;
    for (const ObjectName& mesh : meshes) names.push_back(mesh.name);
    return names;
  }
};

struct Subject {
  std::filesystem::path path;
  brep::Triangles triangles;
  brep::Health health;
};

/// Turns triangles that wind against their neighbours, because joining would cut the surface between them,
/// and opposite windings would cancel in winding numbers.
void turn_alike(const std::filesystem::path& path, brep::Triangles& triangles,
                std::vector<std::string>& findings) {
  if (triangles.faces.empty()) return;
  const std::size_t contrary = brep::health(triangles, {.self_intersections = false}).misoriented_edges;
  if (contrary == 0) return;
  brep::TurnedAlike alike = brep::turned_alike(triangles);
  triangles = std::move(alike.surface);
  findings.push_back("orient: " + path.string() + " has " + std::to_string(contrary) +
                     " edges whose triangles wind against each other: " + std::to_string(alike.turned) +
                     " triangles were turned, so that outer shells face outward and cavities inward");
}

/// Reads a mesh or object. Throws if it has no triangles, or if it is not a solid but must be digitised
/// exactly. Adds findings on guesses.
Subject read_subject(const FileBench& bench, const std::filesystem::path& path, const std::string& digitise,
                     std::vector<std::string>& findings) {
  Subject subject{path, {}, {}};
  {
    const Stopwatch watch(bench.timings, "read");
    subject.triangles = triangles_named(path.string(), bench);
    turn_alike(path, subject.triangles, findings);
    // The surface is joined, because each open edge would be a rim, and rims are slow.
    subject.triangles = brep::joined_surface(std::move(subject.triangles)).surface;
  }
  if (subject.triangles.faces.empty()) throw std::runtime_error(path.string() + ": holds no triangles");
  {
    const Stopwatch watch(bench.timings, "health");
    subject.health = brep::health(subject.triangles);
  }
  if (subject.health.solid()) return subject;
  if (digitise != "centre")
    throw std::runtime_error(path.string() + ": is not a solid (" + subject.health.findings.front() +
                             "), so the filled share of a voxel is unknown: mend it, or use the voxels' "
                             "centres by --digitise centre");
  findings.push_back("method: " + path.string() + " is not a solid (" + subject.health.findings.front() +
                     "), so the surface across holes is a guess: voxels are those whose centres have a "
                     "generalised winding number above 1/2");
  return subject;
}

voxel::Box box_of(const std::vector<Subject>& subjects) {
  voxel::Box box{subjects.front().triangles.points_mm.front(), subjects.front().triangles.points_mm.front()};
  for (const Subject& subject : subjects)
    for (const glm::dvec3& p : subject.triangles.points_mm) {
      box.low_mm = glm::min(box.low_mm, p);
      box.high_mm = glm::max(box.high_mm, p);
    }
  return box;
}

/// Adds findings on meshes that do not fit the universe in size or position.
void add_findings_beside(const ObjectName& like, const std::vector<Subject>& subjects, Timings& timings,
                         std::vector<std::string>& findings) {
  const voxel::Box all = voxel::bounds(voxel::universe(read_timed(like.name, timings)).lattice());
  for (const Subject& subject : subjects) {
    const voxel::Box box = box_of({subject});
    for (const brep::MeshFinding& finding : brep::findings_beside(
             {box.low_mm, box.high_mm}, {all.low_mm, all.high_mm}, "the universe of " + like.name))
      findings.push_back(subject.path.string() + ": " + finding.check + ": " + finding.detail);
  }
}

voxel::Universe universe_of(const FileBench& bench, const Voxelise& asked,
                            const std::vector<Subject>& subjects) {
  if (asked.like) return voxel::universe(read_timed(asked.like->name, bench.timings));
  if (bench.step != nullptr && !asked.voxel_mm) return bench.step->universe;
  try {
    return voxel::universe_around(box_of(subjects), asked.voxel_mm.value_or(1.0));
  } catch (const voxel::TooLarge& error) {
    throw std::runtime_error(subjects.front().path.string() + ": " + error.what() +
                             ": check that its unit is millimetres, or choose larger voxels by --voxel");
  }
}

decltype(voxel::OctreeFile::tree) of_solid(const voxel::Universe& universe, const brep::Linked& solid,
                                           const std::string& digitise, const voxel::Progress& progress) {
  if (digitise == "centre") return convert::voxelise(universe, solid, progress);
  voxel::PartialOctree partial = convert::voxelise_partial(universe, solid, progress);
  if (digitise == "inside") return partial.inside;
  if (digitise == "touching") return partial.touching;
  if (digitise == "half") return voxel::at_least_half(partial);
  return partial;
}

bool is_nothing(const decltype(voxel::OctreeFile::tree)& tree) {
  if (const auto* octree = std::get_if<voxel::Octree>(&tree)) return octree->is_empty();
  return std::get<voxel::PartialOctree>(tree).touching.is_empty();
}

decltype(voxel::OctreeFile::tree) voxelised(const FileBench& bench, const Voxelise& asked,
                                            const Subject& subject, const voxel::Universe& universe) {
  const voxel::Progress progress = bench.progress("voxelising");
  const Stopwatch watch(bench.timings, "voxelise");
  decltype(voxel::OctreeFile::tree) tree =
      subject.health.solid() ? of_solid(universe, brep::linked(subject.triangles), asked.digitise, progress)
                             : convert::voxelise_by_winding_number(universe, subject.triangles, progress);
  if (is_nothing(tree))
    throw std::runtime_error(subject.path.string() +
                             ": encloses no voxel: choose smaller voxels by --voxel; if the mesh is inside "
                             "out, turn it by octotomy repair --orient");
  return tree;
}

FileAnswer write_octree(const FileBench& bench, const Voxelise& asked, const Subject& subject,
                        const std::vector<std::string>& findings) {
  const voxel::Universe universe = universe_of(bench, asked, {subject});
  voxel::OctreeFile file{voxelised(bench, asked, subject, universe), subject.path.stem().string(), ""};
  file.metadata = json_text(Json{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                                 {"mesh", subject.path.filename().string()},
                                 {"digitise", asked.digitise},
                                 {"method", subject.health.solid() ? "parity" : "winding number"}});
  return octree_written(file, asked.out, bench.stop, bench.timings, findings);
}

/// The voxels of a universe that touch a box, as a separate lattice.
voxel::Lattice lattice_of(const voxel::Universe& universe, const voxel::Box& box) {
  voxel::Lattice lattice = universe.lattice();
  const glm::ivec3 last = lattice.dims - 1;
  const glm::ivec3 from = glm::clamp(glm::ivec3(glm::floor(lattice.voxel(box.low_mm))), glm::ivec3(0), last);
  const glm::ivec3 to = glm::clamp(glm::ivec3(glm::ceil(lattice.voxel(box.high_mm))), glm::ivec3(0), last);
  lattice.lps_from_voxel[3] = glm::dvec4(lattice.lps_mm(glm::dvec3(from)), 1.0);
  lattice.dims = to - from + 1;
  return lattice;
}

FileAnswer write_labels(const FileBench& bench, const Voxelise& asked, const std::vector<Subject>& subjects,
                        std::vector<std::string>& findings) {
  const voxel::Universe universe = universe_of(bench, asked, subjects);
  std::vector<voxel::Octree> octrees;
  octrees.reserve(subjects.size());
  for (const Subject& subject : subjects)
    octrees.push_back(std::get<voxel::Octree>(voxelised(bench, asked, subject, universe)));
  const voxel::Lattice lattice = !asked.like ? lattice_of(universe, box_of(subjects)) : universe.lattice();
  const voxel::LabelMap map = voxel::label_map(lattice, octrees, {bench.stop, {}});
  if (map.overlaps > 0)
    findings.push_back(std::to_string(map.overlaps) +
                       " voxels lie in several meshes and have the label of the first of them");
  std::map<int, std::string> names;
  for (std::size_t i = 0; i < subjects.size(); ++i)
    names.emplace(static_cast<int>(i) + 1, subjects[i].path.stem().string());
  need_label_table(asked.out, names);
  {
    const Stopwatch watch(bench.timings, "write");
    voxel::write_scene(map.scene, asked.out);
    for (std::string& finding : write_label_table(asked.out, names)) findings.push_back(std::move(finding));
  }
  Json json{{"kind", "label map"}, {"path", asked.out.string()}};
  json["dims"] = {lattice.dims.x, lattice.dims.y, lattice.dims.z};
  json["spacing_mm"] = to_json(lattice.spacing_mm());
  std::vector<std::pair<std::string, std::string>> rows = {{"written", asked.out.string()}};
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    const std::uint64_t voxels = octrees[i].voxel_count();
    json["labels"].push_back({{"label", i + 1},
                              {"name", subjects[i].path.stem().string()},
                              {"voxels", voxels},
                              {"volume_mm3", static_cast<double>(voxels) * lattice.voxel_mm3()},
                              {"method", subjects[i].health.solid() ? "parity" : "winding number"}});
    rows.emplace_back(
        "label " + std::to_string(i + 1),
        subjects[i].path.stem().string() + ", " + grouped(static_cast<double>(voxels), 0) + " voxels");
  }
  json["overlaps"] = map.overlaps;
  for (const std::string& finding : findings) json["findings"].push_back(finding);
  return {std::move(json), std::move(rows), findings};
}

void check(const Voxelise& asked, const FieldLocation& place) {
  const bool labels = !is_octree(asked.out);
  if (place.scope != nullptr)
    check_output_path(asked.out, {".octree", ".nrrd", ".nii.gz", ".mha"}, place.at("path"));
  else if (labels && !voxel::volume_format(asked.out))
    need_octree_extension(asked.out);
  if (!labels && asked.meshes.size() > 1)
    place.at("path").refuse("an .octree can contain only one object: write several as a label map, .nrrd");
  if (labels && asked.digitise == "partial")
    place.at("digitise").refuse("a label map cannot store shares of voxels: write an .octree");
}

FileAnswer on_files(const Voxelise& asked, const FileBench& bench) {
  need_folder_of(asked.out);
  if (asked.like && asked.voxel_mm)
    throw std::runtime_error("--like already determines the voxels: leave --voxel out");
  std::vector<std::string> findings;
  std::vector<Subject> subjects;
  for (const ObjectName& path : asked.meshes)
    subjects.push_back(read_subject(bench, path.name, asked.digitise, findings));
  if (asked.like) add_findings_beside(*asked.like, subjects, bench.timings, findings);
  return is_octree(asked.out) ? write_octree(bench, asked, subjects.front(), findings)
                              : write_labels(bench, asked, subjects, findings);
}

}  // namespace

Operation voxelise_operation() {
  return Describe<Voxelise>("voxelise", "Makes an octree of a mesh, or a label map of several meshes.",
                            Makes::File)
      .takes(field("meshes", &Voxelise::meshes,
                   "Objects; on the command line mesh files (.stl, .ply, .obj, .vtp, .glb, ...). If one is "
                   "not a solid, the winding number bridges its holes and crossings.")
                 .required()
                 .from(1)
                 .positional("mesh"))
      .takes(field("path", &Voxelise::out,
                   "The output: an .octree file, or a label map as .nrrd, .nii.gz or .mha.")
                 .required()
                 .called("out"))
      .takes(field("voxel_mm", &Voxelise::voxel_mm,
                   "Edge of a voxel. Default: 1 mm; in a plan, that of the plan's universe.")
                 .greater_than(0.0))
      .verb_takes(field("like", &Voxelise::like,
                        "Uses the universe of this .octree file, so that both can be combined."))
      .takes(field("digitise", &Voxelise::digitise,
                   "Which voxels the object has: inside (D1), touching (D2), centre (D3), half (D4); or "
                   "partial, with the filled share of each.")
                 .one_of({"inside", "touching", "centre", "half", "partial"}))
      .example(R"({"id": "plate", "do": "voxelise", "meshes": ["skull"], "path": "plate.octree"})")
      .on_files(
          "octotomy voxelise maxilla.stl -o maxilla.octree --voxel 0.5\n"
          "  octotomy voxelise maxilla.stl mandible.stl -o jaws.nii.gz --voxel 0.5\n"
          "  octotomy voxelise plate.stl -o plate.octree --like skull.octree --digitise partial",
          on_files)
      .check(check)
      .write(write_step<Voxelise, on_files>);
}

}  // namespace octotomy::planner
