// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <stdexcept>
#include <string>
#include <sys/wait.h>

namespace octotomy::tests {

struct CommandAnswer {
  int status = -1;  ///< negative: the signal that ended it
  std::string out;
  std::string errors;
};

/// Runs a shell's command line to its end; `scratch` is a folder for its output on standard error.
inline CommandAnswer run_command(const std::string& command, const std::filesystem::path& scratch) {
  const std::filesystem::path errors = scratch / "stderr.txt";
  std::FILE* pipe = ::popen((command + " 2>'" + errors.string() + "'").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell for: " + command);
  CommandAnswer answer;
  char buffer[4096];
  for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    answer.out.append(buffer, got);
  const int status = ::pclose(pipe);
  answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  std::ifstream file(errors);
  answer.errors.assign(std::istreambuf_iterator<char>(file), {});
  return answer;
}

/// A path as one word of a shell's command line; it must hold no quote.
inline std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

/// Whether a program is installed.
inline bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace octotomy::tests

/// Skips the test with a line that says what is missing.
#define OCTOTOMY_NEEDS_PROGRAM(name, package) \
  if (!octotomy::tests::has_program(name))    \
  GTEST_SKIP() << "'" << (name) << "' is not installed (package " << (package) << ")"

/// Skips the test if Python lacks a package: tests/planner/cli/*.py then end with status 77.
#define OCTOTOMY_NEEDS_PYTHON(answer) \
  if ((answer).status == 77) GTEST_SKIP() << "/usr/bin/python3: " << (answer).errors
