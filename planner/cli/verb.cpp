// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <unistd.h>

#include "planner/cli/numbers.h"

namespace octotomy::planner::cli {
namespace {

/// Writes all of it, or throws; a reader that has gone away wants no more, which is no error.
void put(const std::string& text) {
  errno = 0;
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written && errno != EPIPE) throw std::system_error(errno, std::generic_category(), "standard output");
}

}  // namespace

CLI::App& Program::verb(const std::string& name, const std::string& does, const std::string& example,
                        std::function<int()> action) {
  // "plan diff" is the verb diff of the group plan.
  CLI::App* parent = &app;
  const auto blank = name.find(' ');
  if (blank != std::string::npos) parent = app.get_subcommand(name.substr(0, blank));
  CLI::App& sub = *parent->add_subcommand(name.substr(blank == std::string::npos ? 0 : blank + 1), does);
  sub.add_flag("--json", json, "One JSON object on standard output, nothing else there");
  sub.add_option("--threads", threads, "Threads to use; the answer is the same on any number")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  sub.add_option("--time-limit", time_limit_s,
                 "Give up after so many seconds, with exit status 3 and nothing written")
      ->check(above_zero())
      ->type_name("S");
  sub.footer("Example:\n  " + example);
  sub.callback([this, act = std::move(action)] { chosen = act; });
  return sub;
}

void Program::say(const Json& answer, const std::string& text) const {
  put(json ? answer.dump(2) + "\n" : text);
}

std::function<void(const std::string&, double)> Program::progress() const {
  if (json || ::isatty(STDERR_FILENO) == 0) return {};
  return [](const std::string& doing, double fraction) {
    // Erase the line, so that a shorter text leaves nothing of a longer one.
    std::fprintf(stderr, "\r\x1b[2K%3d %%  %s", static_cast<int>(100.0 * fraction), doing.c_str());
    if (fraction >= 1.0) std::fputs("\r\x1b[2K", stderr);
    std::fflush(stderr);
  };
}

std::function<void(double)> Program::progress(const std::string& doing) const {
  const auto report = progress();
  if (!report) return {};
  return [report, doing](double fraction) { report(doing, fraction); };
}

void warn(const std::string& line) {
  std::fprintf(stderr, "octotomy: %s\n", line.c_str());
}

std::string dims_text(const glm::ivec3& dims) {
  return std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " + std::to_string(dims.z);
}

std::string lines(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::size_t widest = 0;
  for (const auto& [name, unused] : rows) widest = std::max(widest, name.size());
  std::string text;
  for (const auto& [name, value] : rows)
    text.append(name).append(widest - name.size() + 2, ' ').append(value).append("\n");
  return text;
}

}  // namespace octotomy::planner::cli
