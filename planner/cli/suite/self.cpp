// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Checks each part that the program starts or loads: whether it exists, has the program's build mark, and
// solves a small task with a known result. Lists the libraries and their known faults.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iterator>
#include <optional>

#include "convert/tet/mesher_process.h"
#include "planner/cli/suite/suites.h"
#include "planner/network/curl_library.h"
#include "planner/operation/table/fault.h"
#include "planner/result/pack/known_faults.h"
#include "planner/result/pack/library_versions.h"
#include "voxel/dicom/dicom_codec.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/helper_file.h"

extern "C" const char octotomy_build_mark[];

namespace octotomy::planner::cli {
namespace {

/// The beginning of the build's mark, up to the word that identifies the build.
std::string mark_prefix() {
  return "octotomy build mark ";
}

/// The build's mark in a file; empty if the file contains none.
std::string mark_in(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t at = bytes.find(mark_prefix());
  if (at == std::string::npos) return {};
  const std::size_t end = bytes.find(' ', at + mark_prefix().size());
  return bytes.substr(at, end == std::string::npos ? end : end + 1 - at);
}

/// A tetrahedron with edges of about 10 mm.
convert::MesherInput tetrahedron() {
  return {{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
          {},
          {5.0, 5.0, 5.0, 5.0}};
}

bool is_filled(const convert::MesherOutcome& outcome, double least_mm3, double most_mm3) {
  double six_volumes = 0.0;
  for (const auto& tet : outcome.tetrahedra) {
    const glm::dvec3& p = outcome.points_mm[tet[0]];
    six_volumes +=
        std::abs(glm::dot(outcome.points_mm[tet[1]] - p,
                          glm::cross(outcome.points_mm[tet[2]] - p, outcome.points_mm[tet[3]] - p)));
  }
  return !outcome.failure && six_volumes >= 6.0 * least_mm3 && six_volumes <= 6.0 * most_mm3;
}

bool tetgen_fills() {
  return is_filled(convert::run_tetgen(tetrahedron(), "pYQ", {}), 166.6, 166.7);
}

bool mesh3_fills() {
  convert::MesherInput input = tetrahedron();
  input.holes_mm = input.points_mm;
  return is_filled(convert::run_mesh3(input, convert::Mesh3Sizes(), {}), 100.0, 200.0);
}

/// Whether the mesher fills the labels of a cube of six voxels along a side, with an empty border.
bool mesh3_fills_labels() {
  constexpr int side = 12, low = 3, high = 8;
  convert::LabelImage image{
      glm::ivec3(side), glm::dvec3(1.0), std::vector<std::uint8_t>(side * side * side, 0), {}};
  for (int z = low; z <= high; ++z)
    for (int y = low; y <= high; ++y)
      for (int x = low; x <= high; ++x) image.labels[static_cast<std::size_t>(x + side * (y + side * z))] = 1;
  for (const double at : {low - 0.5, high + 0.5})
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 p(0.5 * (low + high));
      p[axis] = at;
      image.start_mm.push_back(p);
    }
  return is_filled(convert::run_mesh3(image, {2.0, 0.3, 3.0}, {}), 150.0, 230.0);
}

/// Whether the codec decompresses two rows of three run-length coded pixels, 0 1 2 and 3 3 3.
bool codec_decompresses() {
  std::string frame(64, '\0');
  frame[0] = 1;   // segments
  frame[4] = 64;  // offset of the first segment
  frame += std::string("\x02\x00\x01\x02\xfe\x03", 6);
  voxel::CompressedFrame compressed{"1.2.840.10008.1.2.5", 3, 2, 8, 8, 7, false, {frame}};
  return voxel::decompress(compressed) == std::string("\x00\x01\x02\x03\x03\x03", 6);
}

bool image_is_encoded() {
  const std::vector<std::uint8_t> jpeg = voxel::encode_image("jpeg", {2, 1}, {255, 0, 0, 0, 0, 255});
  return jpeg.size() > 2 && jpeg[0] == 0xff && jpeg[1] == 0xd8;
}

struct Part {
  const char* file;
  const char* does;
  bool (*works)();
};
constexpr Part parts[] = {{"octotomy-tetgen", "tetrahedra by TetGen", tetgen_fills},
                          {"octotomy-mesh3", "tetrahedra by Mesh_3", mesh3_fills},
                          {"octotomy-mesh3-labels", "tetrahedra of regions", mesh3_fills_labels},
                          {"octotomy_dicom_codec", "compressed DICOM", codec_decompresses},
                          {"octotomy_image_io.so", "pictures", image_is_encoded}};

/// The fault of a part of the installation; empty if the part works. Sets `path` to the part's file.
std::string trouble_of(const Part& part, std::filesystem::path& path) {
  try {
    path = voxel::helper_file(part.file);
    const std::string mark = mark_in(path);
    if (mark.empty()) return "has no mark of a build: it is damaged or of an earlier version";
    if (mark != octotomy_build_mark) return "is of another build than the program: install both again";
    return part.works() ? "" : "starts, but its answer to a small question is wrong";
  } catch (const std::exception& error) {
    if (fault_of(error) == Fault::Cancelled) throw;
    return message_of(error);
  }
}

Json versions_of_all() {
  Json versions = library_versions();
  try {
    versions["libcurl"] = curl_library().version_info(CURLVERSION_NOW)->version;
  } catch (const voxel::Error&) {  // only DICOMweb needs it
  }
  return versions;
}

/// Whether the process that decodes DICOM is confined. None if it does not start.
std::optional<bool> decoder_is_confined() {
  try {
    return voxel::codec_facts().is_confined;
  } catch (const voxel::Error&) {
    return std::nullopt;
  }
}

/// A line on a known fault of a library and its effect in this installation.
std::string meaning_of(const KnownFault& fault, const Json& versions, bool is_confined) {
  std::string text = fault.library;
  if (versions.contains(fault.library)) text += " " + versions[fault.library].get<std::string>();
  text += ", " + fault.effect;
  if (!fault.repaired_in.empty()) text += ", until " + fault.repaired_in;
  switch (fault.place) {
    case KnownFault::Place::NotLinked:
      return text + ": not linked, " + fault.reason;
    case KnownFault::Place::NotCalled:
      return text + ": not called, " + fault.reason;
    case KnownFault::Place::InProgram:
      return text + ": called in this program, " + fault.reason;
    case KnownFault::Place::InDecoder:
      break;
  }
  return text + (is_confined ? ": can at worst end the confined process that decodes"
                             : ": WARN, the process that decodes is not confined on this system");
}

SuiteAnswer run_self(Program& program, const VerifyText&) {
  SuiteAnswer answer;
  const Stopwatch watch(answer.timings, "self");
  const std::string build =
      std::string(octotomy_build_mark).substr(mark_prefix().size(), 16);  // enough to distinguish builds
  Json told = Json::array();
  std::vector<std::pair<std::string, std::string>> rows{{"octotomy", OCTOTOMY_VERSION ", build " + build}};
  for (const Part& part : parts) {
    if (program.stop.stop_requested()) throw Stopped("stopped between parts");
    std::filesystem::path path;
    const std::string trouble = trouble_of(part, path);
    answer.held = answer.held && trouble.empty();
    told.push_back({{"part", part.file},
                    {"does", part.does},
                    {"path", path.string()},
                    {"works", trouble.empty()},
                    {"trouble", trouble.empty() ? Json(nullptr) : Json(trouble)}});
    rows.emplace_back(
        part.file, trouble.empty() ? std::string("same build, works: ") + part.does : "NOT FIT: " + trouble);
  }
  const Json libraries = versions_of_all();
  std::string listed;
  for (const auto& [name, version] : libraries.items())
    listed += (listed.empty() ? "" : ", ") + name + " " + version.get<std::string>();
  rows.emplace_back("libraries", listed);
  const std::optional<bool> is_confined = decoder_is_confined();
  const std::string limits = !is_confined ? "does not start; its libraries and their faults are not listed"
                             : *is_confined
                                 ? "which may use no network, start no program and change no file outside of "
                                   "its own folder"
                                 : "WARN, not confined: this system lacks Landlock or seccomp";
  rows.emplace_back("decoder", is_confined ? "a separate process of at most 4 GB, " + limits : limits);
  Json faults = Json::array();
  for (const KnownFault& fault : faults_of(libraries)) {
    const std::string meaning = meaning_of(fault, libraries, is_confined.value_or(false));
    rows.emplace_back(fault.name, meaning);
    faults.push_back({{"library", fault.library},
                      {"fault", fault.name},
                      {"repaired_in", fault.repaired_in.empty() ? Json(nullptr) : Json(fault.repaired_in)},
                      {"reached", fault.place == KnownFault::Place::InDecoder ||
                                      fault.place == KnownFault::Place::InProgram},
                      {"meaning", meaning}});
  }
  answer.more = {{"build", build},
                 {"parts", told},
                 {"libraries", libraries},
                 {"decoder_is_confined", is_confined ? Json(*is_confined) : Json(nullptr)},
                 {"known_faults", faults}};
  answer.text = lines(rows);
  return answer;
}

CLI::Option* add_self(CLI::App& verb, VerifyText& text) {
  return verb.add_flag("--self", text.self,
                       "A suite: checks that the installed parts are of one build, start and work; lists the "
                       "libraries, and the known faults of those that read data of unknown origin");
}

}  // namespace

const Suite self_suite{add_self, run_self};

}  // namespace octotomy::planner::cli
