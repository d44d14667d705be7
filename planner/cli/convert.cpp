// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>

#include "planner/answer.h"
#include "planner/cli/scan_in.h"
#include "voxel/write_scene.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct ConvertText {
  fs::path in, out;
  ScanIn scan;
  bool dicom = false;
};

bool is_volume(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array<const char*, 6> known{".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd"};
  return std::any_of(known.begin(), known.end(),
                     [&](const char* extension) { return name.ends_with(extension); });
}

int convert(const Program& program, const ConvertText& text) {
  const bool folder = text.dicom || !text.out.has_extension();
  if (!folder && !is_volume(text.out))
    throw std::runtime_error(text.out.string() +
                             ": unknown kind of scan; use .nrrd, .nii.gz or .mha, or a folder for DICOM");
  need_folder_of(text.out);
  Timings timings;
  const voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    if (folder) {
      voxel::DicomOptions options;
      options.series_description = "Octotomy, derived";
      voxel::write_dicom_series(scene, text.out, options);
    } else {
      voxel::write_scene(scene, text.out);
    }
  }
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  const glm::ivec3 dims = scene.lattice.dims;
  for (const voxel::Finding& finding : scene.audit)
    if (finding.verdict != voxel::Verdict::Pass) warn(finding.check + ": " + finding.detail);
  program.say(json, lines({{"written", text.out.string()},
                           {"samples", std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " +
                                           std::to_string(dims.z)}}));
  return done;
}

}  // namespace

void add_convert(Program& program) {
  const auto text = std::make_shared<ConvertText>();
  CLI::App& verb =
      program.verb("convert", "Writes a scan in another format, straightened to a lattice where it has to be",
                   "octotomy convert dicom_folder -o head.nii.gz\n"
                   "  octotomy convert 'slices/*.tif' --spacing 0.5,0.5,1 -o head.nrrd\n"
                   "  octotomy convert head.raw --raw 512x512x300 int16 --spacing 0.5,0.5,1 -o head.nrrd",
                   [&program, text] { return convert(program, *text); });
  verb.add_option("scan", text->in, "A DICOM folder or file, NIfTI, NRRD, MetaImage, images, or a raw file")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .nrrd, .nii.gz or .mha file, or a folder for DICOM")->required();
  verb.add_flag("--dicom", text->dicom, "Write a DICOM series into the folder");
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
