// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include "brep/io/read_mesh.h"
#include "brep/mesh/components.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "convert/deck/deck.h"
#include "convert/tet/octree_tetrahedra.h"
#include "convert/tet/region_tetrahedra.h"
#include "convert/tet/separate_regions.h"
#include "convert/tet/tetrahedralise.h"
#include "convert/voxel/voxelise.h"
#include "convert/voxel/winding_number.h"
#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/cli/scan_in.h"
#include "planner/deck/filling.h"
#include "planner/deck/stiffness.h"
#include "planner/file/landmarks_file.h"
#include "planner/file/mesh_file.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

struct TetText {
  std::filesystem::path in, out, scan;
  convert::TetOptions options;
  Stiffness stiffness;
  std::string mesher = "best";
  std::optional<double> max_volume_mm3, voxel_mm, size_mm;
  std::vector<std::filesystem::path> regions;
  std::vector<std::string> finer;
  std::filesystem::path landmarks;
  bool contact = false;
  double seconds = 60.0;
  bool fallback = false, msh_2_2 = false;
  int order = 1;
  ScanIn scan_in;
};

/// Places of --finer: WHERE=SIZE, where a place is a point, a landmark's name or a mesh file.
std::vector<convert::Refinement> refinements(const TetText& text) {
  std::vector<brep::Landmark> landmarks;
  if (!text.landmarks.empty()) landmarks = read_landmarks(text.landmarks);
  std::vector<convert::Refinement> places;
  for (const std::string& word : text.finer) {
    const std::size_t equals = word.rfind('=');
    const std::optional<double> size_mm =
        equals == std::string::npos ? std::nullopt : parse_number(word.substr(equals + 1));
    if (!size_mm || *size_mm <= 0.0)
      throw std::runtime_error("--finer: '" + word +
                               "' says no size: for example 12,-80,4=0.5 or cut.stl=0.5");
    const std::string where = word.substr(0, equals);
    const auto landmark = std::find_if(landmarks.begin(), landmarks.end(),
                                       [&](const brep::Landmark& known) { return known.name == where; });
    convert::Refinement place;
    place.size_mm = *size_mm;
    if (landmark != landmarks.end())
      place.points_mm = {landmark->p_mm};
    else if (const auto numbers = parse_numbers<3>(where))
      place.points_mm = {{(*numbers)[0], (*numbers)[1], (*numbers)[2]}};
    else if (std::filesystem::exists(where))
      place.surface = brep::read_triangles(where);
    else
      throw std::runtime_error("--finer: '" + where +
                               "' is no point x,y,z, no mesh file, and no landmark of --landmarks");
    places.push_back(std::move(place));
  }
  return places;
}

/// What a deck is made of, and how it came about.
struct Filled {
  convert::Tetrahedra tetrahedra;
  std::size_t regions = 1;
  std::optional<std::string> fallback;  ///< why the elements are an octree's own
  std::vector<std::string> findings;
};

/// A voxel's edge with which a solid has about 200 000 voxels.
double fallback_voxel_mm(double volume_mm3) {
  return std::cbrt(volume_mm3 / 200000.0);
}

voxel::Octree voxels_of(const TetText& text, const brep::Triangles& triangles, bool solid) {
  voxel::Box box{triangles.points_mm.front(), triangles.points_mm.front()};
  for (const glm::dvec3& p : triangles.points_mm) {
    box.low_mm = glm::min(box.low_mm, p);
    box.high_mm = glm::max(box.high_mm, p);
  }
  const glm::dvec3 extent = box.high_mm - box.low_mm;
  const double volume_mm3 =
      solid ? brep::volume_mm3(brep::mesh_of(triangles)) : extent.x * extent.y * extent.z;
  const voxel::Universe universe =
      voxel::universe_around(box, text.voxel_mm.value_or(fallback_voxel_mm(volume_mm3)));
  return solid ? convert::voxelise(universe, brep::mesh_of(triangles))
               : convert::voxelise_by_winding_number(universe, triangles);
}

/// Elements as they are made, or why the fallback is to be taken. Without --fallback throws where none are
/// made, and keeps unfit ones with a finding.
void fill(const TetText& text, Filled& filled, const std::function<convert::Tetrahedra()>& make) {
  try {
    filled.tetrahedra = make();
    filled.findings = filled.tetrahedra.findings;
    const std::optional<std::string> unfit = convert::fault_in_shape(filled.tetrahedra);
    if (!unfit) return;
    if (text.fallback)
      filled.fallback = unfit;
    else
      filled.findings.push_back(*unfit + (is_octree(text.in)
                                              ? ": take another --size, or --fallback"
                                              : ": mend or simplify the surface, or take --fallback"));
  } catch (const Stopped&) {
    throw Stopped("stopped before " + text.out.string() + " was written");
  } catch (const std::runtime_error& error) {
    if (!text.fallback) throw std::runtime_error(std::string(error.what()) + "; or take --fallback");
    filled.fallback = error.what();
  }
}

/// In place of smooth elements those of an octree.
void fall_back(Filled& filled, convert::Tetrahedra tetrahedra, const voxel::Universe& universe) {
  filled.tetrahedra = std::move(tetrahedra);
  filled.findings = {"fallback: " + *filled.fallback +
                     "; the elements are an octree's, whose surface is in steps of " +
                     grouped(universe.lattice().spacing_mm().x, 3) + " mm: do not read stresses there"};
}

Filled of_mesh(const Program& program, const TetText& text, Timings& timings) {
  brep::Triangles triangles;
  {
    const Stopwatch watch(timings, "read");
    triangles = brep::read_triangles(text.in);
  }
  if (triangles.faces.empty()) throw std::runtime_error(text.in.string() + ": holds no triangles");
  brep::Health health;
  {
    const Stopwatch watch(timings, "health");
    health = brep::health(triangles);
  }
  if (!health.solid() && !text.fallback)
    throw std::runtime_error(text.in.string() + ": is not a solid: " + health.findings.front() +
                             "; mend it first, octotomy info tells all; or take an octree's elements by "
                             "--fallback, which need none");
  Filled filled;
  const Stopwatch watch(timings, "tetrahedralise");
  if (health.solid()) {
    const brep::Mesh solid = brep::mesh_of(triangles);
    filled.regions = brep::components(solid).size();
    fill(text, filled, [&] { return convert::tetrahedralise(solid, text.options); });
  } else {
    filled.fallback = "the mesh is not a solid (" + health.findings.front() + ")";
  }
  if (!filled.fallback) return filled;
  const voxel::Octree octree = voxels_of(text, triangles, health.solid());
  if (octree.is_empty())
    throw std::runtime_error(text.in.string() + ": encloses no voxel: take smaller ones by --voxel");
  fall_back(filled,
            convert::tetrahedra_of(octree, convert::BoundaryCells::Nodes,
                                   {program.stop.get_token(), program.progress("elements")}),
            octree.universe());
  return filled;
}

voxel::Octree octree_in(const std::filesystem::path& path, Timings& timings) {
  voxel::OctreeFile file = read_timed(path, timings);
  auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(
        path.string() +
        ": only a binary octree's voxels become elements: make its surface by octotomy mesh "
        "and fill that");
  return std::move(*octree);
}

/// The octree and the regions beside it: smooth elements where a size is asked for, or else the voxels' own.
Filled of_octrees(const Program& program, const TetText& text, Timings& timings) {
  std::vector<voxel::Octree> octrees{octree_in(text.in, timings)};
  for (const std::filesystem::path& path : text.regions) octrees.push_back(octree_in(path, timings));
  Filled filled;
  filled.regions = octrees.size();
  const Stopwatch watch(timings, "tetrahedralise");
  if (text.size_mm) {
    convert::RegionMeshOptions options;
    options.size_mm = *text.size_mm;
    options.min_dihedral_deg = text.options.min_dihedral_deg;
    options.finer = text.options.finer;
    options.time_limit = text.options.time_limit;
    options.progress = text.options.progress;
    fill(text, filled, [&] { return convert::smooth_tetrahedra_of(octrees, options); });
  } else {
    filled.fallback = "an octree was given without a size of elements";
  }
  if (filled.fallback)
    fall_back(filled,
              convert::tetrahedra_of(octrees, convert::BoundaryCells::Nodes,
                                     {program.stop.get_token(), program.progress("elements")}),
              octrees.front().universe());
  return filled;
}

convert::DeckOptions deck_of(const Program& program, const TetText& text, Filled& filled,
                             const convert::TetQuality& quality, Timings& timings) {
  convert::DeckOptions deck;
  deck.title = text.in.filename().string();
  deck.msh_2_2 = text.msh_2_2;
  deck.second_order = text.order == 2;
  deck.surfaces = {{"SKIN", convert::surface_faces(filled.tetrahedra)}};
  const auto name = [](std::uint32_t from, std::uint32_t to) {
    return "REGION" + std::to_string(from + 1) + "_TO_REGION" + std::to_string(to + 1);
  };
  for (convert::Interface& between : convert::interfaces(filled.tetrahedra)) {
    const std::string there = name(between.from, between.to), back = name(between.to, between.from);
    deck.surfaces.push_back({there, std::move(between.faces)});
    if (!text.contact) continue;
    deck.surfaces.push_back({back, std::move(between.opposite)});
    deck.contacts.push_back({there, back, there});
  }
  if (text.contact) filled.tetrahedra = convert::separate_regions(filled.tetrahedra);
  deck.notes = {std::string("octotomy ") + OCTOTOMY_VERSION};
  for (std::string& note : quality_notes(quality)) deck.notes.push_back(std::move(note));
  for (const std::string& finding : filled.findings) deck.notes.push_back(finding);
  if (text.scan.empty()) return deck;
  const voxel::Scene scan = read_scan(program, text.scan, text.scan_in, timings);
  const Stopwatch watch(timings, "materials");
  for (const std::string& finding :
       add_stiffness(text.stiffness, filled.tetrahedra, glm::dmat4(1.0), scan,
                     {program.stop.get_token(), program.progress("materials")}, deck)) {
    deck.notes.push_back(finding);
    filled.findings.push_back(finding);
  }
  return deck;
}

int tet(const Program& program, TetText text) {
  if (!convert::is_deck(text.out))
    throw std::runtime_error(text.out.string() + ": a deck is written as " + convert::deck_extensions());
  need_folder_of(text.out);
  if (!is_octree(text.in) && (!text.regions.empty() || text.size_mm || text.contact))
    throw std::runtime_error("--region, --size and --contact are of octrees: make one of " +
                             text.in.string() + " by octotomy voxelise");
  text.options.max_volume_mm3 = text.max_volume_mm3;
  text.options.mesher = text.mesher == "tetgen"  ? convert::Mesher::TetGen
                        : text.mesher == "mesh3" ? convert::Mesher::Mesh3
                                                 : convert::Mesher::Best;
  text.options.finer = refinements(text);
  if (!text.finer.empty() && is_octree(text.in) && !text.size_mm)
    throw std::runtime_error("--finer is not of voxels' own elements: give --size, too");
  text.options.time_limit = std::chrono::seconds(static_cast<long>(text.seconds));
  text.options.progress = {program.stop.get_token(), program.progress("filling, of the time allowed")};
  Timings timings;
  Filled filled = is_octree(text.in) ? of_octrees(program, text, timings) : of_mesh(program, text, timings);
  const convert::Tetrahedra& tetrahedra = filled.tetrahedra;
  const convert::TetQuality quality = convert::quality(tetrahedra);
  convert::DeckOptions deck = deck_of(program, text, filled, quality, timings);
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    deck.progress = {program.stop.get_token(), program.progress("writing")};
    convert::write_deck(tetrahedra, text.out, deck);
  }
  for (const std::string& finding : filled.findings) warn(finding);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["nodes"] = tetrahedra.nodes_mm.size();
  json["tets"] = tetrahedra.tets.size();
  json["regions"] = filled.regions;
  json["volume_mm3"] = quality.volume_mm3;
  json["quality"] = quality_json(quality);
  json["order"] = text.order;
  json["method"] = tetrahedra.method;
  json["fallback"] = filled.fallback.has_value();
  json["materials"] = deck.materials.size();
  json["findings"] = filled.findings;
  program.say(json, lines({{"written", text.out.string()},
                           {"made by", tetrahedra.method},
                           {"tetrahedra", grouped(static_cast<double>(tetrahedra.tets.size()), 0)},
                           {"dihedral", grouped(quality.min_dihedral_deg, 1) + " to " +
                                            grouped(quality.max_dihedral_deg, 1) + " degrees"}}));
  return done;
}

void add_material_options(CLI::App& verb, TetText& text) {
  const std::string group = "materials";
  std::vector<std::string> laws;
  for (const convert::StiffnessLaw& law : convert::stiffness_laws()) laws.push_back(law.name);
  verb.add_option("--scan", text.scan, "Take each element's stiffness from this scan in HU")->group(group);
  verb.add_option("--density", text.stiffness.density,
                  "SLOPE,INTERCEPT: g/cm3 = intercept + slope HU, as the scan's calibration phantom says")
      ->delimiter(',')
      ->expected(2)
      ->group(group);
  verb.add_option("--law", text.stiffness.law, "Stiffness of a density")
      ->check(CLI::IsMember(laws))
      ->capture_default_str()
      ->group(group);
  verb.add_option("--bins", text.stiffness.bins, "Materials that elements are gathered into, by stiffness")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->group(group);
  verb.add_option("--surface-depth", text.stiffness.surface_depth_mm,
                  "Take what is nearer to the surface than so many mm from this depth, as voxels there hold "
                  "bone and what is beside it; 0: from where it is")
      ->check(between(0.0, 20.0))
      ->capture_default_str()
      ->group(group);
  verb.add_option("--poisson", text.stiffness.poisson_ratio, "Poisson's ratio of them")
      ->check(between(0.0, 0.499))
      ->capture_default_str()
      ->group(group);
}

}  // namespace

void add_tet(Program& program) {
  const auto text = std::make_shared<TetText>();
  CLI::App& verb =
      program.verb("tet", "Fills a solid with quality tetrahedra for finite elements",
                   "octotomy tet maxilla.stl -o maxilla.inp --radius-edge 1.4 --json\n"
                   "  octotomy tet maxilla.stl -o maxilla.inp --finer 12,-80,4=0.5 --finer plate.stl=0.8\n"
                   "  octotomy tet maxilla.octree --region rest.octree --size 3 --contact -o head.inp\n"
                   "  octotomy tet maxilla.stl -o maxilla.feb --scan head.nrrd --density 0.0009,0.05",
                   [&program, text] { return tet(program, *text); });
  verb.add_option("file", text->in, "A closed mesh, or a binary .octree file")
      ->required()
      ->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out,
                  "A deck: .inp (Abaqus, CalculiX), .feb (FEBio 4), .vtu, .msh (Gmsh 4.1) or .node (TetGen)")
      ->required();
  verb.add_option("--mesher", text->mesher,
                  "tetgen keeps the surface; mesh3 (CGAL) puts one of its own in place, within a tenth of a "
                  "triangle's size; best: tetgen, and mesh3 where angles stay under --dihedral")
      ->check(CLI::IsMember({"tetgen", "mesh3", "best"}))
      ->capture_default_str();
  verb.add_option("--dihedral", text->options.min_dihedral_deg,
                  "Smallest dihedral angle that is aimed at, degrees")
      ->check(between(0.0, 30.0))
      ->capture_default_str();
  verb.add_option("--radius-edge", text->options.radius_edge,
                  "TetGen's largest circumradius by shortest edge; 1.2 is hard, 2 is easy")
      ->check(between(1.1, 10.0))
      ->capture_default_str();
  verb.add_option("--max-volume", text->max_volume_mm3, "Largest tetrahedron, mm3")->check(above_zero());
  verb.add_option(
          "--finer", text->finer,
          "WHERE=MM: elements with sides of about so many mm at a point x,y,z, a landmark or along a mesh "
          "file's surface, growing from there; repeated")
      ->allow_extra_args(false);
  verb.add_option("--landmarks", text->landmarks,
                  "Landmarks that --finer names: JSON, or 3D Slicer's markups")
      ->check(CLI::ExistingFile);
  verb.add_flag("!--refine-boundary", text->options.keep_boundary,
                "Let TetGen add points on the surface; by default it is kept as it is");
  verb.add_option("--seconds", text->seconds, "Time that each run of a mesher may take")
      ->check(between(1.0, 86400.0))
      ->capture_default_str();
  verb.add_flag("--fallback", text->fallback,
                "Where the meshers fail or leave flat elements, or the mesh is no solid, take an octree's "
                "elements, marked as such");
  verb.add_option("--voxel", text->voxel_mm, "Edge of their smallest, mm; default: about 200 000 voxels")
      ->check(above_zero());
  const std::string group = "regions of octrees";
  verb.add_option("--region", text->regions,
                  "A further octree of the same universe, a region of its own; repeated")
      ->check(CLI::ExistingFile)
      ->group(group);
  verb.add_option("--size", text->size_mm,
                  "Smooth quality elements of about this size, mm, in place of the voxels' own")
      ->check(above_zero())
      ->group(group);
  verb.add_flag(
          "--contact", text->contact,
          "Regions have nodes of their own where they touch, and contact pairs there; default: shared nodes")
      ->group(group);
  verb.add_option("--order", text->order,
                  "1: four-node tetrahedra; 2: ten-node ones, with nodes on their sides")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  verb.add_flag("--msh2", text->msh_2_2, "Write .msh in Gmsh's version 2.2");
  add_material_options(verb, *text);
  add_scan_options(verb, text->scan_in);
}

}  // namespace octotomy::planner::cli
