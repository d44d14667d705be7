// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom.h"

#include "planner/answer.h"
#include "planner/cli/verb.h"
#include "planner/figures.h"
#include "voxel/write_scene.h"

namespace octotomy::planner::cli {
namespace {

struct PhantomText {
  std::string kind;
  std::filesystem::path out;
  verify::HeadOptions head;
  double truth_step_mm = 1.0;
  bool dicom = false;
};

int phantom(const Program& program, const PhantomText& text) {
  const std::string name = text.out.filename().string();
  const bool image = name.ends_with(".nrrd") || name.ends_with(".nhdr") || name.ends_with(".nii") ||
                     name.ends_with(".nii.gz") || name.ends_with(".mha") || name.ends_with(".mhd");
  const bool folder = text.dicom || !text.out.has_extension();
  if (!image && !folder)
    throw std::runtime_error(text.out.string() +
                             ": unknown kind of scan; use .nrrd, .nii.gz or .mha, or a folder for DICOM");
  need_folder_of(text.out);
  Timings timings;
  voxel::Scene scene;
  {
    const Stopwatch watch(timings, "phantom");
    scene = verify::head_phantom(text.head);
  }
  // Sampling the closed form takes longer than the scan, and only the JSON tells it.
  verify::SampledVolume bone;
  if (program.json) {
    const Stopwatch watch(timings, "truth");
    bone = verify::sample_volume(verify::head_bounds(), text.truth_step_mm, [](const glm::dvec3& p_mm) {
      return verify::head_contains(verify::HeadPart::Bone, p_mm);
    });
  }
  {
    const Stopwatch watch(timings, "write");
    if (folder) {
      voxel::DicomOptions dicom;
      dicom.series_description = "Octotomy head phantom";
      voxel::write_dicom_series(scene, text.out, dicom);
    } else {
      voxel::write_scene(scene, text.out);
    }
  }
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["truth"] = {{"object", "bone"},
                   {"volume_mm3", bone.volume_mm3},
                   {"volume_standard_error_mm3", bone.standard_error_mm3},
                   {"area_mm2", nullptr}};
  json["findings"] = {
      "truth.area_mm2: the bone's closed form is a Boolean of solids, which has no closed area"};
  const glm::ivec3 dims = scene.lattice.dims;
  program.say(json, lines({{"phantom", text.out.string()},
                           {"samples", std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " +
                                           std::to_string(dims.z)}}));
  return done;
}

}  // namespace

void add_phantom(Program& program) {
  const auto text = std::make_shared<PhantomText>();
  CLI::App& verb = program.verb("phantom", "Writes a scan whose truth is known",
                                "octotomy phantom head -o head.nrrd --json",
                                [&program, text] { return phantom(program, *text); });
  verb.add_option("kind", text->kind, "head: a CT of a head")->required()->check(CLI::IsMember({"head"}));
  verb.add_option("-o,--out", text->out, "A .nrrd, .nii.gz or .mha file, or a folder for DICOM")->required();
  verb.add_option("--voxel", text->head.voxel_mm, "Edge of a voxel, mm")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  verb.add_option("--slice", text->head.slice_mm, "Spacing of slices, mm; default: the voxel's edge")
      ->check(CLI::Range(0.1, 50.0));
  verb.add_option("--tilt", text->head.gantry_tilt_deg, "Gantry tilt, degrees")
      ->check(CLI::Range(-45.0, 45.0));
  verb.add_option("--noise", text->head.noise_sigma_hu, "Standard deviation of Gaussian noise, HU")
      ->check(CLI::Range(0.0, 1000.0));
  verb.add_option("--blur", text->head.point_spread_sigma_mm, "Standard deviation of the point spread, mm")
      ->check(CLI::Range(0.0, 10.0));
  verb.add_option("--seed", text->head.seed, "Seed of the noise");
  verb.add_option("--truth-step", text->truth_step_mm, "Step at which the true volume is sampled, mm")
      ->check(CLI::Range(0.1, 5.0))
      ->capture_default_str();
  verb.add_flag("--dicom", text->dicom, "Write a DICOM series into the folder");
}

}  // namespace octotomy::planner::cli
