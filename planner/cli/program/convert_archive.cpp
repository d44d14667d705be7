// SPDX-License-Identifier: AGPL-3.0-or-later
// DICOM objects for other programs: structure sets, shares of voxels, and surfaces.
#include <cmath>

#include "brep/io/write_mesh.h"
#include "convert/voxel/voxelise_partial.h"
#include "planner/cli/program/convert_source.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/pdf.h"
#include "voxel/archive/occupancy.h"
#include "voxel/archive/write_dicom_document.h"
#include "voxel/archive/write_rtstruct.h"
#include "voxel/filter/label_map.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/digitise.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

/// The objects in an .octree or a label map. Sets `identity` to that of the label map.
std::vector<voxel::DicomSegment> read_objects(const Program& program, const ConvertText& text,
                                              Timings& timings, voxel::Identity& identity,
                                              std::vector<std::string>& findings) {
  if (is_octree(text.in)) return {binary_object(text, read_timed(text.in, timings))};
  LabelObjects read = read_label_objects(program, text, timings, findings);
  identity = read.scene.identity;
  return std::move(read.objects);
}

/// The series of --source, after a check that the points of the output lie in it. None, with a warning, if no
/// series is given.
std::optional<voxel::DicomSource> source_around(const Program& program, const ConvertText& text,
                                                const voxel::Identity& identity,
                                                const std::vector<glm::dvec3>& points_mm, const char* kind,
                                                Timings& timings, std::vector<std::string>& findings) {
  const Stopwatch watch(timings, "source");
  std::optional<voxel::DicomSource> source = source_of(program, text, false, identity, findings);
  if (source)
    need_on_source(text, *source, points_mm, findings);
  else
    warn(std::string("no --source: the ") + kind + " gets a new study and refers to no images");
  return source;
}

double volume_mm3(const voxel::Octree& octree) {
  return static_cast<double>(octree.voxel_count()) * octree.universe().lattice().voxel_mm3();
}

/// Replaces each object by its samples on the lattice of the source's images, because contours are drawn on
/// these. Adds a finding for each object whose volume changes. Throws std::runtime_error if an object
/// contains no sample.
void put_on_samples(const voxel::Lattice& lattice, std::vector<voxel::DicomSegment>& objects,
                    std::vector<std::string>& findings) {
  const voxel::Octree none = voxel::Octree::empty(voxel::universe_on(lattice));
  for (voxel::DicomSegment& each : objects) {
    voxel::Octree on_samples =
        voxel::chosen_samples(lattice, none, voxel::Octree::empty(each.object.universe()), each.object);
    if (on_samples.is_empty())
      throw std::runtime_error("'" + each.label +
                               "' contains none of the source's samples: leave this object out, or give the "
                               "scan from which it was made as --source");
    const double before_mm3 = volume_mm3(each.object), after_mm3 = volume_mm3(on_samples);
    if (on_samples.voxel_count() != each.object.voxel_count() ||
        std::abs(after_mm3 - before_mm3) > 1e-6 * before_mm3)
      findings.push_back("'" + each.label + "': " + plain(std::round(10.0 * before_mm3) / 10.0) +
                         " mm3 of voxels are " + plain(std::round(10.0 * after_mm3) / 10.0) +
                         " mm3 on the samples of the source: contours follow the samples");
    each.object = std::move(on_samples);
  }
}

/// Objects, each as the filled share of every voxel of one lattice.
struct Shares {
  voxel::Lattice lattice;
  std::vector<voxel::DicomFractions> segments = {};
  std::vector<double> volumes_mm3 = {};     ///< computed before the shares are rounded
  std::vector<std::uint64_t> partial = {};  ///< number of partly filled voxels of each object
};

constexpr double most_fraction = 255.0;

/// Adds an object of partly filled voxels. The lattice begins at the voxel `first` of the object's universe.
void add_partial(const std::string& label, const voxel::PartialOctree& partial, const glm::ivec3& first,
                 Shares& shares) {
  const glm::ivec3 dims = shares.lattice.dims;
  voxel::DicomFractions made{label, std::vector<std::uint8_t>(shares.lattice.sample_count())};
  const auto at = [&](const glm::ivec3& p) -> std::uint8_t* {
    const glm::ivec3 own = p - first;
    if (glm::any(glm::lessThan(own, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(own, dims)))
      return nullptr;
    return &made.fractions[static_cast<std::size_t>(own.x) +
                           static_cast<std::size_t>(dims.x) *
                               (static_cast<std::size_t>(own.y) +
                                static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(own.z))];
  };
  std::uint64_t sum = 0, whole = 0, partly = 0;
  voxel::SliceBits slice;
  for (int z = first.z; z < first.z + dims.z; ++z) {
    voxel::read_slice(partial.inside, z, slice);
    for (int y = first.y; y < first.y + dims.y; ++y)
      for (int x = first.x; x < first.x + dims.x; ++x)
        if ((slice.row(y)[x / 64] >> (x % 64)) & 1) {
          *at({x, y, z}) = static_cast<std::uint8_t>(most_fraction);
          ++whole;
        }
  }
  voxel::for_each_boundary_voxel(partial, [&](const glm::ivec3& p, std::uint16_t fraction) {
    std::uint8_t* const to = at(p);
    if (to == nullptr) return;
    sum += fraction;
    *to = static_cast<std::uint8_t>(std::lround(most_fraction * fraction / voxel::PartialOctree::whole));
    partly += fraction > 0 && fraction < voxel::PartialOctree::whole;
  });
  shares.volumes_mm3.push_back(
      (static_cast<double>(whole) + static_cast<double>(sum) / voxel::PartialOctree::whole) *
      shares.lattice.voxel_mm3());
  shares.partial.push_back(partly);
  shares.segments.push_back(std::move(made));
}

/// Adds an object by its shares, one for each sample of the lattice in the lattice's order. Shares above 1
/// count as 1.
template <typename Share>
void add_shares(const std::string& label, const std::vector<Share>& from, Shares& shares) {
  voxel::DicomFractions made{label, std::vector<std::uint8_t>(shares.lattice.sample_count())};
  double sum = 0.0;
  std::uint64_t partly = 0;
  // A share within this distance of 0 or 1 differs from it only by rounding.
  constexpr double rounding = 1e-9;
  for (std::size_t i = 0; i < made.fractions.size(); ++i) {
    const auto share = static_cast<double>(from[i]);
    sum += share;
    partly += share > rounding && share < 1.0 - rounding;
    made.fractions[i] = static_cast<std::uint8_t>(std::lround(most_fraction * std::min(share, 1.0)));
  }
  shares.volumes_mm3.push_back(sum * shares.lattice.voxel_mm3());
  shares.partial.push_back(partly);
  shares.segments.push_back(std::move(made));
}

/// Adds an object by the exact share of each voxel. If the object's axes are rotated against the lattice's,
/// digitise_partial() estimates the shares, and a finding states their volume.
void add_object(const voxel::DicomSegment& object, const voxel::Progress& progress, Shares& shares,
                std::vector<std::string>& findings) {
  if (const auto exact = voxel::occupancy(object.object, shares.lattice, progress)) {
    add_shares(object.label, *exact, shares);
    return;
  }
  add_partial(object.label,
              voxel::digitise_partial(voxel::universe_on(shares.lattice), voxel::Expression(object.object)),
              glm::ivec3(0), shares);
  findings.push_back(
      "'" + object.label +
      "': its voxels are rotated relative to the source's voxels, so their shares are estimated: " +
      three_figures(shares.volumes_mm3.back()) + " mm3 in place of " +
      three_figures(volume_mm3(object.object)) + " mm3; shares of a surface are exact");
}

/// Whether samples are shares, not labels: all lie from 0 to 1, and at least one lies between.
bool holds_shares(const voxel::Scene& scene) {
  const auto* const samples = std::get_if<voxel::FloatSamples>(&scene.samples);
  const voxel::Range range = voxel::range(scene);
  return samples != nullptr && scene.meaning != voxel::Meaning::Label && range.low >= 0.0 &&
         range.high <= 1.0 && std::any_of(samples->begin(), samples->end(), [](float share) {
           return share > 0.0F && share < 1.0F;
         });
}

/// The object's label: that of --label, or else the file's name. If the identity is not kept, "Object"
/// replaces the file's name, because it may name the patient.
std::string label_of(const ConvertText& text) {
  if (!text.label.empty()) return text.label;
  return text.keeps_identity() ? text.in.stem().string().substr(0, 64) : "Object";
}

/// The block of a universe's voxels around an object, as a lattice, and the index of the block's first voxel.
std::pair<voxel::Lattice, glm::ivec3> lattice_around(const voxel::Octree& object) {
  const voxel::Universe& universe = object.universe();
  const voxel::Box box = voxel::extents_of(object).value_or(voxel::Box{});
  glm::dvec3 low(universe.side()), high(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = universe.lattice().voxel({corner & 1 ? box.high_mm.x : box.low_mm.x,
                                                   corner & 2 ? box.high_mm.y : box.low_mm.y,
                                                   corner & 4 ? box.high_mm.z : box.low_mm.z});
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::ivec3 first = glm::max(glm::ivec3(glm::floor(low)), glm::ivec3(0));
  const glm::ivec3 last = glm::min(glm::ivec3(glm::ceil(high)), glm::ivec3(universe.side() - 1));
  voxel::Lattice lattice{last - first + 1, universe.lps_from_voxel};
  lattice.lps_from_voxel[3] = universe.lps_from_voxel * glm::dvec4(first, 1.0);
  return {lattice, first};
}

/// Computes how much of each voxel of the source's images the objects fill. An input that consists of shares
/// keeps its own shares.
class ShareMaker {
 public:
  ShareMaker(const Program& program, const ConvertText& text, Timings& timings,
             std::vector<std::string>& findings)
      : program_(program), text_(text), timings_(timings), findings_(findings) {}

  Shares made() {
    if (is_mesh(text_.in)) return of_mesh();
    if (is_octree(text_.in)) return of_octree();
    return of_scan();
  }

  std::optional<voxel::DicomSource> source = std::nullopt;

 private:
  void find_source(const voxel::Identity& identity, const std::vector<glm::dvec3>& points_mm) {
    source = source_around(program_, text_, identity, points_mm, "segmentation", timings_, findings_);
  }

  Shares on_source(const char* what) const {
    if (!source)
      throw std::runtime_error(text_.in.string() + ": " + what +
                               " has no voxels of a scan: give the scan's DICOM series as --source");
    return {source->around};
  }

  Shares of_mesh() {
    if (!text_.scan.frame.empty() || !text_.scan.unit.empty())
      choose_mesh_reading(words(text_.scan.frame), words(text_.scan.unit));
    const brep::Solid solid = read_solid(text_.in, timings_);
    find_source({}, solid.triangles().points_mm);
    Shares shares = on_source("a surface");
    const Stopwatch watch(timings_, "voxelise");
    add_partial(label_of(text_),
                convert::voxelise_partial(voxel::universe_on(shares.lattice), solid.linked(),
                                          {program_.stop.get_token(), {}}),
                glm::ivec3(0), shares);
    return shares;
  }

  Shares of_octree() {
    const voxel::OctreeFile file = read_timed(text_.in, timings_);
    if (const auto* partial = std::get_if<voxel::PartialOctree>(&file.tree)) {
      const auto [lattice, first] = lattice_around(partial->touching);
      find_source({}, corners_of(lattice));
      Shares shares{lattice};
      add_partial(!text_.label.empty() ? text_.label
                  : file.name.empty()  ? label_of(text_)
                                       : file.name.substr(0, 64),
                  *partial, first, shares);
      return shares;
    }
    return of_objects({binary_object(text_, file)}, {});
  }

  Shares of_objects(const std::vector<voxel::DicomSegment>& objects, const voxel::Identity& identity) {
    find_source(identity, corners_of(objects));
    Shares shares = on_source("an object");
    const Stopwatch watch(timings_, "digitise");
    for (const voxel::DicomSegment& each : objects)
      add_object(each, {program_.stop.get_token(), {}}, shares, findings_);
    return shares;
  }

  Shares of_scan() {
    const voxel::Scene scene = read_scan(program_, text_.in, text_.scan, timings_);
    if (!holds_shares(scene)) {
      LabelObjects read = read_label_objects(program_, text_, timings_, findings_);
      return of_objects(read.objects, read.scene.identity);
    }
    ConvertText words = text_;
    words.scan.series.clear();  // --series names a series of the input, not of the source
    source = source_around(program_, words, scene.identity, corners_of(scene.lattice), "segmentation",
                           timings_, findings_);
    Shares shares{scene.lattice};
    const auto& samples = std::get<voxel::FloatSamples>(scene.samples);
    add_shares(label_of(text_), std::vector<float>(samples.begin(), samples.end()), shares);
    return shares;
  }

  static std::vector<std::string> words(const std::string& word) {
    return word.empty() ? std::vector<std::string>() : std::vector<std::string>{word};
  }

  const Program& program_;
  const ConvertText& text_;
  Timings& timings_;
  std::vector<std::string>& findings_;
};

}  // namespace

int convert_structures(const Program& program, const ConvertText& text) {
  Timings timings;
  std::vector<std::string> findings;
  voxel::Identity identity;
  std::vector<voxel::DicomSegment> objects = read_objects(program, text, timings, identity, findings);
  voxel::RtstructOptions options;
  options.label = !text.label.empty() ? text.label : objects.size() == 1 ? objects.front().label : "Objects";
  options.series_description = "Octotomy, contours";
  options.planes = text.planes == "voxels" ? voxel::ContourPlanes::Voxels : voxel::ContourPlanes::Images;
  options.progress.stop = program.stop.get_token();
  options.source =
      source_around(program, text, identity, corners_of(objects), "structure set", timings, findings);
  if (options.source) put_on_samples(options.source->around, objects, findings);
  std::vector<voxel::ContouredObject> drawn;
  {
    const Stopwatch watch(timings, "write");
    drawn = voxel::write_rtstruct(objects, text.out, options);
  }
  Json json = answer(timings);
  json["kind"] = "DICOM structure set";
  json["path"] = text.out.string();
  json["structures"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows{{"written", text.out.string()}};
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const voxel::ContouredObject& each = drawn[i];
    json["structures"].push_back({{"number", i + 1},
                                  {"name", each.name},
                                  {"planes", each.planes},
                                  {"contours", each.contours},
                                  {"holes", each.holes},
                                  {"points", each.points},
                                  {"voxels", objects[i].object.voxel_count()},
                                  {"volume_mm3", volume_mm3(objects[i].object)}});
    rows.emplace_back(
        each.name, std::to_string(each.contours) + " contours on " + std::to_string(each.planes) + " planes");
    if (each.planes_left_out > 0 || each.farthest_mm > 0.01)
      findings.push_back(
          "'" + each.name +
          "': the images are not equally spaced, or lie between the planes of the object's voxels: contours "
          "are up to " +
          three_figures(each.farthest_mm) + " mm off the voxels' centres, and " +
          std::to_string(each.planes_left_out) +
          " planes of voxels have no contour; --planes voxels draws on these planes");
  }
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines(rows));
  return done;
}

int convert_fractions(const Program& program, const ConvertText& text) {
  Timings timings;
  std::vector<std::string> findings;
  ShareMaker maker(program, text, timings, findings);
  const Shares shares = maker.made();
  voxel::DicomSegOptions options;
  options.label = !text.label.empty()           ? text.label
                  : shares.segments.size() == 1 ? shares.segments.front().label
                                                : "Objects";
  options.series_description = "Octotomy, shares";
  options.source = maker.source;
  options.progress.stop = program.stop.get_token();
  {
    const Stopwatch watch(timings, "write");
    voxel::write_dicom_fractions(shares.lattice, shares.segments, text.out, options);
  }
  Json json = answer(timings);
  json["kind"] = "DICOM segmentation";
  json["path"] = text.out.string();
  json["segments"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows{{"written", text.out.string()}};
  for (std::size_t i = 0; i < shares.segments.size(); ++i) {
    double sum = 0.0;
    for (const std::uint8_t fraction : shares.segments[i].fractions) sum += fraction;
    const double written_mm3 = sum / most_fraction * shares.lattice.voxel_mm3();
    // Rounding changes a share by at most half a step of 1/255.
    const double bound_mm3 =
        static_cast<double>(shares.partial[i]) * 0.5 / most_fraction * shares.lattice.voxel_mm3();
    json["segments"].push_back({{"segment", i + 1},
                                {"name", shares.segments[i].label},
                                {"partial_voxels", shares.partial[i]},
                                {"volume_mm3", written_mm3},
                                {"exact_volume_mm3", shares.volumes_mm3[i]},
                                {"rounding_mm3", bound_mm3}});
    rows.emplace_back(shares.segments[i].label, grouped(written_mm3, 1) + " mm\u00b3, " +
                                                    grouped(static_cast<double>(shares.partial[i]), 0) +
                                                    " voxels partly filled");
  }
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines(rows));
  return done;
}

int convert_report(const Program& program, const ConvertText& text) {
  const std::string bytes = voxel::file_bytes(text.in);
  if (!bytes.starts_with("%PDF-") ||
      bytes.find("%%EOF", bytes.size() - std::min<std::size_t>(bytes.size(), 2048)) == std::string::npos)
    throw std::runtime_error(
        text.in.string() +
        ": is no whole PDF: it has to begin with %PDF- and to end with %%EOF; octotomy run "
        "--pdf writes one");
  if (!text.keeps_identity() &&
      bytes.find(anonymous_pdf_mark, bytes.size() - std::min<std::size_t>(bytes.size(), 2048)) ==
          std::string::npos)
    throw std::runtime_error(text.in.string() + ": --identity " + text.identity +
                             " takes only a PDF whose pages name nobody, because pages cannot be changed "
                             "here: octotomy run --pdf --identity "
                             "remove writes one");
  Timings timings;
  std::vector<std::string> findings;
  voxel::DicomDocumentOptions options;
  options.label = label_of(text);
  options.series_description = "Octotomy, report";
  {
    const Stopwatch watch(timings, "source");
    options.source = source_of(program, text, false, {}, findings);
  }
  if (!options.source) warn("no --source: the report gets a new study and names no patient");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_dicom_document(bytes, voxel::DocumentFormat::Pdf, text.out, options);
  }
  Json json = answer(timings);
  json["kind"] = "DICOM encapsulated PDF";
  json["path"] = text.out.string();
  json["label"] = options.label;
  json["bytes"] = bytes.size();
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines({{"written", text.out.string()}, {"report", options.label}}));
  return done;
}

int convert_model(const Program& program, const ConvertText& text) {
  Timings timings;
  std::vector<std::string> findings;
  choose_mesh_reading(text.scan.frame.empty() ? std::vector<std::string>() : std::vector{text.scan.frame},
                      text.scan.unit.empty() ? std::vector<std::string>() : std::vector{text.scan.unit});
  brep::Triangles triangles;
  {
    const Stopwatch watch(timings, "read");
    triangles = read_mesh_in(text.in);
  }
  for (const MeshRecord& mesh : meshes_read())
    for (const std::string& line : warnings_of(mesh.audit))
      findings.push_back(text.in.string() + ": " + line);
  const bool is_obj = text.as == "obj" || (text.as.empty() && voxel::extension_of(text.in) == ".obj");
  voxel::DicomDocumentOptions options;
  options.label = label_of(text);
  options.series_description = "Octotomy, surface";
  options.source = source_around(program, text, {}, triangles.points_mm, "surface", timings, findings);
  {
    const Stopwatch watch(timings, "write");
    // The mesh is written to a new file in LPS millimetres, because the input may have another frame or unit.
    const voxel::StagedFiles staging(text.out.parent_path());
    const fs::path file = staging.folder() / (is_obj ? "model.obj" : "model.stl");
    brep::write_mesh(triangles, file);
    voxel::write_dicom_document(voxel::file_bytes(file),
                                is_obj ? voxel::DocumentFormat::Obj : voxel::DocumentFormat::Stl, text.out,
                                options);
  }
  Json json = answer(timings);
  json["kind"] = is_obj ? "DICOM encapsulated OBJ" : "DICOM encapsulated STL";
  json["path"] = text.out.string();
  json["label"] = options.label;
  json["unit"] = "mm";
  json["vertices"] = triangles.points_mm.size();
  json["faces"] = triangles.faces.size();
  json["source_images"] = options.source ? Json(options.source->images.size()) : Json(nullptr);
  tell(text, findings, json);
  program.say(json, lines({{"written", text.out.string()},
                           {"model", options.label},
                           {"faces", grouped(static_cast<double>(triangles.faces.size()), 0)}}));
  return done;
}

}  // namespace octotomy::planner::cli
