// SPDX-License-Identifier: AGPL-3.0-or-later
// Tetrahedra of one closed mesh, or of octrees. The verb reads files, the step fills objects. The step `deck` fills
// several objects together, with materials of their scan and motions of the plan.
#include <algorithm>
#include <cmath>

#include "brep/mesh/components.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/split_fans.h"
#include "convert/deck/deck.h"
#include "convert/deck/second_order.h"
#include "convert/tet/hinges.h"
#include "convert/tet/octree_tetrahedra.h"
#include "convert/tet/region_tetrahedra.h"
#include "convert/tet/separate_regions.h"
#include "convert/tet/tetrahedralise.h"
#include "convert/voxel/voxelise.h"
#include "convert/voxel/winding_number.h"
#include "planner/operation/deck/filling.h"
#include "planner/operation/deck/node_sets.h"
#include "planner/operation/deck/stiffness.h"
#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Tet {
  ObjectName file;
  std::filesystem::path out, landmarks;
  std::string mesher = "best";
  double dihedral_deg = convert::TetOptions{}.min_dihedral_deg,
         radius_edge = convert::TetOptions{}.radius_edge;
  std::optional<double> max_volume_mm3, voxel_mm, size_mm;
  std::vector<std::string> finer, nodes, fixed, moved;
  bool refine_boundary = false, mend = false, fallback = false, contact = false, msh_2_2 = false;
  double seconds = 60.0;
  std::vector<ObjectName> regions;
  int order = 1;
  std::filesystem::path scan;
  Stiffness stiffness;  ///< of that scan
  /// Only in plans: fills the object's octree instead of its mesh. The verb does so for an .octree file.
  bool of_voxels = false;

  std::vector<std::string> inputs() const {
    std::vector<std::string> names{file.name};
    for (const ObjectName& region : regions) names.push_back(region.name);
    return names;
  }
  bool is_of_voxels(const FileBench& bench) const {
    return bench.step != nullptr ? of_voxels : is_octree(file.name);
  }
};

/// The places of --finer, each WHERE=SIZE; WHERE is a point, a landmark's name or a mesh file.
std::vector<convert::Refinement> refinements(const Tet& asked) {
  std::vector<brep::Landmark> landmarks;
  if (!asked.landmarks.empty()) landmarks = read_landmarks(asked.landmarks);
  std::vector<convert::Refinement> places;
  for (const std::string& word : asked.finer) {
    const std::size_t equals = word.rfind('=');
    const std::vector<double> size_mm =
        equals == std::string::npos ? std::vector<double>{} : comma_numbers(word.substr(equals + 1));
    if (size_mm.size() != 1 || size_mm[0] <= 0.0)
      throw std::runtime_error("--finer: '" + word +
                               "' states no size: for example 12,-80,4=0.5 or cut.stl=0.5");
    const std::string where = word.substr(0, equals);
    const auto landmark = std::find_if(landmarks.begin(), landmarks.end(),
                                       [&](const brep::Landmark& known) { return known.name == where; });
    convert::Refinement place;
    place.size_mm = size_mm[0];
    if (landmark != landmarks.end())
      place.points_mm = {landmark->p_mm};
    else if (const std::vector<double> p = comma_numbers(where); p.size() == 3)
      place.points_mm = {{p[0], p[1], p[2]}};
    else if (std::filesystem::exists(where))
      place.surface = read_mesh_in(where);
    else
      throw std::runtime_error("--finer: '" + where +
                               "' is none of these: a point x,y,z, a landmark of --landmarks, a mesh file");
    places.push_back(std::move(place));
  }
  return places;
}

convert::TetOptions options_of(const Tet& asked, const FileBench& bench) {
  convert::TetOptions options;
  options.min_dihedral_deg = asked.dihedral_deg;
  options.radius_edge = asked.radius_edge;
  options.keep_boundary = !asked.refine_boundary;
  options.max_volume_mm3 = asked.max_volume_mm3;
  options.mesher = asked.mesher == "tetgen"     ? convert::Mesher::TetGen
                   : asked.mesher == "mesh3"    ? convert::Mesher::Mesh3
                   : asked.mesher == "stuffing" ? convert::Mesher::Stuffing
                                                : convert::Mesher::Best;
  options.finer = refinements(asked);
  options.time_limit = std::chrono::seconds(static_cast<long>(asked.seconds));
  options.progress = bench.progress("filling, of the time allowed");
  return options;
}

/// The elements of a deck, and how they were made.
struct TetResult {
  convert::Tetrahedra tetrahedra;
  std::size_t regions = 1;
  std::optional<std::string> fallback;  ///< the reason why the elements are voxels of an octree; none if they
                                        ///< are not
  std::vector<std::string> findings;
};

/// The edge of voxels of which a solid contains about 200 000.
double fallback_voxel_mm(double volume_mm3) {
  return std::cbrt(volume_mm3 / 200000.0);
}

voxel::Octree voxels_of(const Tet& asked, const brep::Triangles& triangles, bool solid) {
  voxel::Box box{triangles.points_mm.front(), triangles.points_mm.front()};
  for (const glm::dvec3& p : triangles.points_mm) {
    box.low_mm = glm::min(box.low_mm, p);
    box.high_mm = glm::max(box.high_mm, p);
  }
  const glm::dvec3 extent = box.high_mm - box.low_mm;
  const double volume_mm3 = solid ? brep::size_of(triangles).volume_mm3 : extent.x * extent.y * extent.z;
  const voxel::Universe universe =
      voxel::universe_around(box, asked.voxel_mm.value_or(fallback_voxel_mm(volume_mm3)));
  return solid ? convert::voxelise(universe, brep::linked(triangles))
               : convert::voxelise_by_winding_number(universe, brep::joined_surface(triangles).surface);
}

/// Makes the elements by `make`. With --fallback, stores the reason if this fails or if shapes are unfit.
/// Without --fallback, throws if it fails, and keeps unfit elements with a finding.
void fill(const Tet& asked, bool is_of_voxels, TetResult& filled,
          const std::function<convert::Tetrahedra()>& make) {
  try {
    filled.tetrahedra = make();
    filled.findings = filled.tetrahedra.findings;
    const std::optional<std::string> unfit = convert::fault_in_shape(filled.tetrahedra);
    if (!unfit) return;
    if (asked.fallback)
      filled.fallback = unfit;
    else
      filled.findings.push_back(*unfit + (is_of_voxels
                                              ? ": state another --size, or add --fallback"
                                              : ": mend or simplify the surface, or add --fallback"));
  } catch (const std::exception& error) {
    if (fault_of(error) == Fault::Cancelled)
      throw voxel::Stopped("stopped before " + asked.out.string() + " was written");
    if (!is_no_answer(error)) throw;
    if (!asked.fallback)
      throw voxel::Error(static_cast<voxel::ErrorCode>(fault_of(error)),
                         std::string(error.what()) + "; or take --fallback");
    filled.fallback = error.what();
  }
}

/// Replaces the elements by the voxels of an octree; the only finding states the reason.
void fall_back(TetResult& filled, convert::Tetrahedra tetrahedra, const voxel::Universe& universe) {
  filled.tetrahedra = std::move(tetrahedra);
  filled.findings = {"fallback: " + *filled.fallback +
                     "; the elements are voxels of an octree, whose surface has steps of " +
                     grouped(universe.lattice().spacing_mm().x, 3) +
                     " mm: do not read stresses at the surface"};
}

/// A mesh and its health. It is a solid unless --fallback allows other meshes.
struct CheckedMesh {
  brep::Triangles triangles;
  brep::Health health;
};

/// Reads and checks the mesh. Appends findings on its mending.
CheckedMesh checked_mesh(const FileBench& bench, const Tet& asked, std::vector<std::string>& findings) {
  CheckedMesh surface;
  if (asked.mend) {
    const voxel::Progress progress = bench.progress("repair");
    surface.triangles = brep::triangles_of(
        read_mended_solid(asked.file.name, bench.timings, findings, {progress.stop, progress.report}));
  } else {
    const Stopwatch watch(bench.timings, "read");
    surface.triangles = triangles_named(asked.file.name, bench);
  }
  if (surface.triangles.faces.empty()) throw std::runtime_error(asked.file.name + ": holds no triangles");
  const Stopwatch watch(bench.timings, "health");
  surface.health = brep::health(surface.triangles);
  if (!surface.health.solid() && !asked.fallback)
    throw std::runtime_error(
        asked.file.name + ": is not a solid: " + surface.health.findings.front() +
        "; octotomy info lists all defects; mend it with --mend, or fill it with voxels by --fallback");
  return surface;
}

TetResult of_mesh(const FileBench& bench, const Tet& asked) {
  std::vector<std::string> mended;
  const CheckedMesh surface = checked_mesh(bench, asked, mended);
  const auto& [triangles, health] = surface;
  TetResult filled;
  const Stopwatch watch(bench.timings, "tetrahedralise");
  if (health.solid()) {
    const brep::Mesh solid = brep::mesh_of(triangles);
    filled.regions = brep::components(solid).size();
    fill(asked, false, filled, [&] { return convert::tetrahedralise(solid, options_of(asked, bench)); });
  } else {
    filled.fallback = "the mesh is not a solid (" + health.findings.front() + ")";
  }
  if (filled.fallback) {
    const voxel::Octree octree = voxels_of(asked, triangles, health.solid());
    if (octree.is_empty())
      throw std::runtime_error(asked.file.name + ": encloses no voxel: state a smaller size by --voxel");
    fall_back(filled,
              convert::tetrahedra_of(octree, convert::BoundaryCells::Nodes, bench.progress("elements")),
              octree.universe());
  }
  filled.findings.insert(filled.findings.begin(), mended.begin(), mended.end());
  return filled;
}

voxel::Octree octree_in(const std::string& name, const FileBench& bench) {
  voxel::OctreeFile file = octree_named(name, bench);
  auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(
        name + ": only a binary octree can be filled: make a surface of it by octotomy mesh and fill that");
  return std::move(*octree);
}

/// Fills an octree and its further regions: with smooth elements if a size is requested, else with their
/// voxels.
TetResult of_octrees(const FileBench& bench, const Tet& asked) {
  std::vector<voxel::Octree> octrees;
  for (const std::string& name : asked.inputs()) octrees.push_back(octree_in(name, bench));
  TetResult filled;
  filled.regions = octrees.size();
  const Stopwatch watch(bench.timings, "tetrahedralise");
  if (asked.size_mm) {
    convert::RegionMeshOptions options;
    options.size_mm = *asked.size_mm;
    const convert::TetOptions common = options_of(asked, bench);
    options.min_dihedral_deg = common.min_dihedral_deg;
    options.finer = common.finer;
    options.time_limit = common.time_limit;
    options.progress = common.progress;
    fill(asked, true, filled, [&] { return convert::smooth_tetrahedra_of(octrees, options); });
  } else {
    filled.fallback = "smooth elements of an octree need a --size, which is missing";
  }
  if (filled.fallback)
    fall_back(filled,
              convert::tetrahedra_of(octrees, convert::BoundaryCells::Nodes, bench.progress("elements")),
              octrees.front().universe());
  return filled;
}

convert::DeckOptions deck_of(const FileBench& bench, const Tet& asked, TetResult& filled,
                             const convert::TetQuality& quality) {
  convert::DeckOptions deck;
  deck.title = std::filesystem::path(asked.file.name).filename().string();
  deck.msh_2_2 = asked.msh_2_2;
  deck.second_order = asked.order == 2;
  deck.surfaces = {{"SKIN", convert::surface_faces(filled.tetrahedra)}};
  const auto name = [](std::uint32_t from, std::uint32_t to) {
    return "REGION" + std::to_string(from + 1) + "_TO_REGION" + std::to_string(to + 1);
  };
  for (convert::Interface& between : convert::interfaces(filled.tetrahedra)) {
    const std::string there = name(between.from, between.to), back = name(between.to, between.from);
    deck.surfaces.push_back({there, std::move(between.faces)});
    if (!asked.contact) continue;
    deck.surfaces.push_back({back, std::move(between.opposite)});
    deck.contacts.push_back({there, back, there});
  }
  if (asked.contact) filled.tetrahedra = convert::separate_regions(filled.tetrahedra);
  std::vector<brep::Landmark> landmarks;
  if (!asked.landmarks.empty()) landmarks = read_landmarks(asked.landmarks);
  deck.node_sets = picked_node_sets(asked.nodes, landmarks, filled.tetrahedra);
  deck.prescribed = prescribed_of(asked.fixed, asked.moved, deck.node_sets);
  deck.notes = {std::string("octotomy ") + OCTOTOMY_VERSION};
  for (std::string& note : quality_notes(quality)) deck.notes.push_back(std::move(note));
  for (const std::string& finding : filled.findings) deck.notes.push_back(finding);
  if (asked.scan.empty()) return deck;
  const voxel::Scene scan = bench.read_scan(asked.scan);
  const Stopwatch watch(bench.timings, "materials");
  for (const std::string& finding : add_stiffness(asked.stiffness, filled.tetrahedra, glm::dmat4(1.0), scan,
                                                  bench.progress("materials"), deck)) {
    deck.notes.push_back(finding);
    filled.findings.push_back(finding);
  }
  return deck;
}

void check(const Tet& asked, const FieldLocation& place) {
  if (place.scope == nullptr) return;
  check_output_path(asked.out, {".inp", ".feb", ".vtu", ".msh", ".node"}, place.at("path"));
  if (!asked.of_voxels && (!asked.regions.empty() || asked.size_mm || asked.contact))
    place.refuse("'regions', 'size_mm' and 'contact' apply only to voxels: add 'of_voxels' true");
}

FileAnswer on_files(const Tet& asked, const FileBench& bench) {
  const bool of_voxels = asked.is_of_voxels(bench);
  if (!convert::is_deck(asked.out))
    throw std::runtime_error(asked.out.string() + ": a deck is written as " + convert::deck_extensions());
  need_folder_of(asked.out);
  convert::need_own_deck_files(asked.out);
  if (!of_voxels && (!asked.regions.empty() || asked.size_mm || asked.contact))
    throw std::runtime_error("--region, --size and --contact apply only to octrees: make an octree of " +
                             asked.file.name + " by octotomy voxelise");
  refinements(asked);
  check_set_names(asked.nodes);
  if (!asked.finer.empty() && of_voxels && !asked.size_mm)
    throw std::runtime_error("--finer applies only to smooth elements: add --size");
  TetResult filled = of_voxels ? of_octrees(bench, asked) : of_mesh(bench, asked);
  const convert::Tetrahedra& tetrahedra = filled.tetrahedra;
  if (std::optional<std::string> hinge = convert::hinge_in(tetrahedra))
    filled.findings.push_back(*std::move(hinge));
  const convert::TetQuality quality = convert::quality(tetrahedra);
  convert::DeckOptions deck = deck_of(bench, asked, filled, quality);
  if (bench.stop.stop_requested())
    throw voxel::Stopped("stopped before " + asked.out.string() + " was written");
  {
    const Stopwatch watch(bench.timings, "write");
    deck.progress = bench.progress("writing");
    convert::write_deck(tetrahedra, asked.out, deck);
  }
  // The counts of the written deck. Elements of order 2 have nodes that the linear elements lack.
  std::size_t nodes = tetrahedra.nodes_mm.size();
  std::vector<convert::NodeSet> written_sets = deck.node_sets;
  if (asked.order == 2) {
    convert::SecondOrder written = convert::second_order(tetrahedra, deck);
    nodes = written.tetrahedra.nodes_mm.size();
    written_sets = std::move(written.options.node_sets);
  }
  Json node_sets = Json::object();
  for (const convert::NodeSet& set : written_sets) node_sets[set.name] = set.nodes.size();
  FileAnswer answer{{{"path", asked.out.string()},
                     {"nodes", nodes},
                     {"tets", tetrahedra.tets.size()},
                     {"regions", filled.regions},
                     {"volume_mm3", quality.volume_mm3},
                     {"quality", quality_json(quality)},
                     {"order", asked.order},
                     {"method", tetrahedra.method},
                     {"fallback", filled.fallback.has_value()},
                     {"materials", deck.materials.size()},
                     {"node_sets", node_sets},
                     {"findings", filled.findings}}};
  answer.findings = filled.findings;
  answer.rows = {{"written", asked.out.string()},
                 {"made by", tetrahedra.method},
                 {"tetrahedra", grouped(static_cast<double>(tetrahedra.tets.size()), 0)},
                 {"dihedral", grouped(quality.min_dihedral_deg, 1) + " to " +
                                  grouped(quality.max_dihedral_deg, 1) + " degrees"}};
  return answer;
}

}  // namespace

Operation tet_operation() {
  return Describe<Tet>("tet", "Fills a solid with quality tetrahedra for finite elements.", Makes::File)
      .takes(field("object", &Tet::file,
                   "The object; on the command line a closed mesh, or a binary .octree file.")
                 .required()
                 .positional("file"))
      .takes(
          field("path", &Tet::out,
                "A deck: .inp (Abaqus, CalculiX), .feb (FEBio 4), .vtu, .msh (Gmsh 4.1) or .node (TetGen).")
              .required()
              .called("out"))
      .takes(
          field("mesher", &Tet::mesher,
                "tetgen keeps the surface. mesh3 (CGAL) makes a new surface, off the given one by at most a "
                "tenth of a triangle's size. stuffing cuts a lattice's cells at the surface: angles above 10 "
                "degrees, but parts thinner than a cell are lost. best: tetgen; mesh3 where angles stay "
                "below --dihedral; stuffing where they stay below 5 degrees.")
              .one_of({"tetgen", "mesh3", "stuffing", "best"}))
      .takes(
          field("dihedral_deg", &Tet::dihedral_deg, "Smallest dihedral angle to reach.").from(0.0).to(30.0))
      .takes(field("radius_edge", &Tet::radius_edge,
                   "TetGen's largest ratio of circumradius to shortest edge; 1.2 is hard, 2 is easy.")
                 .from(1.1)
                 .to(10.0))
      .takes(field("max_volume_mm3", &Tet::max_volume_mm3, "Largest tetrahedron.").greater_than(0.0))
      .verb_takes(field("finer", &Tet::finer,
                        "WHERE=MM: elements with sides of about MM millimetres at a point x,y,z, at a "
                        "landmark or along a mesh file's surface. Sizes grow with the distance from there. "
                        "Places deep inside take effect only with --size; may be repeated.")
                      .repeated())
      .verb_takes(field("nodes", &Tet::nodes,
                        "NAME=WHERE: a set of surface nodes at a point x,y,z or a landmark, within a ball "
                        "x,y,z,r, on a plane x,y,z,u,v,w through a point with a normal, or on a mesh file's "
                        "surface; may be repeated.")
                      .repeated())
      .verb_takes(field("fixed", &Tet::fixed,
                        "A set of --nodes that stays fixed in the deck's static step; may be repeated.")
                      .repeated()
                      .called("fix"))
      .verb_takes(field("moved", &Tet::moved,
                        "NAME=DX,DY,DZ: a set of --nodes that moves by DX, DY, DZ mm in the deck's static "
                        "step; may be repeated.")
                      .repeated()
                      .called("move"))
      .verb_takes(field("landmarks", &Tet::landmarks,
                        "File of the landmarks that --finer and --nodes name: JSON, or 3D Slicer's markups.")
                      .a_file())
      .takes(field("refine_boundary", &Tet::refine_boundary,
                   "Lets TetGen add points on the surface; by default it is kept as it is."))
      .takes(field("seconds", &Tet::seconds, "Processor time that each run of a mesher may take.")
                 .from(1.0)
                 .to(86400.0))
      .verb_takes(
          field("mend", &Tet::mend, "Mends a mesh that is not a solid first, as repair --solid does."))
      .takes(field("fallback", &Tet::fallback,
                   "If the meshers fail or leave flat elements, or the mesh is not a solid, fills it with "
                   "voxels of an octree; the answer states this."))
      .takes(field("voxel_mm", &Tet::voxel_mm,
                   "Edge of the octree's voxels for --fallback. Default: so that the solid has about 200 000 "
                   "voxels.")
                 .greater_than(0.0))
      .takes(field("regions", &Tet::regions,
                   "A further octree of the same universe, filled as a separate region; may be repeated.")
                 .repeated()
                 .called("region"))
      .takes(field("of_voxels", &Tet::of_voxels, "Fills the object's voxels instead of its mesh.")
                 .in_plans_only())
      .takes(field("size_mm", &Tet::size_mm,
                   "Fills octrees with smooth elements of about this size. Default: their voxels become the "
                   "elements.")
                 .greater_than(0.0))
      .takes(
          field("contact", &Tet::contact,
                "Regions have separate nodes and contact pairs where they touch. Default: they share nodes."))
      .takes(
          field("order", &Tet::order, "1: four-node tetrahedra; 2: ten-node ones, with a node on each side.")
              .from(1)
              .to(2))
      .takes(field("msh_2_2", &Tet::msh_2_2, "Writes .msh in Gmsh's version 2.2.").called("msh2"))
      .verb_takes(field("scan", &Tet::scan, "A scan in HU from which each element's stiffness is computed."))
      .verb_takes(&Tet::stiffness, stiffness_fields())
      .reads_scans()
      .example(
          R"({"id": "deck", "do": "tet", "object": "maxilla", "mesher": "mesh3", "path": "maxilla.inp"})")
      .on_files(
          "octotomy tet maxilla.stl -o maxilla.inp --radius-edge 1.4 --json\n"
          "  octotomy tet scan.vtp --mend -o scan.inp\n"
          "  octotomy tet plate.stl -o plate.inp --nodes CUT=0,0,-40,0,0,1 --nodes PIN=12,-80,4,3 --fix CUT "
          "--move PIN=0,0,-0.5\n"
          "  octotomy tet maxilla.stl -o maxilla.inp --finer 12,-80,4=0.5 --finer plate.stl=0.8\n"
          "  octotomy tet maxilla.octree --region rest.octree --size 3 --contact -o head.inp\n"
          "  octotomy tet maxilla.stl -o maxilla.feb --scan head.nrrd --density 0.0009,0.05",
          on_files)
      .check(check)
      .write(write_step<Tet, on_files>);
}

}  // namespace octotomy::planner
