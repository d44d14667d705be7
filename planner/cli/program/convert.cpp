// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <optional>

#include "planner/cli/program/convert_source.h"
#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/write_dicom_seg.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

bool is_volume(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array<const char*, 6> known{".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd"};
  return std::any_of(known.begin(), known.end(),
                     [&](const char* extension) { return name.ends_with(extension); });
}

/// Refuses options that apply only to DICOM or to segments if the output has none, because they would have no
/// effect.
void need_used(const ConvertText& text, bool writes_dicom, bool writes_segments) {
  const auto need = [&](bool is_given, const std::string& option, bool is_used, const std::string& of) {
    if (is_given && !is_used)
      throw std::runtime_error(text.out.string() + ": " + option + " applies only to " + of +
                               ", which is not written: leave it out, or write " + of);
  };
  need(!text.label.empty(), "--label", writes_segments, "a DICOM segmentation (.dcm)");
  need(!text.source.empty(), "--source", writes_dicom, "DICOM (a folder or .dcm)");
  need(text.other_identity, "--other-identity", writes_dicom, "DICOM (a folder or .dcm)");
  if (text.other_identity && text.source.empty())
    throw std::runtime_error("--other-identity needs --source: add --source, or leave --other-identity out");
}

voxel::DicomSegKind kind_of(const ConvertText& text) {
  return text.as == "labelmap" ? voxel::DicomSegKind::LabelMap : voxel::DicomSegKind::Binary;
}

int convert_octree(const Program& program, const ConvertText& text) {
  if (text.out.extension() != ".dcm")
    throw std::runtime_error(
        text.out.string() +
        ": an octree is converted to a DICOM segmentation, .dcm; octotomy octree --as has "
        "other forms");
  if (text.dicom)
    throw std::runtime_error(text.in.string() +
                             ": an octree is not a series of images: leave --dicom out and write a .dcm");
  need_used(text, true, true);
  need_folder_of(text.out);
  Timings timings;
  const voxel::OctreeFile file = read_timed(text.in, timings);
  const voxel::DicomSegment object = binary_object(text, file);
  std::vector<std::string> findings;
  voxel::DicomSegOptions options;
  options.label = object.label;
  options.series_description = "Octotomy, segmented";
  options.kind = kind_of(text);
  options.progress.stop = program.stop.get_token();
  {
    const Stopwatch watch(timings, "source");
    options.source = source_of(program, text, false, {}, findings);
  }
  if (!options.source) warn("no --source: the segmentation gets a new study and refers to no images");
  if (options.source) need_on_source(text, *options.source, corners_of(std::vector{object}), findings);
  {
    const Stopwatch watch(timings, "write");
    voxel::write_dicom_seg(object.object, text.out, options);
  }
  Json json = octree_answer(file, fs::file_size(text.in), timings);
  json["path"] = text.out.string();
  json["label"] = options.label;
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines({{"written", text.out.string()},
                           {"segment", options.label},
                           {"voxels", std::to_string(object.object.voxel_count())}}));
  return done;
}

/// Converts a label map to a DICOM segmentation with one segment for each label. The segmentation has the
/// label map's slices and the labels' names.
int convert_labels(const Program& program, const ConvertText& text) {
  need_used(text, true, true);
  need_folder_of(text.out);
  Timings timings;
  std::vector<std::string> findings;
  const LabelObjects read = read_label_objects(program, text, timings, findings);
  const voxel::Scene& scene = read.scene;
  const std::vector<voxel::DicomSegment>& segments = read.objects;
  Json said = Json::array();
  std::vector<std::pair<std::string, std::string>> rows{{"written", text.out.string()}};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    said.push_back({{"segment", i + 1},
                    {"label", read.labels[i].number},
                    {"name", segments[i].label},
                    {"samples", read.labels[i].samples}});
    rows.emplace_back(segments[i].label, std::to_string(read.labels[i].samples) + " samples");
  }
  voxel::DicomSegOptions options;
  options.label = text.label.empty() ? "Objects" : text.label;
  options.series_description = "Octotomy, segmented";
  options.kind = kind_of(text);
  options.progress.stop = program.stop.get_token();
  options.source = source_of(program, text, false, scene.identity, findings);
  if (!options.source) warn("no --source: the segmentation gets a new study and refers to no images");
  if (options.source) need_on_source(text, *options.source, corners_of(segments), findings);
  {
    const Stopwatch watch(timings, "write");
    voxel::write_dicom_seg(segments, text.out, options);
  }
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["segments"] = std::move(said);
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines(rows));
  return done;
}

/// Writes the kind of DICOM object that --as states. None if --as is not given and the input needs none.
std::optional<int> convert_as(const Program& program, const ConvertText& text) {
  if (text.planes != "images" && text.as != "structures")
    throw std::runtime_error("--planes applies only to --as structures: leave it out");
  const bool is_report = voxel::extension_of(text.in) == ".pdf";
  if (text.as.empty() && !is_mesh(text.in) && !is_report) return std::nullopt;
  need_extension(text.out, {".dcm"}, "such a DICOM object is");
  if (text.dicom)
    throw std::runtime_error(text.out.string() +
                             ": is one DICOM object, not a series of images: leave --dicom out");
  if (text.other_identity && text.source.empty())
    throw std::runtime_error("--other-identity needs --source: add --source, or leave --other-identity out");
  need_folder_of(text.out);
  if (is_report && !text.as.empty())
    throw std::runtime_error(text.in.string() + ": is a PDF, which has one form in DICOM: leave --as out");
  if (is_report) return convert_report(program, text);
  if (text.as == "structures") return convert_structures(program, text);
  if (text.as == "fractions") return convert_fractions(program, text);
  if (is_mesh(text.in) && text.as != "segmentation" && text.as != "labelmap")
    return convert_model(program, text);
  if (is_mesh(text.in))
    throw std::runtime_error(text.in.string() +
                             ": a surface has no voxels: octotomy voxelise makes an .octree of it, or --as "
                             "fractions writes the share of each voxel");
  if (text.as == "stl" || text.as == "obj")
    throw std::runtime_error(text.in.string() + ": is no surface, which --as " + text.as +
                             " needs: octotomy mesh makes one");
  return std::nullopt;
}

/// Removes texts of a scan's file that could name a person: names of labels, and values that the standard
/// does not define.
void leave_out_words(voxel::Scene& scene, LabelTable& table, std::vector<std::string>& changes) {
  constexpr std::array<const char*, 3> units{"HU", "US", "OD"};
  if (!table.names.empty()) changes.emplace_back("Names of labels: removed");
  table.names.clear();
  if (std::string kept = voxel::defined_modality(scene.modality); kept != scene.modality) {
    changes.emplace_back("Modality (0008,0060): written as OT, because the standard does not define it");
    scene.modality = "OT";
  }
  if (!scene.declared_unit.empty() &&
      std::find(units.begin(), units.end(), scene.declared_unit) == units.end()) {
    changes.emplace_back("Rescale Type (0028,1054): removed, because the standard does not define it");
    scene.declared_unit.clear();
  }
}

int convert(const Program& program, const ConvertText& text) {
  const bool is_plan = voxel::extension_of(text.in) == ".json";
  if (!text.pictures.empty() && !is_plan)
    throw std::runtime_error("--pictures applies only to a plan (.plan.json): leave it out");
  if (is_plan) return convert_plan(program, text);
  if (const std::optional<int> status = unpack_archived(program, text)) return *status;
  if (const std::optional<int> status = convert_as(program, text)) return *status;
  if (is_octree(text.in)) return convert_octree(program, text);
  if (text.out.extension() == ".dcm" && !text.dicom) return convert_labels(program, text);
  const bool folder = text.dicom || !text.out.has_extension();
  if (!folder && !is_volume(text.out))
    throw std::runtime_error(text.out.string() +
                             ": unknown kind of scan; use .nrrd, .nii.gz or .mha, or a folder for DICOM");
  need_used(text, folder, false);
  need_folder_of(text.out, folder ? OutputKind::Folder : OutputKind::File);
  Timings timings;
  voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  LabelTable table = names_of_labels(scene, text.in);
  std::vector<std::string> findings = table.passed_over;
  if (!text.keeps_identity()) leave_out_words(scene, table, *text.changes);
  if (!folder && !table.names.empty()) need_label_table(text.out, table.names);
  {
    const Stopwatch watch(timings, "write");
    if (folder) {
      if (!table.names.empty())
        findings.push_back(
            "the names of the labels are left out, because a DICOM series of images has no place "
            "for them: a DICOM segmentation (.dcm without --dicom) keeps them");
      voxel::DicomOptions options;
      options.series_description = "Octotomy, derived";
      if (scene.modality.empty())
        findings.push_back(text.in.string() + " does not state its modality: written as CT");
      if (voxel::is_written_as_secondary_capture(scene))
        findings.push_back("the modality " + scene.modality + " is written as Secondary Capture images" +
                           (scene.declared_unit.empty() ? "" : " with the unit " + scene.declared_unit) +
                           ": attributes that only this modality's own kind of image has are left out");
      {
        std::vector<std::string> words = std::move(*text.changes);
        options.source = source_of(program, text, is_dicom(scene), scene.identity, findings);
        text.changes->insert(text.changes->end(), words.begin(), words.end());
      }
      if (options.source && !text.source.empty())
        need_on_source(text, *options.source, corners_of(scene.lattice), findings);
      if (!options.source) {
        options.patient_name = scene.identity.patient_name.empty() || !text.keeps_identity()
                                   ? "Anonymous"
                                   : scene.identity.patient_name;
        findings.push_back("no --source: the series is of '" + options.patient_name +
                           "', in a new study, and refers to no images");
      }
      if (const double off = voxel::dicom_rounding(scene); off > 0.0)
        findings.push_back("values are rounded by up to " + three_figures(off) +
                           ", because DICOM stores them in 16 bits: a .nrrd or .nii.gz keeps them exactly");
      voxel::write_dicom_series(scene, text.out, options);
    } else {
      voxel::write_scene(scene, text.out);
      if (!table.names.empty())
        for (std::string& finding : write_label_table(text.out, table.names))
          findings.push_back(std::move(finding));
    }
  }
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  tell(text, findings, json);
  program.say(json, lines({{"written", text.out.string()}, {"samples", dims_text(scene.lattice.dims)}}));
  return done;
}

}  // namespace

void add_convert(Program& program) {
  const auto text = std::make_shared<ConvertText>();
  CLI::App& verb =
      program.verb("convert",
                   "Writes a scan in another format, resampled to a regular lattice if necessary; an octree "
                   "or a label map as a DICOM segmentation or structure set; a surface, a PDF or a plan as a "
                   "DICOM document, and such a document as a file again",
                   "octotomy convert dicom_folder -o head.nii.gz\n"
                   "  octotomy convert 'slices/*.tif' --spacing 0.5,0.5,1 -o head.nrrd\n"
                   "  octotomy convert head.raw --raw 512x512x300 int16 --spacing 0.5,0.5,1 -o head.nrrd\n"
                   "  octotomy convert skull.octree -o skull.dcm --source dicom_folder --label Skull\n"
                   "  octotomy convert organs.nii.gz -o organs.dcm --source dicom_folder\n"
                   "  octotomy convert skull.octree -o rt.dcm --as structures --source dicom_folder\n"
                   "  octotomy convert skull.stl -o share.dcm --as fractions --source dicom_folder\n"
                   "  octotomy convert skull.stl -o model.dcm --source dicom_folder\n"
                   "  octotomy convert report/report.pdf -o report.dcm --source dicom_folder\n"
                   "  octotomy convert my.plan.json --pictures report -o objects --source dicom_folder\n"
                   "  octotomy convert objects/plan.dcm -o again.plan.json",
                   [&program, text] { return convert(program, *text); });
  verb.add_option("scan", text->in,
                  "A DICOM folder or file, NIfTI, NRRD, MetaImage, images, a raw file, an .octree, a "
                  "surface, a PDF, a plan, or a document in DICOM")
      ->required()
      ->check(scan_path());
  verb.add_option(
          "-o,--out", text->out,
          "A .nrrd, .nii.gz or .mha file, or a folder for DICOM; for an .octree, a label map, a "
          "surface or a PDF a .dcm; for a plan a folder; for a document in DICOM its own kind of file "
          "(.json of a plan, .pdf, .stl, .obj, .png)")
      ->required();
  verb.add_option("--as", text->as,
                  "The kind of .dcm: segmentation (default), labelmap (a segmentation that stores one label "
                  "number per voxel, for objects that share no voxel and for readers of 2025 or later), "
                  "structures (contours on the images of --source), "
                  "fractions (the share of each voxel that is filled), or, for a surface, stl or obj "
                  "(default: the file's own format)")
      ->check(CLI::IsMember({"segmentation", "labelmap", "structures", "fractions", "stl", "obj"}));
  verb.add_option("--planes", text->planes,
                  "Planes of the contours of --as structures: the images' (default) or the voxels'")
      ->check(CLI::IsMember({"images", "voxels"}));
  verb.add_flag("--dicom", text->dicom, "Write a DICOM series into the folder");
  verb.add_option("--source", text->source,
                  "The DICOM series to which written DICOM refers; default: the scan, if it is DICOM")
      ->check(CLI::ExistingPath);
  verb.add_option("--pictures", text->pictures,
                  "A plan's result folder, whose views are written beside the plan as secondary captures")
      ->check(CLI::ExistingDirectory);
  verb.add_flag("--other-identity", text->other_identity,
                "Accept a source that states another patient, study or frame of reference than the scan, or "
                "whose images lie elsewhere, and report a FAIL");
  add_identity(
      verb, text->identity,
      "The patient and study of written DICOM: keep those of --source (default); remove them by the Basic "
      "Application Level Confidentiality Profile of PS3.15, also names of labels and files; or new, a "
      "patient without a name in a new study");
  verb.add_option("--label", text->label,
                  "Label of the DICOM object; default: the octree's or the file's name");
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
