// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's mirror image about a plane: a stated plane, or the plane that fits the object's mesh best. A
// fit runs first, so that both kernels mirror about the same plane.
#include "brep/align/mirror.h"

#include <array>

#include "brep/mesh/health.h"
#include "brep/mesh/triangles.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/motion/fit_rows.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {
namespace {

struct Mirror {
  ObjectName object;
  std::optional<glm::dvec3> point_mm, normal;
  std::vector<Mark> through;
  bool fit = false;
  double overlap = brep::MirrorFitOptions{}.overlap;
  int rounds = brep::MirrorFitOptions{}.max_rounds;
  std::optional<double> rest_mm;
  // Of the command only.
  std::vector<glm::dvec3> plane;
  bool exactly = false;
  std::filesystem::path out;
};

/// The stated plane, or the patient's mid-plane if none is stated.
brep::MirrorPlane plane_of(const Mirror& mirror) {
  return {mirror.point_mm.value_or(glm::dvec3(0.0)),
          glm::normalize(mirror.normal.value_or(glm::dvec3(1, 0, 0)))};
}

brep::MirrorFit fit(const brep::Mesh& mesh, const Mirror& mirror, const voxel::Progress& progress) {
  brep::MirrorFitOptions options;
  if (mirror.point_mm && mirror.normal) options.start = plane_of(mirror);
  options.overlap = mirror.overlap;
  options.max_rounds = mirror.rounds;
  options.rest_mm = mirror.rest_mm;
  options.stop = progress.stop;
  options.progress = progress.report;
  return brep::fit_mirror_plane(mesh, options);
}

/// The results of a fit as JSON; null values if there was no fit.
Json fit_json(const brep::MirrorPlane& plane, const std::optional<brep::MirrorFit>& found) {
  const auto of_fit = [&](double brep::MirrorFit::*value) {
    return found ? Json((*found).*value) : Json(nullptr);
  };
  return {{"plane", {{"point_mm", to_json(plane.point_mm)}, {"normal", to_json(plane.normal)}}},
          {"rms_mm", of_fit(&brep::MirrorFit::rms_mm)},
          {"kept_share", of_fit(&brep::MirrorFit::kept_share)},
          {"rounds", found ? Json(found->rounds) : Json(nullptr)},
          {"converged", found ? Json(found->converged) : Json(nullptr)},
          {"last_step_mm", of_fit(&brep::MirrorFit::last_step_mm)},
          {"rest_mm", of_fit(&brep::MirrorFit::rest_mm)},
          {"twist_deg", of_fit(&brep::MirrorFit::twist_deg)},
          {"slide_mm", of_fit(&brep::MirrorFit::slide_mm)}};
}

void check(const Mirror& mirror, const FieldLocation& place) {
  if (mirror.exactly && mirror.plane.empty())
    place.at("exactly").refuse("applies only to a stated plane: add 'plane'");
  if (!mirror.plane.empty() && mirror.plane[1] == glm::dvec3(0.0))
    place.at("plane").refuse("its normal has no length");
  if (!mirror.through.empty() && (mirror.point_mm || mirror.normal))
    place.at("through").refuse(
        "states the plane a second time: keep either 'through', or 'point_mm' and 'normal'");
}

/// Stores the plane through three marks. Throws std::runtime_error if they lie on one line.
void take_plane_through(const std::array<glm::dvec3, 3>& p_mm, Mirror& mirror) {
  const glm::dvec3 a = p_mm[1] - p_mm[0], b = p_mm[2] - p_mm[0], across = glm::cross(a, b);
  // The limit of 1/100 means 0.1 mm over 10 mm. Nobody places marks more precisely.
  if (!(glm::length(across) > 0.01 * glm::length(a) * glm::length(b)))
    throw std::runtime_error(
        "the three points of 'through' lie on one line, which determines no plane: move one of them off the "
        "line");
  mirror.point_mm = p_mm[0];
  mirror.normal = glm::normalize(across);
}

Mirror settle(const Mirror& mirror, const SettleBench& bench) {
  Mirror settled = mirror;
  if (!mirror.through.empty())
    take_plane_through({mark_mm(mirror.through[0], bench.objects), mark_mm(mirror.through[1], bench.objects),
                        mark_mm(mirror.through[2], bench.objects)},
                       settled);
  if (!mirror.fit) return settled;
  const Stopwatch watch(bench.timings, "fit");
  const brep::MirrorFit found = fit(bench.object(mirror.object.name), settled, bench.progress);
  bench.details = fit_json(found.plane, found);
  bench.findings.insert(bench.findings.end(), found.findings.begin(), found.findings.end());
  settled.point_mm = found.plane.point_mm;
  settled.normal = found.plane.normal;
  return settled;
}

/// The reflection in the plane as a matrix: a Householder matrix about the plane's point.
glm::dmat4 reflection_of(const Mirror& mirror) {
  const auto [point_mm, n] = plane_of(mirror);
  glm::dmat4 mirrored(glm::dmat3(1.0) - 2.0 * glm::outerProduct(n, n));
  mirrored[3] = glm::dvec4(2.0 * glm::dot(n, point_mm) * n, 1.0);
  return mirrored;
}

std::string definition(const Mirror& mirror, const Objects&) {
  const glm::dvec3 p = plane_of(mirror).point_mm;
  return mirror.object.name + " mirrored about the plane through (" + plain(p.x) + ", " + plain(p.y) + ", " +
         plain(p.z) + ") mm";
}

void voxels(const Mirror& mirror, const VoxelBench& bench, VoxelSide& made) {
  const Object& still = bench.objects.at(mirror.object.name);
  if (is_voxelised(still))
    return voxelise(brep::mirrored(*still.mesh.whole, plane_of(mirror)), bench.universe, made);
  made.symbol = reflected(*still.voxel.symbol, reflection_of(mirror));
  made.octree = bench.combined(*made.symbol);
  made.lineage = "the object's own definition under a reflection, windows on interpolated samples";
}

void triangles(const Mirror& mirror, const MeshBench& bench, MeshSide& made) {
  made.whole = brep::mirrored(bench.object(mirror.object.name), plane_of(mirror));
  made.lineage = "vertices of a mesh under a reflection";
}

void bound(const Mirror& mirror, const BoundBench& bench, Object& made) {
  carry(mirror.object.name, reflection_of(mirror), bench, made);
  // A mirror image is not a moved object: decks do not move with it, and pictures do not show it as the same
  // piece.
  made.moved.reset();
  made.shown.reset();
}

FileAnswer on_files(const Mirror& asked, const FileBench& bench) {
  if (!asked.out.empty()) {
    need_mesh_extension(asked.out);
    need_folder_of(asked.out);
  }
  Mirror mirror = asked;
  if (!asked.plane.empty()) {
    mirror.point_mm = asked.plane[0];
    mirror.normal = asked.plane[1];
  }
  std::vector<std::string> findings;
  const brep::Mesh mesh = read_surface(asked.object.name, bench.timings, &findings);
  std::optional<brep::MirrorFit> found;
  if (!asked.exactly) {
    const Stopwatch watch(bench.timings, "fit");
    found = fit(mesh, mirror, bench.progress("mid-plane"));
  }
  const brep::MirrorPlane plane = found ? found->plane : plane_of(mirror);
  if (!asked.out.empty()) {
    write_surface(brep::mirrored(mesh, plane), asked.out, bench.timings);
    if (auto finding = rounding_finding(asked.out, bench.timings))
      if (brep::health(brep::triangles_of(mesh)).solid()) findings.push_back(std::move(*finding));
  }
  FileAnswer answer{fit_json(plane, found)};
  if (found) findings.insert(findings.end(), found->findings.begin(), found->findings.end());
  answer.findings = findings;
  answer.json["path"] = asked.out.empty() ? Json(nullptr) : Json(asked.out.string());
  answer.json["findings"] = answer.findings;
  const auto point = [](const glm::dvec3& p, int decimals) {
    return grouped(p.x, decimals) + ", " + grouped(p.y, decimals) + ", " + grouped(p.z, decimals);
  };
  answer.rows = {
      {"through", point(plane.point_mm, 2) + " mm"},
      {"normal", point(plane.normal, 4)},
      {"rms", found ? grouped(found->rms_mm, 3) + " mm" : "not fitted"},
      {"rounds",
       found ? rounds_text(found->rounds, found->converged, found->last_step_mm, found->rest_mm) : "none"},
      {"twist",
       found ? three_figures(found->twist_deg) + "\u00b0, slide " + three_figures(found->slide_mm) + " mm"
             : "none"},
      {"written", asked.out.empty() ? "nothing, see -o" : asked.out.string()}};
  return answer;
}

}  // namespace

Operation mirror_operation() {
  return Describe<Mirror>("mirror", "Makes an object's mirror image about a plane that is stated or fitted.",
                          Makes::Object)
      .takes(field("object", &Mirror::object, "The object.").required().positional("mesh"))
      .takes(field("point_mm", &Mirror::point_mm, "A point of the plane, LPS. Default: the frame's origin.")
                 .in_plans_only())
      .takes(field("normal", &Mirror::normal, "The plane's normal, LPS. Default: the patient's left.")
                 .direction()
                 .in_plans_only())
      .takes(field("through", &Mirror::through,
                   "Three points of the plane, instead of 'point_mm' and 'normal': [x, y, z] or landmarks of "
                   "the mid-line.")
                 .from(3)
                 .to(3)
                 .in_plans_only())
      .takes(field("fit", &Mirror::fit,
                   "Uses the plane of best symmetry. The search begins at the stated plane, or else at the "
                   "planes of the object's axes.")
                 .in_plans_only())
      .takes(field("overlap", &Mirror::overlap,
                   "For a fit: the share of the surface that has a mirrored counterpart.")
                 .from(0.0)
                 .to(1.0))
      .takes(field("rounds", &Mirror::rounds, "Largest number of rounds in each of a fit's two refinements.")
                 .from(1)
                 .to(100000))
      .takes(field("rest_mm", &Mirror::rest_mm,
                   "A fit ends with a round that moves the samples by at most this distance. Default: a "
                   "millionth of their spread.")
                 .greater_than(0.0))
      .verb_takes(field("plane", &Mirror::plane,
                        "A point X,Y,Z and a normal X,Y,Z of a plane at which the search begins. Default: "
                        "the planes of the surface's axes.")
                      .from(2)
                      .to(2))
      .verb_takes(field("exactly", &Mirror::exactly, "Mirrors about the plane of --plane, without a fit."))
      .verb_takes(
          field("out", &Mirror::out, "The mirror image: a .stl, .ply, .obj, .off, .vtp or .glb file."))
      .example(
          R"({"id": "twin", "do": "mirror", "object": "maxilla", "point_mm": [0, 0, 0], "normal": [1, 0, 0]})")
      .on_files(
          "octotomy mirror skull.stl -o mirrored.stl --json\n"
          "  octotomy compare skull.stl mirrored.stl -o asymmetry.ply",
          on_files)
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
