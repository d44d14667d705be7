// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/pdf.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <vector>

#include "voxel/space/error.h"
#include "voxel/space/progress.h"
#include "voxel/space/spawn.h"
#include "voxel/space/unfinished_folder.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> on_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder) / name;
    std::error_code ignored;
    if (program.is_absolute() && fs::is_regular_file(program, ignored) &&
        ::access(program.c_str(), X_OK) == 0)
      return program;
  }
  return std::nullopt;
}

using Words = std::vector<std::string>;

/// The command to print a page as PDF. Empty if no suitable program is installed. `profile` is a folder for
/// Chromium's own files.
Words printing(const fs::path& page, const fs::path& pdf, const fs::path& profile) {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (const auto chromium = on_path(name)) {
      Words words{chromium->string(),
                  "--headless",
                  "--disable-gpu",
                  "--no-pdf-header-footer",
                  "--user-data-dir=" + profile.string(),
                  "--print-to-pdf=" + pdf.string()};
      // Chromium's sandbox does not work if the user is root.
      if (::geteuid() == 0) words.emplace_back("--no-sandbox");
      words.push_back("file://" + page.string());
      return words;
    }
  return {};
}

/// Runs a program and returns its exit status; -1 if it cannot be started or crashes.
int run(const Words& words, const std::stop_token& stop) {
  pid_t child = -1;
  try {
    child = voxel::spawn({.words = words, .has_own_group = true});
  } catch (const std::system_error&) {
    return -1;
  }
  bool is_stopped = false;
  const int status = voxel::wait_for_end(child, std::chrono::milliseconds(10), [&] {
    if (is_stopped || !stop.stop_requested()) return;
    is_stopped = true;
    ::kill(-child, SIGKILL);
  });
  if (is_stopped) throw voxel::Stopped("stopped while the report was printed");
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void need_pdf_printer() {
  if (printing({}, {}, {}).empty())
    throw std::runtime_error(
        "--pdf: no program that runs a page's script and prints it is installed: apt-get install chromium");
}

void print_pdf(const fs::path& page, const fs::path& pdf, const std::stop_token& stop) {
  need_pdf_printer();
  const voxel::UnfinishedFolder profile(fs::absolute(pdf).parent_path(), ".printing-");
  const int status = run(printing(fs::absolute(page), fs::absolute(pdf), profile.path()), stop);
  if (status != 0 || !fs::exists(pdf))
    throw voxel::Error(voxel::ErrorCode::Resource,
                       pdf.string() + ": " + printing(page, pdf, {}).front() +
                           " could not print the report: leave out --pdf, and print report.html by hand");
}

}  // namespace octotomy::planner
