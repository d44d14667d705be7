// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/mesh_in.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>

namespace octotomy::planner {
namespace {

using AuditsByPath = std::map<std::filesystem::path, std::vector<brep::MeshFinding>>;

/// Shared by the whole process, because a run of the program executes one verb.
struct MeshReading {
  std::mutex mutex;
  std::vector<std::string> frames, units;
  AuditsByPath read, landmarks;
};
MeshReading& mesh_reading() {
  static MeshReading of_process;
  return of_process;
}

std::vector<MeshRecord> records_of(AuditsByPath MeshReading::*read) {
  MeshReading& now = mesh_reading();
  const std::lock_guard lock(now.mutex);
  std::vector<MeshRecord> made;
  for (const auto& [path, audit] : now.*read) made.push_back({path, audit});
  return made;
}

/// "RAS" of "box.stl=RAS".
std::string choice_of(const std::string& word) {
  return word.substr(word.rfind('=') + 1);
}

bool names(const std::string& word, const std::filesystem::path& path) {
  const std::size_t equals = word.rfind('=');
  if (equals == std::string::npos) return false;
  const std::string name = word.substr(0, equals);
  return name == path.string() || name == path.filename().string();
}

/// The word chosen for a file: the one that names the file, else the one that names no file; null if there is
/// neither.
std::optional<std::string> chosen(const std::vector<std::string>& words, const std::filesystem::path& path) {
  std::optional<std::string> made;
  for (const std::string& word : words)
    if (word.find('=') == std::string::npos) made = word;
  for (const std::string& word : words)
    if (names(word, path)) made = choice_of(word);
  return made;
}

}  // namespace

void choose_mesh_reading(const std::vector<std::string>& frames, const std::vector<std::string>& units) {
  for (const std::string& word : frames)
    if (!brep::frame_named(choice_of(word)))
      throw std::runtime_error("--frame: '" + word +
                               "' is not a frame: write three letters for the directions of x, y and z, such "
                               "as LPS or RAS, or FILE=RAS for one file");
  for (const std::string& word : units)
    if (!brep::length_unit(choice_of(word)))
      throw std::runtime_error("--unit: '" + word +
                               "' is not a unit: write um, mm, cm, m or inch, or FILE=inch for one file");
  MeshReading& now = mesh_reading();
  const std::lock_guard lock(now.mutex);
  now.frames = frames;
  now.units = units;
  now.read.clear();
  now.landmarks.clear();
}

brep::Triangles read_mesh_in(const std::filesystem::path& path, const brep::MeshReadOptions& options) {
  brep::MeshFile file = brep::read_mesh(path, options);
  MeshReading& now = mesh_reading();
  const std::lock_guard lock(now.mutex);
  now.read[path] = std::move(file.audit);
  return std::move(file.triangles);
}

brep::Triangles read_mesh_in(const std::filesystem::path& path) {
  brep::MeshReadOptions options;
  {
    MeshReading& now = mesh_reading();
    const std::lock_guard lock(now.mutex);
    options = {chosen(now.frames, path), chosen(now.units, path)};
  }
  return read_mesh_in(path, options);
}

std::vector<MeshRecord> meshes_read() {
  return records_of(&MeshReading::read);
}

std::vector<std::string> unused_choices() {
  MeshReading& now = mesh_reading();
  const std::lock_guard lock(now.mutex);
  std::vector<std::string> unused;
  for (const auto& [option, words] : {std::pair{"--frame ", &now.frames}, std::pair{"--unit ", &now.units}})
    for (const std::string& word : *words)
      if (word.find('=') != std::string::npos &&
          std::none_of(now.read.begin(), now.read.end(),
                       [&](const auto& read) { return names(word, read.first); }))
        unused.push_back(option + word);
  return unused;
}

void keep_landmark_audit(const std::filesystem::path& path, std::vector<brep::MeshFinding> audit) {
  MeshReading& now = mesh_reading();
  const std::lock_guard lock(now.mutex);
  now.landmarks[path] = std::move(audit);
}

std::vector<MeshRecord> landmark_files_read() {
  return records_of(&MeshReading::landmarks);
}

Json to_json(const std::vector<brep::MeshFinding>& audit) {
  Json lines = Json::array();
  for (const brep::MeshFinding& finding : audit)
    lines.push_back({{"check", finding.check},
                     {"verdict", brep::to_string(finding.verdict)},
                     {"detail", finding.detail}});
  return lines;
}

std::vector<std::string> warnings_of(const std::vector<brep::MeshFinding>& audit) {
  std::vector<std::string> lines;
  for (const brep::MeshFinding& finding : audit)
    if (finding.verdict != brep::MeshVerdict::Pass) lines.push_back(finding.check + ": " + finding.detail);
  return lines;
}

}  // namespace octotomy::planner
