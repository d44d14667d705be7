// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "planner/browser/server/access_control.h"
#include "planner/browser/server/folders.h"
#include "planner/browser/server/server.h"
#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/verb.h"
#include "planner/operation/table/json_file.h"
#include "planner/plan/dependence.h"
#include "planner/plan/plan.h"
#include "voxel/space/spawn.h"
#include "voxel/space/unfinished_folder.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct ServeText {
  std::vector<fs::path> paths;
  serve::ServerOptions options;
  fs::path token_file;
  bool open = false, share = false;
};

/// Opens the page in the desktop's browser; does nothing if there is no browser. The URL contains the token,
/// and every user can read the arguments of a process. So the browser opens a file that only its owner can
/// read, which redirects to the URL.
void open_browser(const std::string& url, const fs::path& closed_folder) {
  const fs::path page = closed_folder / "planner.html";
  const int file = ::open(page.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return warn("--open: " + page.string() + " cannot be written: open the address by hand");
  ::close(file);
  std::ofstream(page) << "<!doctype html><meta charset=utf-8><meta name=referrer content=no-referrer>"
                         "<meta http-equiv=refresh content='0;url="
                      << url << "'>\n";
  try {
    voxel::spawn({.words = {"xdg-open", page.string()}});
  } catch (const std::system_error&) {
    // There is no desktop.
  }
}

/// The plan or scan with which the server starts; none if only folders are named. Throws std::runtime_error
/// if the command line names several.
std::optional<fs::path> beginning_of(const std::vector<fs::path>& paths) {
  std::optional<fs::path> beginning;
  for (const fs::path& path : paths) {
    if (fs::is_directory(path) && paths.size() > 1) continue;
    if (beginning) throw std::runtime_error("name at most one plan or scan; other paths must be folders");
    beginning = fs::canonical(path);
  }
  return beginning;
}

/// Allows the server to read the scans and files of a plan from the command line, wherever they are.
void allow_reading_of(const Plan& plan, serve::Folders& folders) {
  for (const auto& [name, scan] : plan.scans) folders.allow_reading(scan_path(plan, scan));
  for (const Step& step : plan.steps)
    for (const fs::path& file : files_read(step)) folders.allow_reading(plan.folder / file);
}

/// Ends the program after the server has ended. Running work is not awaited: every edit is on disk, and
/// stopping the work may take long. Only a running edit is awaited for a short time, because it renames files
/// and remove_unfinished() disables that.
[[noreturn]] void end_program(serve::Session& session, bool is_out_of_time) {
  constexpr std::chrono::milliseconds longest_edit{100};
  while (!has_last_word(Speaker::Verb)) ::pause();
  session.close_within(longest_edit);
  voxel::remove_unfinished();
  if (is_out_of_time) warn("out of time: the server has ended; every edit is in the plan's file");
  std::_Exit(is_out_of_time ? out_of_resources : done);
}

int run(Program& program, ServeText& text) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  // Everything that can be refused is checked before a plan is written.
  const std::optional<fs::path> beginning = beginning_of(text.paths);
  text.options.token = text.token_file.empty() ? serve::new_token() : serve::token_in(text.token_file);
  if (text.share)
    text.options.view_token =
        text.token_file.empty() ? serve::new_token() : serve::token_in(text.token_file.string() + ".view");
  std::optional<voxel::UnfinishedFolder> closed_folder;
  text.options.ready = [&](const std::string& url, const std::string& view_url) {
    Json json = answer({});
    json.erase("timings_ms");
    json["url"] = url;
    if (!view_url.empty()) json["view_url"] = view_url;
    const std::string to_look = view_url.empty() ? "" : "To look only: " + view_url + "\n";
    const std::string line =
        program.json ? json_text(json) + "\n" : "Open " + url + "\n" + to_look + "Ctrl-C ends it.\n";
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
    if (text.open)
      open_browser(url, closed_folder.emplace(fs::temp_directory_path(), ".octotomy-open-").path());
  };
  serve::Server server(text.options);
  if (text.options.address != "127.0.0.1" && text.options.address != "::1")
    warn("--listen " + text.options.address +
         ": others on the network can reach this server and read all traffic, because nothing is encrypted");
  serve::Session session(fs::current_path());
  for (const fs::path& path : text.paths) session.folders.open(path);
  if (beginning && serve::is_plan(*beginning)) allow_reading_of(read_plan(*beginning), session.folders);
  if (beginning) session.open(*beginning, {program.stop.get_token(), program.progress()});
  serve::Service service(session, line_of, text.options.view_token);
  server.run(service, session, program.stop.get_token());
  // The watch that enforces the time limit started up to this time before or after this verb.
  constexpr std::chrono::duration<double> margin{0.1};
  end_program(session, program.time_limit_s && Clock::now() - start + margin >=
                                                   std::chrono::duration<double>(*program.time_limit_s));
}

}  // namespace

void add_serve(Program& program) {
  const auto text = std::make_shared<ServeText>();
  CLI::App& verb = program.verb("serve", "Opens the planner in a browser; nothing leaves this machine",
                                "octotomy serve head.nrrd --open\n"
                                "  octotomy serve le_fort_i.plan.json",
                                [&program, text] { return run(program, *text); });
  verb.add_option("paths", text->paths,
                  "A plan or a scan to begin with, and folders whose files the page may open")
      ->check(CLI::ExistingPath);
  verb.add_option("--port", text->options.port, "Port to listen on; default: a free one")
      ->check(CLI::Range(0, 65535));
  verb.add_option("--token-file", text->token_file,
                  "Stores the address's token in this file: with the same --port, open pages reconnect to a "
                  "restarted server");
  verb.add_flag("--open", text->open, "Opens the desktop's browser");
  verb.add_flag("--share", text->share,
                "Also prints a second address, whose pages show the open plan and every change of it but "
                "cannot change it. It has another token, which --token-file FILE stores in FILE.view");
  verb.add_option("--listen", text->options.address,
                  "Address of another interface, so that other machines reach the server; default 127.0.0.1");
}

}  // namespace octotomy::planner::cli
