// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "brep/align/register_landmarks.h"
#include "brep/align/register_surfaces.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/move.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/measure/result_json.h"
#include "planner/plan/landmarks_file.h"
#include "planner/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

struct RegisterText {
  std::filesystem::path a, b, out;
  std::vector<std::filesystem::path> landmarks;  ///< of a and of b
  std::string motion = "rigid";
  bool landmarks_only = false;
  brep::SurfaceFitOptions options;
};

bool is_json(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

brep::Motion motion_of(const std::string& text) {
  return text == "similarity" ? brep::Motion::similarity
         : text == "rigid"    ? brep::Motion::rigid
                              : brep::Motion::three_points;
}

brep::LandmarkFit fit_landmarks(const RegisterText& text, const std::vector<std::filesystem::path>& paths,
                                Timings& timings, Json& json) {
  const Stopwatch watch(timings, "landmarks");
  brep::LandmarkFit fit =
      brep::register_landmarks(read_landmarks(paths[0]), read_landmarks(paths[1]), motion_of(text.motion));
  Json pairs = Json::array();
  for (std::size_t k = 0; k < fit.paired.size(); ++k)
    pairs.push_back({{"name", fit.paired[k]}, {"residual_mm", fit.residuals_mm[k]}});
  json["landmarks"] = {{"motion", text.motion},
                       {"rms_mm", fit.rms_mm},
                       {"scale", fit.scale},
                       {"pairs", pairs},
                       {"left_out", fit.left_out}};
  return fit;
}

brep::SurfaceFit fit_surfaces(const Program& program, const RegisterText& text,
                              const std::optional<glm::dmat4>& start, Timings& timings, Json& json) {
  const brep::Mesh a = read_surface(text.a, timings), b = read_surface(text.b, timings);
  const Stopwatch watch(timings, "register");
  brep::SurfaceFitOptions options = text.options;
  options.start = start;
  options.stop = program.stop.get_token();
  options.progress = program.progress("register");
  try {
    brep::SurfaceFit fit = brep::register_surfaces(a, b, options);
    json["surfaces"] = {{"rms_mm", fit.rms_mm},       {"kept_share", fit.kept_share},
                        {"rounds", fit.rounds},       {"converged", fit.converged},
                        {"stiffness", fit.stiffness}, {"start", start ? "landmarks" : "search"}};
    return fit;
  } catch (const std::runtime_error& error) {
    if (program.stop.stop_requested()) throw Stopped(error.what());
    throw;
  }
}

/// The mesh of a at b's place; a similarity's scale too.
void write_moved(const RegisterText& text, const glm::dmat4& b_from_a, Timings& timings) {
  brep::Mesh mesh = read_surface(text.a, timings);
  const Stopwatch watch(timings, "write");
  for (const auto v : mesh.vertices()) {
    const brep::Mesh::Point& p = mesh.point(v);
    const glm::dvec4 q = b_from_a * glm::dvec4(p[0], p[1], p[2], 1.0);
    mesh.set_point(v, brep::Mesh::Point(q.x, q.y, q.z));
  }
  brep::write_mesh(mesh, text.out);
}

int register_two(const Program& program, const RegisterText& text) {
  const bool points_only = is_json(text.a) || is_json(text.b);
  if (points_only && !(is_json(text.a) && is_json(text.b)))
    throw std::runtime_error(
        "one of A and B is a file of landmarks and the other is not: give two of a kind, and landmarks "
        "beside "
        "meshes by --landmarks A.json B.json");
  if (points_only && (!text.out.empty() || !text.landmarks.empty()))
    throw std::runtime_error("with two files of landmarks there is no mesh for -o or --landmarks");
  if (text.landmarks_only && text.landmarks.empty())
    throw std::runtime_error("--landmarks-only needs --landmarks A.json B.json");
  if (!text.out.empty()) {
    need_mesh_extension(text.out);
    need_folder_of(text.out);
  }
  Timings timings;
  Json details = Json::object();
  std::optional<glm::dmat4> b_from_a;
  double rms_mm = 0.0;
  std::vector<std::string> findings;
  if (points_only || !text.landmarks.empty()) {
    const brep::LandmarkFit fit =
        fit_landmarks(text, points_only ? std::vector{text.a, text.b} : text.landmarks, timings, details);
    b_from_a = fit.fixed_from_moving;
    rms_mm = fit.rms_mm;
    for (const std::string& name : fit.left_out)
      findings.push_back("landmark '" + name + "' is in one file only");
  }
  if (!points_only && !text.landmarks_only) {
    if (text.motion == "similarity")
      throw std::runtime_error("surfaces are registered rigidly; a similarity takes --landmarks-only");
    const brep::SurfaceFit fit = fit_surfaces(program, text, b_from_a, timings, details);
    b_from_a = fit.fixed_from_moving;
    rms_mm = fit.rms_mm;
    findings.insert(findings.end(), fit.findings.begin(), fit.findings.end());
  }
  if (!text.out.empty()) write_moved(text, *b_from_a, timings);
  for (const std::string& finding : findings) warn(finding);

  Json json = answer(timings);
  json["transform"] = to_json(*b_from_a);
  json["rms_mm"] = rms_mm;
  json["definition"] = "transform takes A's points, LPS mm, to B's place; row by row";
  json.update(details);
  json["path"] = text.out.empty() ? Json(nullptr) : Json(text.out.string());
  json["findings"] = findings;
  const glm::dvec3 shift((*b_from_a)[3]);
  program.say(json, lines({{"rms", grouped(rms_mm, 3) + " mm"},
                           {"translation", grouped(shift.x, 2) + ", " + grouped(shift.y, 2) + ", " +
                                               grouped(shift.z, 2) + " mm"},
                           {"written", text.out.empty() ? "nothing, see -o" : text.out.string()}}));
  return done;
}

}  // namespace

void add_register(Program& program) {
  const auto text = std::make_shared<RegisterText>();
  CLI::App& verb = program.verb("register", "The motion that lays A on B, by surfaces or named landmarks",
                                "octotomy register before.stl after.stl -o moved.stl --json",
                                [&program, text] { return register_two(program, *text); });
  verb.add_option("a", text->a, "The mesh that moves, or a .json of landmarks")
      ->required()
      ->check(CLI::ExistingFile);
  verb.add_option("b", text->b, "The mesh that stays, or a .json of landmarks")
      ->required()
      ->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "A moved to B: a .stl, .ply, .obj, .off, .vtp or .glb file");
  verb.add_option("--landmarks", text->landmarks, "A's and B's landmarks, where the search begins")
      ->expected(2)
      ->check(CLI::ExistingFile);
  verb.add_flag("--landmarks-only", text->landmarks_only, "Take the landmarks' motion as it is");
  verb.add_option("--motion", text->motion,
                  "Of landmarks: rigid, similarity, or three_points, which trusts the first most")
      ->check(CLI::IsMember({"rigid", "similarity", "three_points"}))
      ->capture_default_str();
  verb.add_option("--overlap", text->options.overlap, "Share of A's surface that B has too")
      ->check(between(0.05, 1.0))
      ->capture_default_str();
  verb.add_option("--samples", text->options.samples, "Points of A's surface that are compared")
      ->check(CLI::Range(100, 1'000'000))
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
