// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/mirror.h"

#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

struct MirrorText {
  std::filesystem::path mesh, out;
  std::vector<std::string> plane;
  bool exactly = false;
  double overlap = 0.7;
};

std::optional<brep::MirrorPlane> plane_of(const MirrorText& text) {
  if (text.plane.empty()) return std::nullopt;
  const glm::dvec3 point_mm = parse_point("--plane", text.plane[0]);
  const glm::dvec3 normal = parse_point("--plane", text.plane[1]);
  if (!(glm::length(normal) > 0.0)) throw std::runtime_error("--plane: its normal has no length");
  return brep::MirrorPlane{point_mm, glm::normalize(normal)};
}

brep::MirrorFit fit(const Program& program, const MirrorText& text, const brep::Mesh& mesh) {
  brep::MirrorFitOptions options;
  options.start = plane_of(text);
  options.overlap = text.overlap;
  options.stop = program.stop.get_token();
  options.progress = program.progress("mid-plane");
  return brep::fit_mirror_plane(mesh, options);
}

int mirror(const Program& program, const MirrorText& text) {
  if (text.exactly && text.plane.empty()) throw std::runtime_error("--exactly needs --plane to mirror about");
  if (!text.out.empty()) {
    need_mesh_extension(text.out);
    need_folder_of(text.out);
  }
  Timings timings;
  const brep::Mesh mesh = read_surface(text.mesh, timings);
  std::optional<brep::MirrorFit> found;
  if (!text.exactly) {
    const Stopwatch watch(timings, "fit");
    found = fit(program, text, mesh);
  }
  const brep::MirrorPlane plane = found ? found->plane : *plane_of(text);
  if (!text.out.empty()) write_surface(brep::mirrored(mesh, plane), text.out, timings);
  const std::vector<std::string> findings = found ? found->findings : std::vector<std::string>();
  for (const std::string& finding : findings) warn(finding);
  const auto of_fit = [&](double brep::MirrorFit::*value) {
    return found ? Json((*found).*value) : Json(nullptr);
  };
  Json json = answer(timings);
  json["plane"] = {{"point_mm", to_json(plane.point_mm)}, {"normal", to_json(plane.normal)}};
  json["rms_mm"] = of_fit(&brep::MirrorFit::rms_mm);
  json["kept_share"] = of_fit(&brep::MirrorFit::kept_share);
  json["twist_deg"] = of_fit(&brep::MirrorFit::twist_deg);
  json["slide_mm"] = of_fit(&brep::MirrorFit::slide_mm);
  json["path"] = text.out.empty() ? Json(nullptr) : Json(text.out.string());
  json["findings"] = findings;
  const auto point = [](const glm::dvec3& p, int decimals) {
    return grouped(p.x, decimals) + ", " + grouped(p.y, decimals) + ", " + grouped(p.z, decimals);
  };
  program.say(json, lines({{"through", point(plane.point_mm, 2) + " mm"},
                           {"normal", point(plane.normal, 4)},
                           {"rms", found ? grouped(found->rms_mm, 3) + " mm" : "not fitted"},
                           {"written", text.out.empty() ? "nothing, see -o" : text.out.string()}}));
  return done;
}

}  // namespace

void add_mirror(Program& program) {
  const auto text = std::make_shared<MirrorText>();
  CLI::App& verb = program.verb("mirror", "A surface mirrored about the mid-plane that fits it best",
                                "octotomy mirror skull.stl -o mirrored.stl --json\n"
                                "  octotomy compare skull.stl mirrored.stl -o asymmetry.ply",
                                [&program, text] { return mirror(program, *text); });
  verb.add_option("mesh", text->mesh, "A mesh")->required()->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "The mirror image: a .stl, .ply, .obj, .off, .vtp or .glb file");
  verb.add_option("--plane", text->plane,
                  "A point X,Y,Z and a normal X,Y,Z near the plane; else the surface's own axes are tried")
      ->expected(2);
  verb.add_flag("--exactly", text->exactly, "Mirror about --plane as it stands, without a fit");
  verb.add_option("--overlap", text->overlap, "Share of the surface that has a counterpart, 0..1")
      ->check(between(0.0, 1.0))
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
