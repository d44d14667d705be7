// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/subjects.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include "planner/operation/table/csv.h"
#include "planner/operation/table/nearest_name.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& message) {
  throw voxel::Error(voxel::ErrorCode::Input, message);
}

/// A file's name without the extension of a scan. Empty if the file has no such extension.
std::string stem_of_scan(const std::string& name) {
  static constexpr std::array<const char*, 6> extensions{".nii.gz", ".nii", ".nrrd", ".nhdr", ".mha", ".mhd"};
  for (const std::string extension : extensions)
    if (name.size() > extension.size() && name.ends_with(extension))
      return name.substr(0, name.size() - extension.size());
  return {};
}

void check_label(const std::string& label, const std::string& where) {
  const bool plain = std::all_of(label.begin(), label.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  if (label.empty() || label.size() > 100 || !plain)
    refuse(where + ": '" + label.substr(0, 100) +
           "' is no label of a subject: use at most 100 letters, digits, _ and -");
}

std::string without_prefix(const std::string& said) {
  const std::string label = voxel::trimmed(said);
  return label.starts_with("sub-") ? label.substr(4) : label;
}

/// Whether a name ends in a BIDS suffix of label maps and masks, which are drawn on a scan.
bool is_drawn(const std::string& stem) {
  const std::string end = stem.substr(stem.rfind('_') + 1);
  return end == "dseg" || end == "probseg" || end == "mask" || end == "seg" || end == "label" ||
         end == "labels" || end == "roi";
}

/// Whether a name ends in a BIDS suffix of images other than CT.
bool is_of_another_modality(const std::string& stem) {
  static const std::set<std::string> suffixes{
      "T1w",        "T2w",      "T2star", "FLAIR",  "PDw",     "PDT2",  "bold",  "cbv",
      "sbref",      "dwi",      "asl",    "m0scan", "epi",     "T1rho", "angio", "phasediff",
      "magnitude1", "fieldmap", "UNIT1",  "MEGRE",  "MP2RAGE", "pet"};
  return suffixes.contains(stem.substr(stem.rfind('_') + 1));
}

/// The first file whose name begins with another subject's label than its folder has; none if there is no
/// such file.
std::optional<fs::path> file_of_another(const std::string& label, const std::vector<fs::path>& files) {
  const std::string own = "sub-" + label.substr(0, label.find("_ses-"));
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    if (name.starts_with("sub-") && name.substr(0, name.find_first_of("_.")) != own) return file;
  }
  return std::nullopt;
}

/// The files below a subject's or a session's folder. Sessions in a subject's folder are left out, because
/// each is a subject itself.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  auto at = fs::recursive_directory_iterator(folder);
  for (; at != fs::recursive_directory_iterator(); ++at) {
    if (at.depth() == 0 && at->is_directory() && at->path().filename().string().starts_with("ses-"))
      at.disable_recursion_pending();
    else if (at->is_regular_file())
      files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Makes a subject from a folder: finds a file for each scan of the plan. Sets `trouble` if one is missing or
/// ambiguous.
Subject subject_of_folder(const std::string& label, const fs::path& folder, const Plan& plan) {
  Subject subject{label, {}};
  subject.place = fs::absolute(folder).lexically_normal();
  std::vector<fs::path> files;
  for (const fs::path& file : files_below(folder))
    if (!stem_of_scan(file.filename().string()).empty()) files.push_back(file);
  if (const std::optional<fs::path> other = file_of_another(label, files)) {
    subject.trouble = folder.string() + ": holds " + other->filename().string() +
                      ", whose name is another subject's: move it or rename it";
    return subject;
  }
  for (const auto& [name, unused] : plan.scans) {
    std::vector<fs::path> fitting;
    for (const fs::path& file : files)
      if (stem_of_scan(file.filename().string()).ends_with("_" + name)) fitting.push_back(file);
    if (fitting.empty() && plan.scans.size() == 1)
      std::copy_if(files.begin(), files.end(), std::back_inserter(fitting), [](const fs::path& file) {
        const std::string stem = stem_of_scan(file.filename().string());
        return !is_drawn(stem) && !is_of_another_modality(stem);
      });
    if (fitting.size() == 1) {
      subject.scans[name] = fitting.front();
      continue;
    }
    subject.trouble =
        folder.string() + (fitting.empty() ? ": no scan" : ": several scans") + " for the plan's '" + name +
        "'" +
        (fitting.empty() ? ""
                         : ", " + fitting[0].filename().string() + " and " + fitting[1].filename().string()) +
        ": name one by the ending _" + name + ", or name the scans in a .csv";
  }
  return subject;
}

std::vector<fs::path> folders_in(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string().starts_with(prefix))
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

/// Adds a subject for each session in a folder, and one for scans outside of sessions.
void add_subject(const std::string& label, const fs::path& folder, const Plan& plan,
                 std::vector<Subject>& subjects) {
  const std::vector<fs::path> sessions = folders_in(folder, "ses-");
  for (const fs::path& session : sessions)
    subjects.push_back(subject_of_folder(label + "_" + session.filename().string(), session, plan));
  Subject own = subject_of_folder(label, folder, plan);
  if (sessions.empty() || !own.scans.empty()) subjects.push_back(std::move(own));
}

/// A subject that a table lists but that has no folder. Its `trouble` states this.
Subject missing_subject(const std::string& label, const fs::path& table) {
  Subject subject{label, {}};
  subject.place = fs::absolute(table).parent_path() / ("sub-" + label);
  subject.trouble =
      table.string() + ": lists sub-" + label + ", but there is no folder of this name beside it";
  return subject;
}

std::vector<std::vector<std::string>> rows_of_table(const fs::path& input) {
  std::ifstream file = voxel::opened(input);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) refuse(input.string() + ": cannot be read");
  try {
    return voxel::extension_of(input) == ".tsv" ? parse_tsv(text) : parse_csv(text);
  } catch (const voxel::Error& error) {
    refuse(input.string() + ": " + error.what());
  }
}

/// The index of the column with this name or, if there is none, of a column whose name differs only in case.
std::optional<std::size_t> column_of(const std::vector<std::string>& header, const std::string& name) {
  auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end())
    found = std::find_if(header.begin(), header.end(), [&](const std::string& other) {
      return voxel::lower_case(other) == voxel::lower_case(name);
    });
  return found == header.end() ? std::nullopt : std::optional<std::size_t>(found - header.begin());
}

/// Adds subjects that BIDS's participants.tsv lists although they have no folder.
void add_missing_subjects(const fs::path& input, std::vector<Subject>& subjects) {
  const fs::path table = input / "participants.tsv";
  if (!fs::is_regular_file(table)) return;
  const std::vector<std::vector<std::string>> rows = rows_of_table(table);
  if (rows.empty()) return;
  const std::optional<std::size_t> id = column_of(rows.front(), "participant_id");
  for (std::size_t i = 1; id && i < rows.size(); ++i) {
    if (*id >= rows[i].size()) continue;
    const std::string label = without_prefix(rows[i][*id]);
    check_label(label, table.string() + ": row " + std::to_string(i + 1));
    if (!fs::is_directory(input / ("sub-" + label))) subjects.push_back(missing_subject(label, table));
  }
}

std::vector<Subject> subjects_of_folder(const fs::path& input, const Plan& plan) {
  std::vector<Subject> subjects;
  for (const fs::path& folder : folders_in(input, "sub-")) {
    const std::string label = without_prefix(folder.filename().string());
    check_label(label, input.string());
    add_subject(label, folder, plan, subjects);
  }
  if (subjects.empty())
    refuse(input.string() +
           ": has no subject: it should contain folders sub-LABEL, or be a .csv or .tsv with the columns "
           "participant_id and scan");
  add_missing_subjects(input, subjects);
  return subjects;
}

/// Reads BIDS's table of participants, which names no scans: its subjects are the folders beside it. None if
/// a column names scans, or if no subject has a folder.
std::optional<std::vector<Subject>> folders_of_rows(const std::vector<std::vector<std::string>>& rows,
                                                    std::size_t id, const fs::path& input, const Plan& plan) {
  const std::vector<std::string>& header = rows.front();
  const auto has = [&](const std::string& name) { return column_of(header, name).has_value(); };
  if (has("scan") ||
      std::any_of(plan.scans.begin(), plan.scans.end(), [&](const auto& scan) { return has(scan.first); }))
    return std::nullopt;
  std::vector<Subject> subjects;
  bool has_folder = false;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (id >= rows[i].size()) return std::nullopt;
    const std::string label = without_prefix(rows[i][id]);
    check_label(label, input.string() + ": row " + std::to_string(i + 1));
    const fs::path folder = fs::absolute(input).parent_path() / ("sub-" + label);
    if (fs::is_directory(folder))
      add_subject(label, folder, plan, subjects);
    else
      subjects.push_back(missing_subject(label, input));
    has_folder = has_folder || fs::is_directory(folder);
  }
  if (!has_folder) return std::nullopt;
  return subjects;
}

std::vector<Subject> subjects_of_table(const fs::path& input, const Plan& plan) {
  const std::vector<std::vector<std::string>> rows = rows_of_table(input);
  if (rows.empty()) refuse(input.string() + ": is empty");
  const std::vector<std::string>& header = rows.front();
  const auto column = [&](const std::string& name) { return column_of(header, name); };
  auto id = column("participant_id");
  if (!id) id = column("subject");
  if (!id) {
    std::string row = csv_line(header);
    row.pop_back();  // removes the line's end
    refuse(input.string() + ": has no column participant_id; its first row is '" + row + "'");
  }
  if (const auto folders = folders_of_rows(rows, *id, input, plan)) return *folders;
  std::map<std::string, std::size_t> scan_columns;
  for (const auto& [name, unused] : plan.scans) {
    auto at = column(name);
    if (!at && plan.scans.size() == 1) at = column("scan");
    if (!at) refuse(input.string() + ": has no column '" + name + "' for the plan's scan");
    scan_columns[name] = *at;
  }
  std::vector<Subject> subjects;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::string where = input.string() + ": row " + std::to_string(i + 1);
    if (rows[i].size() != header.size())
      refuse(where + " has " + std::to_string(rows[i].size()) + " cells, the header " +
             std::to_string(header.size()));
    Subject subject{without_prefix(rows[i][*id]), {}};
    check_label(subject.label, where);
    for (const auto& [name, at] : scan_columns) {
      const fs::path path = rows[i][at];
      if (path.empty()) subject.trouble = where + ": names no scan for the plan's '" + name + "'";
      subject.scans[name] = fs::absolute(input.parent_path() / path).lexically_normal();
    }
    subjects.push_back(std::move(subject));
  }
  if (subjects.empty()) refuse(input.string() + ": has no row below its header");
  return subjects;
}

}  // namespace

std::uint64_t Subject::scan_bytes() const {
  std::uint64_t bytes = 0;
  std::error_code none;
  for (const auto& [name, path] : scans) {
    if (!fs::is_directory(path, none)) {
      const std::uintmax_t size = fs::file_size(path, none);
      bytes += none ? 0 : size;
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path, none))
      if (entry.is_regular_file(none)) bytes += entry.file_size(none);
  }
  return bytes;
}

std::vector<Subject> find_subjects(const fs::path& input, const Plan& plan) {
  std::vector<Subject> subjects =
      fs::is_directory(input) ? subjects_of_folder(input, plan) : subjects_of_table(input, plan);
  std::stable_sort(subjects.begin(), subjects.end(),
                   [](const Subject& a, const Subject& b) { return a.label < b.label; });
  const auto twice =
      std::adjacent_find(subjects.begin(), subjects.end(),
                         [](const Subject& a, const Subject& b) { return a.label == b.label; });
  if (twice != subjects.end()) refuse(input.string() + ": names the subject '" + twice->label + "' twice");
  return subjects;
}

std::vector<std::string> doubts_of_cohort(const fs::path& input, const Plan& plan,
                                          const std::vector<Subject>& subjects) {
  std::vector<std::string> doubts;
  std::map<fs::path, std::set<std::string>> labels;  // labels of the subjects whose scan is this file
  for (const Subject& subject : subjects)
    for (const auto& [name, path] : subject.scans) {
      std::error_code none;
      fs::path real = fs::weakly_canonical(path, none);
      labels[none ? path : real].insert(subject.label);
    }
  for (const auto& [path, sharing] : labels) {
    if (sharing.size() < 2) continue;
    std::string named;
    for (const std::string& label : sharing) named += (named.empty() ? "" : ", ") + label;
    doubts.push_back("the subjects " + named + " have one scan, " + path.string() +
                     ": their numbers are one head's, counted " + std::to_string(sharing.size()) + " times");
  }
  if (fs::is_directory(input)) return doubts;
  const std::vector<std::vector<std::string>> rows = rows_of_table(input);
  if (rows.empty()) return doubts;
  const std::vector<std::string>& header = rows.front();
  std::set<std::size_t> read;
  for (const char* name : {"participant_id", "subject"})
    if (const auto at = column_of(header, name); at && read.empty()) read.insert(*at);
  const std::size_t ids = read.size();
  for (const auto& [name, unused] : plan.scans) {
    auto at = column_of(header, name);
    if (!at && plan.scans.size() == 1) at = column_of(header, "scan");
    if (at) read.insert(*at);
  }
  if (read.size() == ids) return doubts;  // no column names scans, so the columns describe people
  std::string passed_over;
  for (std::size_t i = 0; i < header.size(); ++i)
    if (!read.contains(i)) passed_over += (passed_over.empty() ? "'" : ", '") + header[i] + "'";
  if (!passed_over.empty())
    doubts.push_back(input.string() + ": unused columns " + passed_over +
                     ": options for reading a scan, such as its unit, frame or series, belong beside its "
                     "path in the plan");
  return doubts;
}

fs::path file_of_subject(const Subject& subject, const fs::path& name) {
  if (subject.place.empty()) return {};
  fs::path found;
  const std::string wanted = name.filename().string();
  for (const fs::path& file : files_below(subject.place)) {
    const std::string own = file.filename().string();
    if (own != wanted && !own.ends_with("_" + wanted)) continue;
    if (!found.empty())
      refuse(subject.place.string() + ": several files for the plan's " + wanted + ", " + found.string() +
             " and " + file.string());
    found = file;
  }
  return found;
}

std::vector<Subject> chosen_subjects(std::vector<Subject> subjects, const std::vector<std::string>& labels) {
  if (labels.empty()) return subjects;
  std::set<std::string> wanted;
  std::vector<std::string> known;
  for (const Subject& subject : subjects) known.push_back(subject.label);
  for (const std::string& said : labels) {
    const std::string label = without_prefix(said);
    // Engines pass the complete label of one subject, which must not also choose its sessions.
    const bool is_whole = std::binary_search(known.begin(), known.end(), label);
    bool is_there = is_whole;
    for (const std::string& each : known)
      if (is_whole ? each == label : each.starts_with(label + "_ses-")) {
        wanted.insert(each);
        is_there = true;
      }
    if (!is_there)
      refuse("--participant-label: there is no subject '" + label + "'" + suggestion(label, known));
  }
  std::erase_if(subjects, [&](const Subject& subject) { return !wanted.contains(subject.label); });
  return subjects;
}

}  // namespace octotomy::planner
