// SPDX-License-Identifier: AGPL-3.0-or-later
// Registers an object to another one by a rigid motion, from surfaces, named landmarks or both, or from the samples of
// two scans. The motion is determined first, so that both kernels use the same motion.
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "brep/align/register_landmarks.h"
#include "brep/align/register_surfaces.h"
#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/motion/fit_rows.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/motion/scan_fit.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/write_scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner {
namespace {

struct Register {
  ObjectName object, onto;
  std::vector<std::string> landmarks;  ///< file of the object's landmarks, then file of the other object's
                                       ///< landmarks
  bool landmarks_only = false;
  std::string motion = "rigid";
  double overlap = brep::SurfaceFitOptions{}.overlap;
  int samples = static_cast<int>(brep::SurfaceFitOptions{}.samples);
  int rounds = brep::SurfaceFitOptions{}.max_rounds;
  std::optional<double> rest_mm;
  std::string by;  ///< empty: by surfaces, or for two files of scans by mutual information
  double least_overlap = ScanFitAsked{}.least_overlap, finest_mm = ScanFitAsked{}.finest_mm;
  std::filesystem::path out, watch;  ///< of the command only
  glm::dmat4 onto_from_object{1.0};  ///< determined before the kernels run
  std::vector<Caveat> doubts;        ///< of that motion
};

struct LandmarkResidual {
  std::string name;
  double residual_mm = 0.0;
};
constexpr auto members_of(const LandmarkResidual&) {
  using R = LandmarkResidual;
  return std::tuple(member("name", &R::name), member("residual_mm", &R::residual_mm));
}

struct FitOfLandmarks {
  std::string motion;
  double rms_mm = 0.0, scale = 1.0;
  std::vector<LandmarkResidual> pairs;
  std::vector<std::string> left_out;  ///< landmarks that only one file contains
};
constexpr auto members_of(const FitOfLandmarks&) {
  using F = FitOfLandmarks;
  return std::tuple(member("motion", &F::motion), member("rms_mm", &F::rms_mm), member("scale", &F::scale),
                    member("pairs", &F::pairs), member("left_out", &F::left_out));
}

struct FitOfSurfaces {
  double rms_mm = 0.0, kept_share = 0.0;
  int rounds = 0;
  bool converged = false;
  double stiffness = 0.0;
  std::string start;  ///< "landmarks" or "search"
  double last_step_mm = 0.0, rest_mm = 0.0;
};
constexpr auto members_of(const FitOfSurfaces&) {
  using F = FitOfSurfaces;
  return std::tuple(member("rms_mm", &F::rms_mm), member("kept_share", &F::kept_share),
                    member("rounds", &F::rounds), member("converged", &F::converged),
                    member("stiffness", &F::stiffness), member("start", &F::start),
                    member("last_step_mm", &F::last_step_mm), member("rest_mm", &F::rest_mm));
}

struct TrustOfFit {
  double matched_share = 0.0, tolerance_mm = 0.0;
  std::optional<double> rival_share;  ///< none if the search began at a stated motion
  double noise_mm = 0.0;
  std::size_t starts = 0, agreeing_starts = 0;
  Json equal_transforms;
  std::string definition =
      "matched_share is the share of A's surface within tolerance_mm of B with normals that agree to 37 "
      "degrees; rival_share is this share at the best other motion of the search; noise_mm is the median "
      "distance of a vertex from the mean of its neighbours";
};
constexpr auto members_of(const TrustOfFit&) {
  using T = TrustOfFit;
  return std::tuple(member("matched_share", &T::matched_share), member("tolerance_mm", &T::tolerance_mm),
                    member("rival_share", &T::rival_share), member("noise_mm", &T::noise_mm),
                    member("starts", &T::starts), member("agreeing_starts", &T::agreeing_starts),
                    member("equal_transforms", &T::equal_transforms), member("definition", &T::definition));
}

struct FitDetails {
  std::optional<FitOfLandmarks> landmarks;
  std::optional<FitOfSurfaces> surfaces;
  std::string verdict;  ///< only for a fit of surfaces
  std::optional<TrustOfFit> trust;
};
constexpr auto members_of(const FitDetails&) {
  using F = FitDetails;
  return std::tuple(member_if_any("landmarks", &F::landmarks), member_if_any("surfaces", &F::surfaces),
                    member_if_any("verdict", &F::verdict), member_if_any("trust", &F::trust));
}

/// The motion of a registration, with its results for the report.
struct Laid {
  glm::dmat4 onto_from_object{1.0};
  std::optional<double> rms_mm;  ///< none for scans, which have no points to compare
  FitDetails details = {};
  std::vector<std::string> findings = {};
};

/// The rotation of a motion, ignoring its scale.
struct Turn {
  double degrees = 0.0;
  glm::dvec3 axis{0, 0, 1};
};
Turn turn_of(const glm::dmat4& motion) {
  glm::dmat3 m(motion);
  for (int k = 0; k < 3; ++k) m[k] = glm::normalize(m[k]);
  // Computed from the quaternion, because the antisymmetric part of the matrix loses digits near a half turn.
  const glm::dquat q = glm::normalize(glm::quat_cast(m));
  const glm::dvec3 v = q.w < 0.0 ? -glm::dvec3(q.x, q.y, q.z) : glm::dvec3(q.x, q.y, q.z);
  const double sine = glm::length(v);
  Turn turn;
  turn.degrees = glm::degrees(2.0 * std::atan2(sine, std::abs(q.w)));
  if (sine > 0.0) turn.axis = v / sine;
  return turn;
}

bool is_json(const std::filesystem::path& path) {
  return is_landmarks_file(path);
}

/// The reason why one set of landmarks may be mirrored; none if there is no sign of it. Three points never
/// show it, because they are congruent to their mirror image.
std::optional<std::string> mirrored(std::vector<brep::Landmark> moving,
                                    const std::vector<brep::Landmark>& fixed, const brep::LandmarkFit& fit) {
  constexpr double most_mm = 3.0;  // the error of landmarks placed by hand on a head
  if (fit.rms_mm <= most_mm) return std::nullopt;
  for (brep::Landmark& mark : moving) mark.p_mm.x = -mark.p_mm.x;
  const double rms_mm = brep::register_landmarks(moving, fixed, brep::MotionModel::similarity).rms_mm;
  if (rms_mm > 0.3 * fit.rms_mm) return std::nullopt;
  return "the landmarks lie " + grouped(fit.rms_mm, 1) + " mm apart, and " + grouped(rms_mm, 1) +
         " mm if one set is mirrored: check whether the names or the frame of one set exchange left and "
         "right";
}

Laid by_landmarks(const std::filesystem::path& moving, const std::filesystem::path& fixed,
                  const std::string& motion, Timings& timings) {
  const Stopwatch watch(timings, "landmarks");
  const std::vector<brep::Landmark> from = read_landmarks(moving), to = read_landmarks(fixed);
  const brep::LandmarkFit fit =
      brep::register_landmarks(from, to,
                               motion == "similarity" ? brep::MotionModel::similarity
                               : motion == "rigid"    ? brep::MotionModel::rigid
                                                      : brep::MotionModel::three_points);
  Laid laid{fit.fixed_from_moving, fit.rms_mm};
  FitOfLandmarks& details = laid.details.landmarks.emplace();
  details.motion = motion;
  details.rms_mm = fit.rms_mm;
  details.scale = fit.scale;
  for (std::size_t k = 0; k < fit.paired.size(); ++k)
    details.pairs.push_back({fit.paired[k], fit.residuals_mm[k]});
  details.left_out = fit.left_out;
  for (const std::string& name : fit.left_out)
    laid.findings.push_back("landmark '" + name + "' is only in one file, so it is not used");
  if (auto sides = mirrored(from, to, fit)) laid.findings.push_back(std::move(*sides));
  return laid;
}

/// The verdict of a fit of surfaces. If several motions fit equally well, it is at most WARN.
const char* verdict_of(const brep::FitTrust& trust) {
  if (trust.verdict == brep::FitVerdict::Failed) return "FAIL";
  return trust.verdict == brep::FitVerdict::Doubtful || !trust.equals.empty() ? "WARN" : "PASS";
}

/// The findings that begin with FAIL or WARN, which lower the verdict of an object's certificate.
std::vector<Caveat> doubts_of(const std::vector<std::string>& findings) {
  std::vector<Caveat> doubts;
  for (const std::string& finding : findings)
    if (finding.starts_with("FAIL "))
      doubts.push_back({voxel::Verdict::Fail, finding.substr(5), false});
    else if (finding.starts_with("WARN "))
      doubts.push_back({voxel::Verdict::Warn, finding.substr(5), false});
  return doubts;
}

/// Refines the motion in `laid`; if `is_laid` is false, searches for a motion first.
void by_surfaces(const brep::Mesh& moving, const brep::Mesh& fixed, const Register& asked, bool is_laid,
                 const voxel::Progress& progress, Timings& timings, Laid& laid) {
  if (asked.motion == "similarity")
    throw std::runtime_error(
        "surfaces are registered rigidly: for a similarity, register landmarks by --landmarks-only");
  const Stopwatch watch(timings, "register");
  brep::SurfaceFitOptions options;
  if (is_laid) options.start = laid.onto_from_object;
  options.overlap = asked.overlap;
  options.samples = static_cast<std::size_t>(asked.samples);
  options.max_rounds = asked.rounds;
  options.rest_mm = asked.rest_mm;
  options.stop = progress.stop;
  options.progress = progress.report;
  const brep::SurfaceFit fit = brep::register_surfaces(moving, fixed, options);
  laid.details.surfaces = {fit.rms_mm,       fit.kept_share, fit.rounds,
                           fit.converged,    fit.stiffness,  is_laid ? "landmarks" : "search",
                           fit.last_step_mm, fit.rest_mm};
  const brep::FitTrust& trust = *fit.trust;
  laid.details.verdict = verdict_of(trust);
  laid.details.trust = {trust.matched_share,
                        trust.tolerance_mm,
                        trust.starts == 0 ? std::nullopt : std::optional(trust.rival_share),
                        trust.noise_mm,
                        trust.starts,
                        trust.agreeing_starts,
                        Json::array()};
  for (const glm::dmat4& equal : trust.equals) laid.details.trust->equal_transforms.push_back(to_json(equal));
  laid.onto_from_object = fit.fixed_from_moving;
  laid.rms_mm = fit.rms_mm;
  laid.findings.insert(laid.findings.end(), fit.findings.begin(), fit.findings.end());
}

bool is_by_samples(const Register& asked) {
  return asked.by == "correlation" || asked.by == "mutual_information";
}

ScanFitAsked scan_fit_asked(const Register& asked) {
  return {asked.by == "correlation", asked.least_overlap, asked.finest_mm, asked.watch};
}

/// The scan from which an object was made, and the object's motion since then.
const Shown& shown_of(const Objects& objects, const std::string& name) {
  const Object& object = objects.at(name);
  if (!object.shown || !object.shown->samples)
    throw std::runtime_error(
        "'" + name +
        "' was not made from a scan, so it has no samples to compare: register it by surfaces or landmarks");
  return *object.shown;
}

/// Registers the two objects' scans at the positions where they were read. The objects move as their scans
/// do.
FittedScans by_scans_of(const Register& asked, const SettleBench& bench, Laid& laid) {
  const Shown& moving = shown_of(bench.objects, asked.object.name);
  const Shown& fixed = shown_of(bench.objects, asked.onto.name);
  if (moving.scan == fixed.scan)
    throw std::runtime_error("'" + asked.object.name + "' and '" + asked.onto.name +
                             "' come from the same scan, '" + moving.scan + "': register them by surfaces");
  for (const auto& [name, shown] : {std::pair(asked.object.name, &moving), {asked.onto.name, &fixed}})
    if (!is_rigid(shown->moved_from_still))
      throw std::runtime_error("'" + name +
                               "' is scaled or sheared, so it does not move as its scan does: register it by "
                               "surfaces or landmarks");
  FittedScans fitted =
      fit_scans(*moving.samples, *fixed.samples, scan_fit_asked(asked), bench.progress, bench.timings);
  laid.onto_from_object =
      fixed.moved_from_still * fitted.fixed_from_moving * glm::inverse(moving.moved_from_still);
  laid.findings = fitted.findings;
  return fitted;
}

void check(const Register& asked, const FieldLocation& place) {
  if (asked.landmarks_only && asked.landmarks.empty())
    place.at("landmarks_only").refuse("uses the motion of landmarks: add 'landmarks', two files");
  if (place.scope != nullptr && asked.motion == "similarity")
    place.at("motion").refuse(
        "scales, but a registered object moves rigidly: use rigid or three_points, and 'affine' to scale");
}

Register settle(const Register& asked, const SettleBench& bench) {
  Laid laid;
  Json of_scans = Json::object();
  if (is_by_samples(asked))
    of_scans = by_scans_of(asked, bench, laid).details;
  else if (!asked.landmarks.empty())
    laid = by_landmarks(bench.folder / asked.landmarks[0], bench.folder / asked.landmarks[1], asked.motion,
                        bench.timings);
  if (!asked.landmarks_only && !is_by_samples(asked))
    by_surfaces(bench.object(asked.object.name), bench.object(asked.onto.name), asked,
                !asked.landmarks.empty(), bench.progress, bench.timings, laid);
  bench.details = {{"transform", to_json(laid.onto_from_object)}};
  if (laid.rms_mm) bench.details["rms_mm"] = *laid.rms_mm;
  // Scans have other details than surfaces and landmarks, whose details are a record.
  bench.details.update(is_by_samples(asked) ? of_scans : print_record(laid.details));
  bench.findings.insert(bench.findings.end(), laid.findings.begin(), laid.findings.end());
  Register settled = asked;
  settled.onto_from_object = laid.onto_from_object;
  settled.doubts = doubts_of(laid.findings);
  return settled;
}

std::string definition(const Register& asked, const Objects&) {
  return asked.object.name + " laid on " + asked.onto.name;
}

void voxels(const Register& asked, const VoxelBench& bench, VoxelSide& made) {
  move_voxels(asked.object.name, asked.onto_from_object, bench, made);
}

void triangles(const Register& asked, const MeshBench& bench, MeshSide& made) {
  move_triangles(asked.object.name, asked.onto_from_object, bench, made);
}

void bound(const Register& asked, const BoundBench& bench, Object& made) {
  carry(asked.object.name, asked.onto_from_object, bench, made);
  made.caveats.insert(made.caveats.end(), asked.doubts.begin(), asked.doubts.end());
}

/// Writes the mesh at its new position, scaled if the motion is a similarity.
void write_moved(const Register& asked, const glm::dmat4& moved_from_still, Timings& timings) {
  brep::Mesh mesh = read_surface(asked.object.name, timings);
  for (const auto v : mesh.vertices()) {
    const brep::Mesh::Point& p = mesh.point(v);
    const glm::dvec4 q = moved_from_still * glm::dvec4(p[0], p[1], p[2], 1.0);
    mesh.set_point(v, brep::Mesh::Point(q.x, q.y, q.z));
  }
  write_surface(mesh, asked.out, timings);
}

/// The parts of the answer that all kinds of registration share: the motion, its definition and its text.
FileAnswer answer_of(const Register& asked, const Laid& laid, const Json& details) {
  FileAnswer answer;
  answer.json = {{"transform", to_json(laid.onto_from_object)},
                 {"rms_mm", laid.rms_mm ? Json(*laid.rms_mm) : Json(nullptr)},
                 {"definition", "transform maps A's points, LPS mm, to B's frame; row by row"}};
  answer.json.update(details);
  answer.findings = laid.findings;
  const glm::dvec3 shift(laid.onto_from_object[3]);
  const Turn turn = turn_of(laid.onto_from_object);
  answer.json.update({{"path", asked.out.empty() ? Json(nullptr) : Json(asked.out.string())},
                      {"findings", laid.findings},
                      {"rotation", {{"degrees", turn.degrees}, {"axis", to_json(turn.axis)}}}});
  answer.rows = {
      {"rotation", grouped(turn.degrees, 3) + "\u00b0 about (" + grouped(turn.axis.x, 4) + ", " +
                       grouped(turn.axis.y, 4) + ", " + grouped(turn.axis.z, 4) + ")"},
      {"translation", grouped(shift.x, 2) + ", " + grouped(shift.y, 2) + ", " + grouped(shift.z, 2) + " mm"},
      {"written", asked.out.empty() ? "nothing, see -o" : asked.out.string()}};
  return answer;
}

/// Registers two scans. The written file has the unchanged samples of the moving scan in a new frame.
FileAnswer scans_on_files(const Register& asked, const FileBench& bench) {
  if (!asked.landmarks.empty() || asked.landmarks_only)
    throw std::runtime_error(
        "--landmarks does not apply to two scans, which are compared by their samples: leave it out");
  // Options for surfaces are refused only here, because the name of a DICOM folder does not show that it is a
  // scan.
  const Register fresh;
  if (asked.overlap != fresh.overlap || asked.samples != fresh.samples || asked.rounds != fresh.rounds ||
      asked.rest_mm)
    throw std::runtime_error(
        "--overlap, --samples, --rounds and --rest apply only to surfaces: leave them out for scans");
  if (!asked.out.empty()) {
    if (!voxel::volume_format(asked.out))
      throw std::runtime_error(asked.out.string() +
                               ": a scan can be written as .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
    need_folder_of(asked.out);
  }
  voxel::Scene moving = bench.read_scan(asked.object.name);
  const voxel::Scene fixed = bench.read_scan(asked.onto.name);
  const FittedScans fitted =
      fit_scans(moving, fixed, scan_fit_asked(asked), bench.progress("register"), bench.timings);
  const Laid laid{fitted.fixed_from_moving, {}, {}, fitted.findings};
  if (!asked.out.empty()) {
    moving.lattice.lps_from_voxel = laid.onto_from_object * moving.lattice.lps_from_voxel;
    const Stopwatch watch(bench.timings, "write");
    voxel::write_scene(moving, asked.out);
  }
  FileAnswer answer = answer_of(asked, laid, fitted.details);
  answer.json["definition"] =
      "transform maps A's points, LPS mm, to B's frame; row by row; rms_mm is null, because scans have no "
      "pairs of points";
  answer.rows.insert(answer.rows.begin(), {"verdict", fitted.summary});
  return answer;
}

/// Whether both files are scans, that is neither surfaces, landmarks nor octrees. Throws if only one of them
/// is.
bool are_scans(const Register& asked) {
  const auto is_scan = [](const std::string& name) {
    return !is_mesh(name) && !is_json(name) && !is_octree(name);
  };
  const bool a = is_scan(asked.object.name), b = is_scan(asked.onto.name);
  if (a != b)
    throw std::runtime_error((a ? asked.object.name : asked.onto.name) +
                             ": is a scan, but the other file is not: name two scans, or make a surface of "
                             "this scan by octotomy mesh");
  if (!a && is_by_samples(asked))
    throw std::runtime_error("--by: " + asked.by + " applies only to two scans: leave it out");
  if (a && asked.by == "surfaces")
    throw std::runtime_error(
        "--by surfaces does not apply to two scans: make surfaces of them by octotomy mesh");
  return a;
}

FileAnswer on_files(const Register& asked, const FileBench& bench) {
  const std::filesystem::path a = asked.object.name, b = asked.onto.name;
  const bool points_only = is_json(a) || is_json(b);
  if (points_only && !(is_json(a) && is_json(b)))
    throw std::runtime_error(
        "only one of A and B is a file of landmarks: name two files of the same kind; state landmarks of "
        "meshes by --landmarks A.json B.json");
  if (are_scans(asked)) return scans_on_files(asked, bench);
  if (points_only && (!asked.out.empty() || !asked.landmarks.empty()))
    throw std::runtime_error(
        "-o and --landmarks need meshes, but A and B are files of landmarks: leave these options out");
  if (!asked.out.empty()) {
    need_mesh_extension(asked.out);
    need_folder_of(asked.out);
  }
  Laid laid;
  if (points_only)
    laid = by_landmarks(a, b, asked.motion, bench.timings);
  else if (!asked.landmarks.empty())
    laid = by_landmarks(asked.landmarks[0], asked.landmarks[1], asked.motion, bench.timings);
  if (!points_only && !asked.landmarks_only)
    by_surfaces(read_surface(a, bench.timings, &laid.findings),
                read_surface(b, bench.timings, &laid.findings), asked, !asked.landmarks.empty(),
                bench.progress("register"), bench.timings, laid);
  if (!asked.out.empty()) write_moved(asked, laid.onto_from_object, bench.timings);
  FileAnswer answer = answer_of(asked, laid, print_record(laid.details));
  answer.rows.insert(answer.rows.begin(), {"rms", grouped(*laid.rms_mm, 3) + " mm"});
  if (const std::optional<FitOfSurfaces>& fit = laid.details.surfaces) {
    const TrustOfFit& trust = *laid.details.trust;
    answer.rows.insert(answer.rows.begin() + 1,
                       {"verdict", laid.details.verdict + ", " + three_figures(100.0 * trust.matched_share) +
                                       " % lie within " + three_figures(trust.tolerance_mm) + " mm"});
    answer.rows.insert(answer.rows.begin() + 1,
                       {"rounds", rounds_text(fit->rounds, fit->converged, fit->last_step_mm, fit->rest_mm)});
  }
  return answer;
}

// Conditions under which fields apply. They depend on the fields' values only, because a name does not show
// whether it is a DICOM folder or an object of a plan.
bool is_of_samples(const Register& asked) {
  return is_by_samples(asked) || (asked.by.empty() && voxel::volume_format(asked.object.name));
}
bool is_of_surfaces(const Register& asked) {
  return !is_of_samples(asked);
}
bool may_be_of_samples(const Register& asked) {
  return is_of_samples(asked) || (asked.by.empty() && !is_mesh(asked.object.name) &&
                                  !is_json(asked.object.name) && std::filesystem::exists(asked.object.name));
}
constexpr const char* of_surfaces = "applies only to surfaces: leave it out for scans";
constexpr const char* of_samples =
    "applies only to two scans that are compared 'by' correlation or mutual_information";

}  // namespace

Operation register_operation() {
  return Describe<Register>("register",
                            "Moves an object so that it matches another object, by surfaces, named landmarks "
                            "or the samples of two scans.",
                            Makes::Object)
      .takes(field("object", &Register::object,
                   "The object that moves; on the command line a mesh, a scan or a .json of landmarks.")
                 .required()
                 .positional("a"))
      .takes(field("onto", &Register::onto, "What stays.").required().positional("b"))
      .takes(field("landmarks", &Register::landmarks,
                   "Two files: the landmarks of the moving object and of the fixed object. Their motion is "
                   "the start of the search.")
                 .from(2)
                 .to(2)
                 .a_file()
                 .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(field("landmarks_only", &Register::landmarks_only,
                   "Uses the motion of the landmarks, without a fit of surfaces.")
                 .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(field("motion", &Register::motion,
                   "Motion of landmarks: rigid; three_points, which matches the first pair exactly; or "
                   "similarity, for meshes only.")
                 .one_of({"rigid", "similarity", "three_points"})
                 .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(field("overlap", &Register::overlap,
                   "Share of the moving surface that has a counterpart in the other.")
                 .from(0.05)
                 .to(1.0)
                 .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(field("samples", &Register::samples, "Number of sample points on the moving surface.")
                 .from(100)
                 .to(1000000)
                 .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(
          field("rounds", &Register::rounds, "Largest number of rounds in each of the last two refinements.")
              .from(1)
              .to(100000)
              .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(field("rest_mm", &Register::rest_mm,
                   "A refinement ends with a round that moves the samples by at most this distance. Default: "
                   "a millionth of their spread.")
                 .greater_than(0.0)
                 .read_if<Register>(is_of_surfaces, of_surfaces))
      .takes(field("by", &Register::by,
                   "What is compared: surfaces; or the samples of two scans, by correlation for scans of the "
                   "same kind or by mutual_information for any two scans. Default: surfaces; for two files "
                   "of scans, mutual_information.")
                 .one_of({"surfaces", "correlation", "mutual_information"}))
      .takes(field("least_overlap", &Register::least_overlap,
                   "The other scan must cover at least this share of the smaller scan.")
                 .from(0.05)
                 .to(1.0)
                 .read_if<Register>(may_be_of_samples, of_samples))
      .takes(field("finest_mm", &Register::finest_mm,
                   "The resolution at which the search for a scan's motion ends.")
                 .from(0.5)
                 .to(8.0)
                 .read_if<Register>(may_be_of_samples, of_samples))
      .verb_takes(field("out", &Register::out,
                        "The file of A moved to B: .stl, .ply, .obj, .off, .vtp or .glb; for scans .nrrd, "
                        ".nhdr, .nii, .nii.gz, .mha or .mhd, with unchanged samples in a new frame."))
      .verb_takes(field("watch", &Register::watch,
                        "A new folder for a picture of the difference of two scans at each step of the "
                        "search: the moving scan in magenta, the fixed scan in green.")
                      .read_if<Register>(may_be_of_samples, of_samples))
      .reads_scans()
      .example(R"({"id": "laid", "do": "register", "object": "maxilla", "onto": "skull", "overlap": 0.9})")
      .on_files(
          "octotomy register before.stl after.stl -o moved.stl --json\n"
          "  octotomy register before.nrrd after.nrrd --by correlation -o moved.nrrd --watch steps",
          on_files)
      .motion()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
