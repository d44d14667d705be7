// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/voxelise.h"

#include "brep/io/read_mesh.h"
#include "brep/mesh/health.h"
#include "convert/voxel/voxelise_partial.h"
#include "convert/voxel/winding_number.h"
#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/volume_header.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner::cli {
namespace {

struct VoxeliseText {
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path out, like;
  double voxel_mm = 1.0;
  std::string digitise = "centre";
};

struct Subject {
  std::filesystem::path path;
  brep::Triangles triangles;
  brep::Health health;
};

/// Throws where it holds no triangles, or is to be shared out exactly and is no solid; tells what is guessed.
Subject read_subject(const std::filesystem::path& path, const std::string& digitise, Timings& timings,
                     std::vector<std::string>& findings) {
  Subject subject{path, {}, {}};
  {
    const Stopwatch watch(timings, "read");
    subject.triangles = brep::read_triangles(path);
  }
  if (subject.triangles.faces.empty()) throw std::runtime_error(path.string() + ": holds no triangles");
  {
    const Stopwatch watch(timings, "health");
    subject.health = brep::health(subject.triangles);
  }
  if (subject.health.solid()) return subject;
  if (digitise != "centre")
    throw std::runtime_error(path.string() + ": is not a solid (" + subject.health.findings.front() +
                             "), so that the share of a voxel it fills is not known: mend it, or take the "
                             "voxels' centres by --digitise centre");
  findings.push_back("method: " + path.string() + " is not a solid (" + subject.health.findings.front() +
                     "); voxels are those about whose centre it winds more than a half (generalised winding "
                     "number), which guesses across holes");
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

voxel::Universe universe_of(const VoxeliseText& text, const std::vector<Subject>& subjects,
                            Timings& timings) {
  if (!text.like.empty()) return voxel::universe(read_timed(text.like, timings));
  try {
    return voxel::universe_around(box_of(subjects), text.voxel_mm);
  } catch (const std::length_error& error) {
    throw std::runtime_error(subjects.front().path.string() + ": " + error.what() +
                             ": is its unit millimetres? Give larger voxels by --voxel");
  }
}

decltype(voxel::OctreeFile::tree) of_solid(const voxel::Universe& universe, const brep::Mesh& solid,
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

decltype(voxel::OctreeFile::tree) voxelised(const Program& program, const VoxeliseText& text,
                                            const Subject& subject, const voxel::Universe& universe,
                                            Timings& timings) {
  const voxel::Progress progress{program.stop.get_token(), program.progress("voxelising")};
  const Stopwatch watch(timings, "voxelise");
  decltype(voxel::OctreeFile::tree) tree =
      subject.health.solid() ? of_solid(universe, brep::mesh_of(subject.triangles), text.digitise, progress)
                             : convert::voxelise_by_winding_number(universe, subject.triangles, progress);
  if (is_nothing(tree))
    throw std::runtime_error(subject.path.string() +
                             ": encloses no voxel: take smaller voxels by --voxel; where the mesh is inside "
                             "out, flip its triangles");
  return tree;
}

int write_octree(const Program& program, const VoxeliseText& text, const Subject& subject, Timings& timings,
                 const std::vector<std::string>& findings) {
  const voxel::Universe universe = universe_of(text, {subject}, timings);
  voxel::OctreeFile file{voxelised(program, text, subject, universe, timings), subject.path.stem().string(),
                         ""};
  file.metadata = Json{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                       {"mesh", subject.path.filename().string()},
                       {"digitise", text.digitise},
                       {"method", subject.health.solid() ? "parity" : "winding number"}}
                      .dump();
  return write_and_say(program, file, text.out, timings, findings);
}

/// The voxels of a universe that a box reaches, as a lattice of their own.
voxel::Lattice lattice_of(const voxel::Universe& universe, const voxel::Box& box) {
  voxel::Lattice lattice = universe.lattice();
  const glm::ivec3 last = lattice.dims - 1;
  const glm::ivec3 from = glm::clamp(glm::ivec3(glm::floor(lattice.voxel(box.low_mm))), glm::ivec3(0), last);
  const glm::ivec3 to = glm::clamp(glm::ivec3(glm::ceil(lattice.voxel(box.high_mm))), glm::ivec3(0), last);
  lattice.lps_from_voxel[3] = glm::dvec4(lattice.lps_mm(glm::dvec3(from)), 1.0);
  lattice.dims = to - from + 1;
  return lattice;
}

int write_labels(const Program& program, const VoxeliseText& text, const std::vector<Subject>& subjects,
                 Timings& timings, std::vector<std::string>& findings) {
  const voxel::Universe universe = universe_of(text, subjects, timings);
  std::vector<voxel::Octree> octrees;
  for (const Subject& subject : subjects)
    octrees.push_back(std::get<voxel::Octree>(voxelised(program, text, subject, universe, timings)));
  const voxel::Lattice lattice =
      text.like.empty() ? lattice_of(universe, box_of(subjects)) : universe.lattice();
  const voxel::LabelMap map = voxel::label_map(lattice, octrees, {program.stop.get_token(), {}});
  if (map.overlaps > 0)
    findings.push_back(std::to_string(map.overlaps) +
                       " voxels lie in several meshes: they have the first one's label");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_scene(map.scene, text.out);
  }
  Json json = answer(timings);
  json["kind"] = "label map";
  json["path"] = text.out.string();
  json["dims"] = {lattice.dims.x, lattice.dims.y, lattice.dims.z};
  json["spacing_mm"] = to_json(lattice.spacing_mm());
  std::vector<std::pair<std::string, std::string>> rows = {{"written", text.out.string()}};
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
  for (const std::string& finding : findings) {
    warn(finding);
    json["findings"].push_back(finding);
  }
  program.say(json, lines(rows));
  return done;
}

int voxelise(const Program& program, const VoxeliseText& text) {
  need_folder_of(text.out);
  const bool labels = !is_octree(text.out) && voxel::volume_format(text.out);
  if (!labels) need_octree_extension(text.out);
  if (!labels && text.meshes.size() > 1)
    throw CLI::ValidationError("--out", "an .octree holds one object: write several as a label map, .nrrd");
  if (labels && text.digitise == "partial")
    throw CLI::ValidationError("--digitise",
                               "a label map has no shares of voxels: write an .octree for those");
  Timings timings;
  std::vector<std::string> findings;
  std::vector<Subject> subjects;
  for (const auto& path : text.meshes)
    subjects.push_back(read_subject(path, text.digitise, timings, findings));
  return labels ? write_labels(program, text, subjects, timings, findings)
                : write_octree(program, text, subjects.front(), timings, findings);
}

}  // namespace

void add_voxelise(Program& program) {
  const auto text = std::make_shared<VoxeliseText>();
  CLI::App& verb =
      program.verb("voxelise", "Makes an octree of a mesh, or a label map of several",
                   "octotomy voxelise maxilla.stl -o maxilla.octree --voxel 0.5\n"
                   "  octotomy voxelise maxilla.stl mandible.stl -o jaws.nii.gz --voxel 0.5\n"
                   "  octotomy voxelise plate.stl -o plate.octree --like skull.octree --digitise partial",
                   [&program, text] { return voxelise(program, *text); });
  verb.add_option("mesh", text->meshes,
                  "One or more .stl, .ply, .obj, .off or .vtk files; where one is no solid, its holes and "
                  "crossings are "
                  "bridged by the winding number")
      ->required()
      ->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "An .octree file, or a label map: .nrrd, .nii.gz, .mha")->required();
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
