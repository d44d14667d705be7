// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/filter/label_map.h"
#include "voxel/measure/measure.h"
#include "voxel/scan/write_dicom_seg.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct ConvertText {
  fs::path in, out, source;
  std::string label;
  ScanIn scan;
  bool dicom = false, other_identity = false;
};

bool is_volume(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array<const char*, 6> known{".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd"};
  return std::any_of(known.begin(), known.end(),
                     [&](const char* extension) { return name.ends_with(extension); });
}

/// The DICOM series to which the output refers; none if it was not made from one. Refuses a series of another
/// patient than the input. Adds findings on values that could not be compared and, for --source, each WARN
/// and FAIL of its audit.
std::optional<voxel::DicomSource> source_of(const Program& program, const ConvertText& text, bool reads_dicom,
                                            const voxel::Identity& identity,
                                            std::vector<std::string>& findings) {
  if (text.source.empty() && !reads_dicom) return std::nullopt;
  voxel::DicomSource source =
      voxel::dicom_source(text.source.empty() ? text.in : text.source, read_options(program, text.scan));
  if (text.source.empty()) return source;
  for (const voxel::Finding& line : source.audit)
    if (line.verdict != voxel::Verdict::Pass)
      findings.push_back(text.source.string() + ": " + to_string(line.verdict) + ", " + line.check + ": " +
                         line.detail);
  for (std::string& finding :
       need_same_patient({text.source.string(), source.identity}, {text.in.string(), identity},
                         text.other_identity, "--other-identity"))
    findings.push_back(std::move(finding));
  return source;
}

/// The smallest box around all objects.
voxel::Box box_around(const std::vector<voxel::DicomSegment>& segments) {
  constexpr double far_mm = std::numeric_limits<double>::infinity();
  voxel::Box around{glm::dvec3(far_mm), glm::dvec3(-far_mm)};
  for (const voxel::DicomSegment& segment : segments)
    if (const std::optional<voxel::Box> own = voxel::extents_of(segment.object)) {
      around.low_mm = glm::min(around.low_mm, own->low_mm);
      around.high_mm = glm::max(around.high_mm, own->high_mm);
    }
  return around;
}

/// Compares the output's box, in LPS millimetres, with the images of --source. Refuses a box wholly outside
/// them, because the input was made from another scan or has a wrong frame, unless --other-identity allows
/// it. Adds a finding if the box extends beyond the images. Does nothing if nothing is written.
void need_on_source(const ConvertText& text, const voxel::DicomSource& source, const voxel::Box& box,
                    std::vector<std::string>& findings) {
  if (!(box.low_mm.x <= box.high_mm.x)) return;
  const glm::dvec3 low(-0.5), high = glm::dvec3(source.around.dims) - 0.5;
  const glm::dvec3 spacing_mm = source.around.spacing_mm();
  glm::dvec3 least(std::numeric_limits<double>::infinity()), most(-least);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_voxel = source.around.voxel({corner & 1 ? box.high_mm.x : box.low_mm.x,
                                                    corner & 2 ? box.high_mm.y : box.low_mm.y,
                                                    corner & 4 ? box.high_mm.z : box.low_mm.z});
    least = glm::min(least, p_voxel);
    most = glm::max(most, p_voxel);
  }
  const auto largest = [](const glm::dvec3& mm) { return std::max({mm.x, mm.y, mm.z}); };
  const double beyond_mm = largest(glm::max(low - least, most - high) * spacing_mm);
  const double beside_mm = largest(glm::max(least - high, low - most) * spacing_mm);
  const std::string images = " the images of " + text.source.string();
  if (beside_mm >= 0.0) {
    const std::string said = text.in.string() + ": lies wholly beside" + images + ", by " +
                             three_figures(beside_mm) +
                             " mm: was it made of another scan, or is its frame wrong (--frame)?";
    if (!text.other_identity)
      throw std::runtime_error(said + " If this is intended, --other-identity continues and reports a FAIL");
    findings.push_back("FAIL: " + said);
  } else if (beyond_mm > std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z})) {
    // Less than a voxel is normal for objects whose voxels differ from those of the images.
    findings.push_back(text.in.string() + ": reaches beyond" + images + " by " + three_figures(beyond_mm) +
                       " mm: was it made of another scan?");
  }
}

/// Refuses options for DICOM if another format is written, because they would have no effect.
void need_used(const ConvertText& text, bool writes_dicom, bool writes_segments) {
  const auto need = [&](bool is_given, const std::string& option, bool is_used, const std::string& of) {
    if (is_given && !is_used)
      throw std::runtime_error(text.out.string() + ": " + option + " is of " + of +
                               ", which is not written: leave it out, or write " + of);
  };
  need(!text.label.empty(), "--label", writes_segments, "a DICOM segmentation (.dcm)");
  need(!text.source.empty(), "--source", writes_dicom, "DICOM (a folder or .dcm)");
  need(text.other_identity, "--other-identity", writes_dicom, "DICOM (a folder or .dcm)");
  if (text.other_identity && text.source.empty())
    throw std::runtime_error("--other-identity needs --source: give it, or leave both out");
}

/// Adds findings to the JSON and prints them as warnings.
void tell(const std::vector<std::string>& findings, Json& json) {
  json["findings"] = findings;
  for (const std::string& finding : findings) warn_finding(finding);
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
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(text.in.string() +
                             ": only a binary octree is a segmentation: choose an object of the samples with "
                             "octotomy octree --window LOW:HIGH");
  std::vector<std::string> findings;
  voxel::DicomSegOptions options;
  options.label = !text.label.empty() ? text.label : file.name.empty() ? "Object" : file.name.substr(0, 64);
  options.series_description = "Octotomy, segmented";
  options.progress.stop = program.stop.get_token();
  {
    const Stopwatch watch(timings, "source");
    options.source = source_of(program, text, false, {}, findings);
  }
  if (!options.source) warn("no --source: the segmentation gets a study of its own and refers to no images");
  if (options.source) need_on_source(text, *options.source, box_around({{options.label, *octree}}), findings);
  {
    const Stopwatch watch(timings, "write");
    voxel::write_dicom_seg(*octree, text.out, options);
  }
  Json json = octree_answer(file, fs::file_size(text.in), timings);
  json["path"] = text.out.string();
  json["label"] = options.label;
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(findings, json);
  program.say(json, lines({{"written", text.out.string()},
                           {"segment", options.label},
                           {"voxels", std::to_string(octree->voxel_count())}}));
  return done;
}

/// Converts a label map to a DICOM segmentation of its labels, on its own slices and with its own names.
int convert_labels(const Program& program, const ConvertText& text) {
  need_used(text, true, true);
  need_folder_of(text.out);
  Timings timings;
  const voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  const std::vector<voxel::Label> labels = voxel::labels(scene);
  constexpr std::size_t most_labels = 1024;
  if (labels.empty() || labels.size() > most_labels)
    throw std::runtime_error(text.in.string() + ": holds " + std::to_string(labels.size()) +
                             " labels, so it is not a label map: octotomy segment makes objects from a scan");
  std::set<int> occurring;
  for (const voxel::Label& label : labels) occurring.insert(label.number);
  const LabelTable table = label_table_of(text.in, occurring);
  std::vector<std::string> findings = table.passed_over;
  for (std::string& line : findings_of_labels(labels)) findings.push_back(std::move(line));
  const voxel::Universe universe = voxel::universe_on(scene.lattice);
  std::vector<voxel::DicomSegment> segments;
  Json said = Json::array();
  std::vector<std::pair<std::string, std::string>> rows{{"written", text.out.string()}};
  for (const voxel::Label& label : labels) {
    const auto named = table.names.find(label.number);
    const std::string name =
        named == table.names.end() ? "label " + std::to_string(label.number) : named->second.substr(0, 64);
    segments.push_back({name, voxel::octree_of_label(universe, scene, label.number)});
    said.push_back(
        {{"segment", segments.size()}, {"label", label.number}, {"name", name}, {"samples", label.samples}});
    rows.emplace_back(name, std::to_string(label.samples) + " samples");
  }
  voxel::DicomSegOptions options;
  options.label = text.label.empty() ? "Objects" : text.label;
  options.series_description = "Octotomy, segmented";
  options.progress.stop = program.stop.get_token();
  options.source = source_of(program, text, false, scene.identity, findings);
  if (!options.source) warn("no --source: the segmentation gets a study of its own and refers to no images");
  if (options.source) need_on_source(text, *options.source, box_around(segments), findings);
  {
    const Stopwatch watch(timings, "write");
    voxel::write_dicom_seg(segments, text.out, options);
  }
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["segments"] = std::move(said);
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(findings, json);
  program.say(json, lines(rows));
  return done;
}

int convert(const Program& program, const ConvertText& text) {
  if (text.out.extension() == ".dcm" && !text.dicom) return convert_labels(program, text);
  const bool folder = text.dicom || !text.out.has_extension();
  if (!folder && !is_volume(text.out))
    throw std::runtime_error(text.out.string() +
                             ": unknown kind of scan; use .nrrd, .nii.gz or .mha, or a folder for DICOM");
  need_used(text, folder, false);
  need_folder_of(text.out, folder ? Output::Folder : Output::File);
  Timings timings;
  const voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  const LabelTable table = names_of_labels(scene, text.in);
  std::vector<std::string> findings = table.passed_over;
  if (!folder && !table.names.empty()) need_label_table(text.out, table.names);
  {
    const Stopwatch watch(timings, "write");
    if (folder) {
      if (!table.names.empty())
        findings.push_back(
            "the names of the labels are left out, as a DICOM series of images has no place "
            "for them: a DICOM segmentation (.dcm without --dicom) keeps them");
      voxel::DicomOptions options;
      options.series_description = "Octotomy, derived";
      if (scene.modality.empty())
        findings.push_back(text.in.string() + " does not state its modality: written as CT");
      if (voxel::is_written_as_secondary_capture(scene))
        findings.push_back("the modality " + scene.modality + " is written as Secondary Capture images" +
                           (scene.declared_unit.empty() ? "" : " with the unit " + scene.declared_unit) +
                           ": the attributes of its own kind of image are left out");
      options.source = source_of(program, text, is_dicom(scene), scene.identity, findings);
      if (options.source && !text.source.empty())
        need_on_source(text, *options.source, voxel::bounds(scene.lattice), findings);
      if (!options.source) {
        options.patient_name =
            scene.identity.patient_name.empty() ? "Anonymous" : scene.identity.patient_name;
        findings.push_back("no --source: the series is of '" + options.patient_name +
                           "', in a study of its own, and refers to no images");
      }
      if (const double off = voxel::dicom_rounding(scene); off > 0.0)
        findings.push_back("values are rounded by up to " + three_figures(off) +
                           " as DICOM stores them in 16 bits: a .nrrd or .nii.gz keeps them");
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
  tell(findings, json);
  program.say(json, lines({{"written", text.out.string()}, {"samples", dims_text(scene.lattice.dims)}}));
  return done;
}

}  // namespace

void add_convert(Program& program) {
  const auto text = std::make_shared<ConvertText>();
  CLI::App& verb =
      program.verb("convert",
                   "Writes a scan in another format, resampled to a regular lattice if necessary; an octree "
                   "or a label map as a DICOM segmentation",
                   "octotomy convert dicom_folder -o head.nii.gz\n"
                   "  octotomy convert 'slices/*.tif' --spacing 0.5,0.5,1 -o head.nrrd\n"
                   "  octotomy convert head.raw --raw 512x512x300 int16 --spacing 0.5,0.5,1 -o head.nrrd\n"
                   "  octotomy convert skull.octree -o skull.dcm --source dicom_folder --label Skull\n"
                   "  octotomy convert organs.nii.gz -o organs.dcm --source dicom_folder",
                   [&program, text] {
                     return is_octree(text->in) ? convert_octree(program, *text) : convert(program, *text);
                   });
  verb.add_option("scan", text->in,
                  "A DICOM folder or file, NIfTI, NRRD, MetaImage, images, a raw file, or a binary .octree")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out,
                  "A .nrrd, .nii.gz or .mha file, or a folder for DICOM; of an .octree or a label map a .dcm")
      ->required();
  verb.add_flag("--dicom", text->dicom, "Write a DICOM series into the folder");
  verb.add_option("--source", text->source,
                  "The DICOM series to which written DICOM refers; default: the scan, if it is DICOM")
      ->check(CLI::ExistingPath);
  verb.add_flag("--other-identity", text->other_identity,
                "Accept a source that states another patient, study or frame of reference than the scan, or "
                "whose images lie elsewhere, and report a FAIL");
  verb.add_option("--label", text->label, "Label of a segmentation; default: the octree's name");
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
