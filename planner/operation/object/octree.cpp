// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes an octree. The verb makes it from a scan's window or all its samples, or writes a file's octree in another
// form; the step writes that of an object.
#include <algorithm>
#include <array>
#include <fstream>

#include "convert/deck/deck.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/representation.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "planner/operation/table/plan_universe.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/codes/surface_tracking.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/expression.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/regular_file.h"
#include "voxel/space/write_whole.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

struct Build {
  ObjectName file;
  fs::path out;
  std::optional<SampleWindow> window;
  bool grey = false;
  std::optional<double> voxel_mm;
  std::string as, from;
  std::optional<int> depth, number;
  std::optional<glm::dvec3> seed_face_mm;
  int neighbours = 6;
  std::vector<ObjectName> with;  ///< the further objects of a multivalued code

  fs::path in() const { return file.name; }
  std::vector<std::string> inputs() const {
    std::vector<std::string> names{file.name};
    for (const ObjectName& object : with) names.push_back(object.name);
    return names;
  }
};

voxel::Octree windowed(const voxel::GreyOctree& grey, const SampleWindow& window) {
  return voxel::combine(grey.universe(), voxel::Expression(window_on(grey, window)));
}

std::string content_of(const fs::path& path) {
  voxel::need_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  std::string content(std::istreambuf_iterator<char>(stream), {});
  if (!stream && !stream.eof()) throw std::runtime_error(path.string() + ": cannot be read");
  return content;
}

voxel::OctreeFile from_representation(const Build& asked, Timings& timings) {
  if (!asked.depth)
    throw std::runtime_error(
        "--depth is missing, because a representation does not state its universe: add --depth N for 2^N "
        "voxels a side");
  voxel::Universe universe;
  universe.depth = *asked.depth;
  const double edge_mm = asked.voxel_mm.value_or(1.0);
  for (int axis = 0; axis < 3; ++axis) universe.lps_from_voxel[axis][axis] = edge_mm;
  std::string content;
  {
    const Stopwatch watch(timings, "read");
    content = content_of(asked.in());
  }
  const Stopwatch watch(timings, "octree");
  try {
    return {octree_of_representation(universe, asked.from, content, asked.number.value_or(1)),
            asked.in().stem().string(), ""};
  } catch (const voxel::InvalidInput& error) {
    throw std::runtime_error(asked.file.name + ": " + error.what());
  }
}

voxel::OctreeFile from_octree(const FileBench& bench, const Build& asked) {
  voxel::OctreeFile file = octree_named(asked.file.name, bench);
  if (!asked.window) return file;
  const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree);
  if (grey == nullptr)
    throw std::runtime_error(asked.file.name +
                             ": contains no samples, so --window does not apply: leave it out");
  const Stopwatch watch(bench.timings, "octree");
  return {windowed(*grey, *asked.window), file.name, file.metadata};
}

voxel::OctreeFile from_scan(const FileBench& bench, const Build& asked) {
  if (is_mesh(asked.in()))
    throw std::runtime_error(asked.file.name + ": is a mesh: make an octree of it by octotomy voxelise");
  if (!asked.window && !asked.grey)
    throw std::runtime_error(asked.file.name +
                             ": is a scan: choose --window LOW:HIGH for an object, for example "
                             "--window 300:, or --grey for all samples");
  const std::optional<SampleWindow>& window = asked.window;
  const voxel::Scene scene = bench.read_scan(asked.in());
  if (window) need_hounsfield(*window, scene);
  const Stopwatch watch(bench.timings, "octree");
  const voxel::Universe universe = universe_of(scene, asked.voxel_mm);
  const voxel::GreyOctree grey =
      voxel::grey_octree_of(universe, scene, voxel::beyond_scan, bench.progress("octree"));
  Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
            {"scan", asked.in().filename().string()},
            {"unit", voxel::unit(scene)},
            {"modality", scene.modality},
            {"scan_audit", doubts_of(scene.audit)}};
  if (window) made["window"] = {window->low, window->high ? Json(*window->high) : Json(nullptr)};
  const std::string name = asked.in().stem().string();
  if (!window) return {grey, name, json_text(made)};
  return {windowed(grey, *window), name, json_text(made)};
}

/// The connected surface that contains the face nearest to the seed, as lists of faces. Adds its numbers to
/// the answer.
std::string tracked(const Build& asked, const voxel::Octree& octree, Json& json) {
  const glm::dvec3 p_mm = *asked.seed_face_mm;
  const std::optional<voxel::SurfaceFace> seed =
      voxel::nearest_face(octree, octree.universe().lattice().voxel(p_mm), 1.5);
  if (!seed)
    throw std::runtime_error(
        asked.file.name + ": no face of the surface lies within one and a half voxels of " + plain(p_mm.x) +
        "," + plain(p_mm.y) + "," + plain(p_mm.z) + " mm: choose a point on the surface");
  const voxel::TrackedSurface surface = voxel::track_surface(
      octree, *seed, asked.neighbours == 6 ? voxel::Joined::ByFaces : voxel::Joined::ByEdges);
  json["seed_face"] = {{"voxel", {seed->voxel.x, seed->voxel.y, seed->voxel.z}},
                       {"direction", voxel::name_of(seed->direction)}};
  json["faces"] = surface.faces.face_count();
  json["faces_of_all"] = voxel::cuberille_faces(octree).face_count();
  json["enclosed_voxels"] = surface.enclosed_voxels;
  return voxel::text(surface.faces);
}

const voxel::Octree& binary_of(const Build& asked, const std::string& name, const voxel::OctreeFile& file) {
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(
        name + ": only a binary octree can be written as " + asked.as +
        (std::holds_alternative<voxel::GreyOctree>(file.tree)
             ? ": choose an object by --window LOW:HIGH"
             : ": this octree stores fractions, so digitise the object as centre or half"));
  return *octree;
}

/// The first object, and further objects in the same universe.
std::vector<voxel::Octree> objects_of(const FileBench& bench, const Build& asked,
                                      const voxel::OctreeFile& file) {
  std::vector<voxel::Octree> objects{binary_of(asked, asked.file.name, file)};
  for (const ObjectName& other : asked.with) {
    if (!names_octree(other.name, bench))
      throw std::runtime_error("--with: " + other.name + ": is not an .octree file");
    objects.push_back(binary_of(asked, other.name, octree_named(other.name, bench)));
    if (objects.back().universe() != objects.front().universe())
      throw std::runtime_error("--with: " + other.name + ": its universe differs from that of " +
                               asked.file.name +
                               ": make both from the same scan, or one of them by octotomy mask --like");
  }
  return objects;
}

FileAnswer export_as(const FileBench& bench, const Build& asked, const voxel::OctreeFile& file) {
  Timings& timings = bench.timings;
  const std::vector<voxel::Octree> objects = objects_of(bench, asked, file);
  std::string content;
  Json of_surface = Json::object();
  {
    const Stopwatch watch(timings, "represent");
    content =
        asked.seed_face_mm ? tracked(asked, objects.front(), of_surface) : represented(objects, asked.as);
  }
  if (bench.stop.stop_requested())
    throw voxel::Stopped("stopped before " + asked.out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_whole(asked.out, content);
  }
  Json json = octree_answer(file, std::nullopt, timings);
  json["path"] = asked.out.string();
  json["as"] = asked.as;
  json["bytes_representation"] = content.size();
  if (!asked.with.empty()) json["objects"] = objects.size();
  FileAnswer answer{std::move(json),
                    {{"written", asked.out.string()},
                     {"form", asked.as},
                     {"depth", std::to_string(objects.front().universe().depth)},
                     {"bytes", std::to_string(content.size())}}};
  if (asked.seed_face_mm) {
    answer.rows.emplace_back("faces",
                             of_surface["faces"].dump() + " of " + of_surface["faces_of_all"].dump());
    answer.rows.emplace_back("enclosed voxels", of_surface["enclosed_voxels"].dump());
    answer.json["tracked"] = std::move(of_surface);
  }
  return answer;
}

/// Throws if the output has the extension of another kind of file. Representations have no extension of their
/// own, and such an extension is a typing error that would replace a scan or a result.
void need_form_name(const Build& asked) {
  constexpr std::array others{".json", ".csv", ".dcm",  ".png", ".jpg", ".jpeg",
                              ".webp", ".glb", ".html", ".svg", ".pdf"};
  if (!is_mesh(asked.out) && !is_octree(asked.out) && !voxel::volume_format(asked.out) &&
      !convert::is_deck(asked.out) &&
      std::find(others.begin(), others.end(), voxel::extension_of(asked.out)) == others.end())
    return;
  throw std::runtime_error(asked.out.string() + ": has the extension of another kind of file: for the form " +
                           asked.as + " use .txt, or an extension of no known kind, such as ." + asked.as);
}

void check(const Build& asked, const FieldLocation& place) {
  if (asked.neighbours != 6 && asked.neighbours != 18)
    place.at("neighbours").refuse("must be 6 (faces) or 18 (edges)");
  if (place.scope == nullptr) return;
  if (!asked.as.empty()) need_form_name(asked);
  check_output_path(asked.out, {asked.as.empty() ? ".octree" : asked.out.extension().string()},
                    place.at("path"));
}

FileAnswer on_files(const Build& asked, const FileBench& bench) {
  asked.as.empty() ? need_octree_extension(asked.out) : need_form_name(asked);
  if (asked.window && asked.grey)
    throw std::runtime_error(
        "--grey and --window exclude each other: an octree has either all samples or an object");
  need_folder_of(asked.out);
  const voxel::OctreeFile file = !asked.from.empty() ? from_representation(asked, bench.timings)
                                 : names_octree(asked.file.name, bench) ? from_octree(bench, asked)
                                                                        : from_scan(bench, asked);
  return asked.as.empty() ? octree_written(file, asked.out, bench.stop, bench.timings)
                          : export_as(bench, asked, file);
}

}  // namespace

Operation octree_operation() {
  return Describe<Build>("octree",
                         "Builds an octree of a scan's window or of all its samples, or converts an octree "
                         "to another form.",
                         Makes::File)
      .takes(
          field("object", &Build::file,
                "The object; on the command line a scan, an .octree file, or with --from a representation.")
              .required()
              .positional("file"))
      .takes(field("path", &Build::out,
                   "An .octree file, or with --as a file of the representation, for example .txt.")
                 .required()
                 .called("out"))
      .verb_takes(
          field("window", &Build::window,
                "Makes a binary octree of these samples: LOW:HIGH or LOW: in sample units, or a tissue.")
              .read_if<Build>([](const Build& build) { return build.from.empty(); },
                              "does not apply to a representation, which has no samples: leave it out"))
      .verb_takes(
          field("grey", &Build::grey, "Makes a min-max octree of all samples.")
              .read_if<Build>([](const Build& build) { return build.from.empty() && !is_octree(build.in()); },
                              "applies only to a scan, which has samples: leave it out"))
      .verb_takes(field("voxel_mm", &Build::voxel_mm,
                        "Edge of a voxel. Default: the scan's finest spacing, with at most 512 voxels a "
                        "side; with --from 1.")
                      .greater_than(0.0)
                      .read_if<Build>(
                          [](const Build& build) { return !build.from.empty() || !is_octree(build.in()); },
                          "does not apply to an .octree file, which already has voxels: leave it out"))
      .takes(field("as", &Build::as,
                   "Writes one of these representations: as text treecode, linear, explicit, masked, bitree, "
                   "multivalued, runs, segments, marginal, faces or array; as bytes packed or bits.")
                 .one_of(representation_names()))
      .takes(field("with", &Build::with,
                   "For a multivalued code: further objects, numbered from 2, in the universe of the first.")
                 .repeated()
                 .read_if<Build>([](const Build& build) { return build.as == "multivalued"; },
                                 "applies only to multivalued codes: add 'as' multivalued"))
      .takes(field("seed_face_mm", &Build::seed_face_mm,
                   "Writes only the connected surface that contains the face nearest to this point, LPS: "
                   "that of one part without its cavities, or that of one cavity.")
                 .read_if<Build>([](const Build& build) { return build.as == "faces"; },
                                 "applies only to lists of faces: add 'as' with faces"))
      .takes(field("neighbours", &Build::neighbours,
                   "Whether voxels of that surface are connected by faces (6) or also by edges (18).")
                 .read_if<Build>([](const Build& build) { return build.seed_face_mm.has_value(); },
                                 "needs 'seed_face_mm': add it"))
      .verb_takes(field("from", &Build::from, "Reads the file as this representation.")
                      .one_of(representation_names()))
      .verb_takes(
          field("depth", &Build::depth, "With --from: the universe has 2^N voxels a side.")
              .from(2)
              .to(voxel::Universe::max_depth)
              .read_if<Build>([](const Build& build) { return !build.from.empty(); }, "needs 'from': add it"))
      .verb_takes(field("number", &Build::number,
                        "The number of the object that is read from a multivalued code. Default: 1.")
                      .from(1)
                      .to(254)
                      .read_if<Build>([](const Build& build) { return build.from == "multivalued"; },
                                      "applies only to multivalued codes: add 'from' multivalued"))
      .reads_scans()
      .example(R"({"id": "tree", "do": "octree", "object": "skull", "path": "skull.octree"})")
      .on_files(
          "octotomy octree head.nrrd -o skull.octree --window 300:\n"
          "  octotomy octree skull.octree -o skull.txt --as linear\n"
          "  octotomy octree skull.octree -o outside.txt --as faces --seed-face 0,-62,10\n"
          "  octotomy octree skull.txt -o skull.octree --from linear --depth 8",
          on_files)
      .check(check)
      .write(write_step<Build, on_files>);
}

}  // namespace octotomy::planner
