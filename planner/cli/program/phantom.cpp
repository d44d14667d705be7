// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/verb.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/implicit_solid.h"
#include "verify/phantom/leg_phantom.h"
#include "verify/phantom/sample_volume.h"
#include "verify/phantom/solid_phantom.h"
#include "verify/phantom/tooth_scan_phantom.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/disk_need.h"

namespace octotomy::planner::cli {
namespace {

struct PhantomText {
  const CLI::App* verb = nullptr;
  std::string kind;
  std::filesystem::path out;
  // Options of the head.
  verify::HeadOptions head;
  double truth_step_mm = 1.0;
  bool dicom = false;
  // Options of solids.
  std::optional<int> voxels;
  std::optional<double> radius_voxels;
  std::vector<double> turn_deg;
  std::string digitise = "centre";
};

/// Writes the scan of a phantom; the path's extension states the format. The constructor throws
/// std::runtime_error for an unknown extension, before the scan is computed.
class ScanOut {
 public:
  ScanOut(const PhantomText& text, std::string series) : path_(text.out), series_(std::move(series)) {
    const std::string name = path_.filename().string();
    const bool image = name.ends_with(".nrrd") || name.ends_with(".nhdr") || name.ends_with(".nii") ||
                       name.ends_with(".nii.gz") || name.ends_with(".mha") || name.ends_with(".mhd");
    is_folder_ = text.dicom || !path_.has_extension();
    if (!image && !is_folder_)
      throw std::runtime_error(path_.string() +
                               ": unknown kind of scan; use .nrrd, .nii.gz or .mha, or a folder for DICOM");
  }
  /// Throws voxel::Error (Resource) if the disk has no room for a scan of this box and spacing.
  void need_disk_of(const voxel::Box& box, double voxel_mm, double slice_mm) const {
    voxel::Lattice least;
    least.dims = glm::floor((box.high_mm - box.low_mm) / glm::dvec3(voxel_mm, voxel_mm, slice_mm));
    voxel::need_disk(path_, voxel::least_file_bytes(least, sizeof(std::int16_t), path_));
  }
  void write(const voxel::Scene& scene, Timings& timings) const {
    const Stopwatch watch(timings, "write");
    if (!is_folder_) return voxel::write_scene(scene, path_);
    voxel::DicomOptions dicom;
    dicom.series_description = series_;
    voxel::write_dicom_series(scene, path_, dicom);
  }

 private:
  std::filesystem::path path_;
  std::string series_;
  bool is_folder_ = false;
};

int head(const Program& program, const PhantomText& text) {
  const ScanOut out(text, "Octotomy head phantom");
  out.need_disk_of(verify::head_bounds(), text.head.voxel_mm,
                   text.head.slice_mm.value_or(text.head.voxel_mm));
  Timings timings;
  voxel::Scene scene;
  {
    const Stopwatch watch(timings, "phantom");
    scene = verify::head_phantom(text.head);
  }
  // The true volume is reported only in the JSON. Sampling it takes longer than the scan, so it is left out
  // otherwise.
  verify::SampledVolume bone;
  if (program.json) {
    const Stopwatch watch(timings, "truth");
    bone = verify::sample_volume(verify::head_bounds(), text.truth_step_mm, [](const glm::dvec3& p_mm) {
      return verify::head_contains(verify::HeadPart::Bone, p_mm);
    });
  }
  out.write(scene, timings);
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["truth"] = {{"object", "bone"},
                   {"volume_mm3", bone.volume_mm3},
                   {"volume_standard_error_mm3", bone.standard_error_mm3},
                   {"area_mm2", nullptr}};
  json["findings"] = {
      "truth.area_mm2: the bone's closed form is a Boolean of solids, which has no closed area"};
  program.say(json, lines({{"phantom", text.out.string()}, {"samples", dims_text(scene.lattice.dims)}}));
  return done;
}

int leg(const Program& program, const PhantomText& text) {
  const ScanOut out(text, "Octotomy leg phantom");
  Timings timings;
  voxel::Scene scene;
  {
    const Stopwatch watch(timings, "phantom");
    verify::LegOptions options;
    options.voxel_mm = text.head.voxel_mm;
    options.noise_sigma_hu = text.head.noise_sigma_hu;
    options.seed = text.head.seed;
    scene = verify::leg_phantom(options);
  }
  out.write(scene, timings);
  const verify::LegFibula fibula;
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["truth"] = {{"object", "the fibula's shaft"},
                   {"volume_mm3", fibula.section_mm2() * fibula.length_mm()},
                   {"area_mm2", nullptr},
                   {"section_mm2", fibula.section_mm2()},
                   {"axis_from_mm", to_json(fibula.from_mm)},
                   {"axis_to_mm", to_json(fibula.to_mm)},
                   {"face_mm", to_json(fibula.from_mm + fibula.across_mm * fibula.face())}};
  json["findings"] = {"truth.area_mm2: head and malleolus join the shaft, which has no closed area"};
  program.say(json, lines({{"phantom", text.out.string()}, {"samples", dims_text(scene.lattice.dims)}}));
  return done;
}

bool is_tooth_scan(const PhantomText& text) {
  return text.kind == "upper_teeth" || text.kind == "lower_teeth";
}

/// Writes a mesh of teeth as a scanner in the mouth shows them. The JSON contains the fields with which the
/// operation tooth_scan places it on the head phantom.
int teeth(const Program& program, const PhantomText& text) {
  need_mesh_extension(text.out);
  Timings timings;
  verify::ToothScanPhantomOptions options;
  options.is_upper = text.kind == "upper_teeth";
  options.seed = text.head.seed;
  const verify::ToothScanPhantom made = verify::tooth_scan_phantom(options);
  write_surface(made.scan, text.out, timings);
  Json json{{"path", text.out.string()}, {"faces", made.scan.faces.size()}};
  json["truth"] = {{"lps_from_scan", to_json(made.lps_from_scan)}};
  for (const auto& [name, points_mm] :
       {std::pair("points", &made.points_mm), {"scan_points", &made.scan_points_mm}})
    for (const glm::dvec3& p : *points_mm) json[name].push_back(to_json(p));
  program.say(json, lines({{"phantom", text.out.string()},
                           {"triangles", grouped(double(made.scan.faces.size()), 0)}}));
  return done;
}

verify::SolidPhantom solid_of(const PhantomText& text) {
  verify::SolidPhantomOptions options;
  if (text.kind == "figure_3_1") options.voxels = 4;
  if (text.voxels) options.voxels = *text.voxels;
  options.radius_voxels = text.radius_voxels;
  options.spacing_mm = glm::dvec3(text.head.voxel_mm);
  if (!text.turn_deg.empty())
    options.lps_from_axes = verify::turned({text.turn_deg[0], text.turn_deg[1], text.turn_deg[2]});
  return verify::solid_phantom(text.kind, options);
}

decltype(voxel::OctreeFile::tree) digitised(const verify::SolidPhantom& solid, const std::string& how) {
  using enum voxel::Digitisation;
  if (how == "partial") return verify::digitise_partial(solid);
  return verify::digitise(solid, how == "inside"     ? Inside
                                 : how == "touching" ? Touching
                                 : how == "half"     ? Half
                                                     : Centre);
}

int solid(const Program& program, const PhantomText& text) {
  if (!is_octree(text.out))
    throw std::runtime_error(text.out.string() + ": a " + text.kind + " is written as .octree");
  Timings timings;
  voxel::OctreeFile file{voxel::Octree::empty({}), text.kind, ""};
  Json truth;
  {
    const Stopwatch watch(timings, "phantom");
    const verify::SolidPhantom solid = solid_of(text);
    file.tree = digitised(solid, text.digitise);
    truth = {{"volume_mm3", solid.volume_mm3},
             {"area_mm2", solid.area_mm2},
             {"centroid_mm", to_json(solid.centroid_mm)}};
    file.metadata = Json{
        {"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
        {"phantom", text.kind},
        {"digitise", text.digitise},
        {"truth",
         truth}}.dump();
  }
  {
    const Stopwatch watch(timings, "write");
    voxel::write_octree(file, text.out);
  }
  Json json = octree_answer(file, std::filesystem::file_size(text.out), timings);
  json["path"] = text.out.string();
  json["truth"] = truth;
  program.say(json, octree_text(text.out.string(), json) +
                        lines({{"truth", grouped(truth["volume_mm3"].get<double>(), 2) + " mm\u00b3, " +
                                             grouped(truth["area_mm2"].get<double>(), 2) + " mm\u00b2"}}));
  return done;
}

constexpr const char* head_group = "head";
constexpr const char* scan_group = "head and leg";
constexpr const char* solid_group = "solids";

int phantom(const Program& program, const PhantomText& text) {
  const bool is_scan = text.kind == "head" || text.kind == "leg";
  for (const CLI::Option* option : text.verb->get_options()) {
    const std::string& group = option->get_group();
    const bool is_idle = is_tooth_scan(text)
                             ? group == solid_group || group == head_group ||
                                   option->get_name() == "--noise" || option->get_name() == "--dicom" ||
                                   option->get_name() == "--voxel"
                         : is_scan ? group == solid_group || (group == head_group && text.kind != "head")
                                   : group == head_group || group == scan_group;
    if (is_idle && option->count() > 0)
      throw CLI::ValidationError(option->get_name(), "has no effect for " + text.kind + ": leave it out");
  }
  const bool is_folder = is_scan && (text.dicom || !text.out.has_extension());
  need_folder_of(text.out, is_folder ? OutputKind::Folder : OutputKind::File);
  if (is_tooth_scan(text)) return teeth(program, text);
  return text.kind == "head" ? head(program, text) : is_scan ? leg(program, text) : solid(program, text);
}

std::string kinds_said() {
  std::string said =
      "head: a CT of a head; leg: a CT of a lower leg; upper_teeth, lower_teeth: a mesh of the head's teeth "
      "as a scanner in the mouth shows them; or an octree of a solid:";
  for (const verify::SolidPhantomKind& kind : verify::solid_phantom_kinds())
    said.append("\n").append(kind.name).append(": ").append(kind.what);
  return said;
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names{"head", "leg", "upper_teeth", "lower_teeth"};
  for (const verify::SolidPhantomKind& kind : verify::solid_phantom_kinds()) names.emplace_back(kind.name);
  return names;
}

void add_head_options(CLI::App& verb, PhantomText& text) {
  verb.add_option("--slice", text.head.slice_mm, "Spacing of slices, mm; default: the voxel's edge")
      ->check(between(0.1, 50.0))
      ->group(head_group);
  verb.add_option("--tilt", text.head.gantry_tilt_deg, "Gantry tilt, degrees")
      ->check(between(-45.0, 45.0))
      ->group(head_group);
  verb.add_option("--noise", text.head.noise_sigma_hu, "Standard deviation of Gaussian noise, HU")
      ->check(between(0.0, 1000.0))
      ->group(scan_group);
  verb.add_option("--blur", text.head.point_spread_sigma_mm, "Standard deviation of the point spread, mm")
      ->check(between(0.0, 10.0))
      ->group(head_group);
  verb.add_option("--seed", text.head.seed, "Seed of the noise")->group(scan_group);
  verb.add_option("--truth-step", text.truth_step_mm, "Step at which the true volume is sampled, mm")
      ->check(between(0.1, 5.0))
      ->capture_default_str()
      ->group(head_group);
  verb.add_flag("--dicom", text.dicom, "Write a DICOM series into the folder")->group(scan_group);
}

void add_solid_options(CLI::App& verb, PhantomText& text) {
  verb.add_option("--voxels", text.voxels, "Voxels along a side of the universe, a power of two; default 256")
      ->group(solid_group);
  verb.add_option("--radius", text.radius_voxels, "R in voxels; default a quarter of the side")
      ->check(above_zero())
      ->group(solid_group);
  verb.add_option("--digitise", text.digitise,
                  "Which voxels: inside (D1), touching (D2), centre (D3), half (D4), or partial, with the "
                  "share of each that is filled")
      ->check(CLI::IsMember({"inside", "touching", "centre", "half", "partial"}))
      ->capture_default_str()
      ->group(solid_group);
  verb.add_option("--turn", text.turn_deg, "Degrees about x, then y, then z: turns the solid")
      ->check(finite())
      ->expected(3)
      ->delimiter(',')
      ->group(solid_group);
}

}  // namespace

void add_phantom(Program& program) {
  const auto text = std::make_shared<PhantomText>();
  CLI::App& verb =
      program.verb("phantom", "Writes a scan or a solid whose true shape and size are known",
                   "octotomy phantom head -o head.nrrd --json\n"
                   "  octotomy phantom sphere -o sphere.octree --voxels 256 --radius 64 --digitise partial",
                   [&program, text] { return phantom(program, *text); });
  text->verb = &verb;
  verb.add_option("kind", text->kind, kinds_said())->required()->check(CLI::IsMember(kind_names()));
  verb.add_option("-o,--out", text->out,
                  "A .octree file; for teeth a mesh, such as .stl; for head and leg a .nrrd, .nii.gz or .mha "
                  "file, or a folder for DICOM")
      ->required();
  verb.add_option("--voxel", text->head.voxel_mm, "Edge of a voxel, mm")
      ->check(between(0.1, 20.0))
      ->capture_default_str();
  add_head_options(verb, *text);
  add_solid_options(verb, *text);
}

}  // namespace octotomy::planner::cli
