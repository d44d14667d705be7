// SPDX-License-Identifier: AGPL-3.0-or-later
// Separates a surface into its pieces, each a file or an object. No point moves and nothing is repaired, so
// that the command separates any triangles. An object of a plan is a solid, so the step separates a solid.
#include <algorithm>
#include <map>

#include "brep/mesh/components.h"
#include "brep/mesh/disjoint_sets.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Separate {
  ObjectName object;
  std::optional<int> piece;
  double least_mm2 = 0.0;
  std::filesystem::path out;
};

void check(const Separate& separate, const FieldLocation& place) {
  if (place.scope != nullptr && !separate.piece)
    place.at("piece").refuse(
        "is missing: state the number of the piece, where 1 is the largest; use a separate step for each "
        "piece");
}

std::string definition(const Separate& separate, const Objects&) {
  return "piece " + std::to_string(separate.piece.value_or(1)) + " of " + separate.object.name;
}

void triangles(const Separate& separate, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "components");
  const brep::Solid& solid = bench.object(separate.object.name);
  const std::vector<brep::Component> pieces = brep::components(solid);
  const auto wanted = static_cast<std::size_t>(separate.piece.value_or(1));
  if (wanted > pieces.size())
    throw std::runtime_error("'" + separate.object.name + "' has " + std::to_string(pieces.size()) +
                             " pieces, so there is no piece " + std::to_string(wanted));
  made.details = {{"piece", wanted}, {"of", pieces.size()}, {"cavities", pieces[wanted - 1].cavities}};
  made.whole =
      brep::trusted_solid(brep::part_of(solid, pieces[wanted - 1].faces), brep::proof_of_part(solid.proof()));
  made.lineage = "triangles that share edges";
}

void bound(const Separate& separate, const BoundBench& bench, Object& made) {
  inherit(bench.objects.at(separate.object.name), made);
}

/// A piece of a surface that consists of any triangles.
struct SeparatedPart {
  std::vector<std::uint32_t> faces;
  double area_mm2 = 0.0;
  std::optional<double> volume_mm3;  ///< for a closed surface: volume without the piece's cavities
  std::size_t cavities = 0;
};

/// The pieces of a surface. For a closed surface these are its bodies with their cavities, sorted by volume.
/// For an open one they are the sets of triangles that are connected by edges, sorted by area.
std::vector<SeparatedPart> pieces_of(const brep::Mesh& surface) {
  std::vector<SeparatedPart> pieces;
  const auto edges = surface.edges();
  if (std::none_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.is_boundary(); })) {
    for (brep::Component& part : brep::components(surface))
      pieces.push_back({std::move(part.faces), part.area_mm2, part.volume_mm3, part.cavities});
    return pieces;
  }
  brep::DisjointSets sets(surface.n_faces());
  for (const auto edge : surface.edges())
    if (!edge.is_boundary())
      sets.join(static_cast<std::uint32_t>(edge.h0().face().idx()),
                static_cast<std::uint32_t>(edge.h1().face().idx()));
  std::map<std::uint32_t, std::size_t> number;
  for (const auto face : surface.faces()) {
    const auto f = static_cast<std::uint32_t>(face.idx());
    const auto [known, is_new] = number.emplace(sets.set_of(f), pieces.size());
    if (is_new) pieces.emplace_back();
    SeparatedPart& piece = pieces[known->second];
    piece.faces.push_back(f);
    piece.area_mm2 += surface.calc_face_area(face);
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const SeparatedPart& a, const SeparatedPart& b) { return a.area_mm2 > b.area_mm2; });
  return pieces;
}

/// "parts.ply" becomes "parts-3.ply".
std::filesystem::path numbered(const std::filesystem::path& out, std::size_t number) {
  return out.parent_path() / (out.stem().string() + "-" + std::to_string(number) + out.extension().string());
}

void need_piece(const Separate& asked, std::size_t number) {
  need_untyped_surface(numbered(asked.out, number), {asked.object.name});
}

FileAnswer on_files(const Separate& asked, const FileBench& bench) {
  need_mesh_extension(asked.out);
  asked.piece ? need_folder_of(asked.out) : need_piece(asked, 1);
  FileAnswer answer;
  const brep::Mesh surface = read_surface(asked.object.name, bench.timings, &answer.findings);
  std::vector<SeparatedPart> pieces;
  {
    const Stopwatch watch(bench.timings, "components");
    pieces = pieces_of(surface);
  }
  if (asked.piece && static_cast<std::size_t>(*asked.piece) > pieces.size())
    throw std::runtime_error(asked.object.name + ": has " + std::to_string(pieces.size()) +
                             " pieces, so there is no piece " + std::to_string(*asked.piece));
  for (std::size_t i = 0; i < pieces.size() && !asked.piece; ++i)
    if (pieces[i].area_mm2 >= asked.least_mm2) need_piece(asked, i + 1);
  Outputs outputs;
  Json written = Json::array();
  std::size_t small = 0;
  double small_mm2 = 0.0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const SeparatedPart& piece = pieces[i];
    if (asked.piece && i + 1 != static_cast<std::size_t>(*asked.piece)) continue;
    if (piece.area_mm2 < asked.least_mm2) {
      ++small;
      small_mm2 += piece.area_mm2;
      continue;
    }
    if (bench.stop.stop_requested()) throw voxel::Stopped("stopped before the pieces were written");
    const std::filesystem::path path = asked.piece ? asked.out : numbered(asked.out, i + 1);
    outputs.write(path, [&](const std::filesystem::path& file) {
      write_surface(brep::part_of(surface, piece.faces), file, bench.timings);
    });
    written.push_back({{"piece", i + 1},
                       {"path", path.string()},
                       {"triangles", piece.faces.size()},
                       {"area_mm2", piece.area_mm2},
                       {"volume_mm3", piece.volume_mm3 ? Json(*piece.volume_mm3) : Json(nullptr)},
                       {"cavities", piece.cavities}});
    answer.rows.emplace_back(
        path.filename().string(),
        grouped(static_cast<double>(piece.faces.size()), 0) + " triangles, " + grouped(piece.area_mm2, 1) +
            " mm\u00b2" + (piece.volume_mm3 ? ", " + grouped(*piece.volume_mm3, 1) + " mm\u00b3" : ", open"));
  }
  if (small > 0)
    answer.findings.push_back(std::to_string(small) + " pieces under " + plain(asked.least_mm2) +
                              " mm\u00b2, " + three_figures(small_mm2) + " mm\u00b2 together, were left out");
  if (written.empty())
    throw std::runtime_error(asked.object.name + ": no piece has " + plain(asked.least_mm2) +
                             " mm\u00b2, so nothing is written: choose a smaller least area");
  outputs.commit();
  answer.json = {{"pieces", pieces.size()}, {"written", written}, {"findings", answer.findings}};
  return answer;
}

}  // namespace

Operation separate_operation() {
  return Describe<Separate>("separate", "Separates a surface into its connected pieces.", Makes::Object)
      .takes(field("object", &Separate::object, "The object, or the mesh file, open or closed.")
                 .required()
                 .positional("mesh"))
      .takes(field("piece", &Separate::piece,
                   "The number of the piece: 1 is the largest by volume, or by area if the surface is open.")
                 .from(1)
                 .to(1000000))
      .verb_takes(field("least_mm2", &Separate::least_mm2, "Leaves out pieces with a smaller area than this.")
                      .from(0.0)
                      .to(1e9))
      .verb_takes(
          field("out", &Separate::out,
                "A .stl, .ply, .obj, .off, .vtp or .glb file. Without --piece there is a numbered file for "
                "each piece, such as parts-1.ply, which only replaces a file that Octotomy wrote.")
              .required())
      .example(R"({"id": "condyle", "do": "separate", "object": "rest", "piece": 2})")
      .on_files("octotomy separate scan.vtp --least 10 -o parts.ply", on_files)
      .check(check)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
