// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/engine.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "planner/cohort/cohort_folder.h"
#include "voxel/space/error.h"

extern char** environ;  // NOLINT(readability-redundant-declaration)

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Exit status of a process that ran out of time, memory or disk.
constexpr int out_of_resources = 3;

/// How a child ended, and its first line on standard output.
struct Child {
  int status = 0;
  std::string said;
};

/// Runs a program found by PATH. Its standard error is ours. A stop is passed on as SIGTERM, and its end
/// waited for; then throws Stopped. Throws voxel::Error (Resource) where it cannot be started.
Child run_child(const Words& words, const std::stop_token& stop) {
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : words)
    arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(pipe[1]);
  if (error != 0) {
    close(pipe[0]);
    throw voxel::Error(voxel::ErrorCode::Resource,
                       words[0] + " cannot be started: " + std::generic_category().message(error) +
                           (error == ENOENT ? "; install it, or choose another --engine" : ""));
  }
  std::string said;
  std::thread reader([&] {
    std::array<char, 4096> part{};
    for (ssize_t count = 0; (count = read(pipe[0], part.data(), part.size())) > 0;)
      if (said.size() < 65536) said.append(part.data(), static_cast<std::size_t>(count));
  });
  int status = 0;
  bool asked = false;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (stop.stop_requested() && !asked) {
      kill(child, SIGTERM);
      asked = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  reader.join();
  close(pipe[0]);
  if (asked) throw voxel::Stopped("stopped: the subjects that were done stay");
  return {status, said.substr(0, said.find('\n'))};
}

Words with_label(const EngineRequest& request, const std::string& label) {
  Words words = request.program;
  words.insert(words.end(), {"--participant-label", label});
  return words;
}

/// The words as a shell reads them.
std::string shell_text(const Words& words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += ' ';
    text += '\'';
    for (const char symbol : word) text += symbol == '\'' ? "'\\''" : std::string(1, symbol);
    text += '\'';
  }
  return text;
}

fs::path code_path(const EngineRequest& request, const char* name) {
  return request.out / "code" / name;
}

fs::path write_labels(const EngineRequest& request) {
  std::string text;
  for (const std::string& label : request.labels) text += label + "\n";
  write_cohort_file(request.out, cohort_labels, text);
  return code_path(request, cohort_labels);
}

/// The number that `sbatch --parsable` prints, before a ";" and the cluster's name.
std::string submit(const EngineRequest& request, const Words& options, const Words& script) {
  Words words{"sbatch", "--parsable"};
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), request.slurm.begin(), request.slurm.end());
  words.insert(words.end(), script.begin(), script.end());
  const Child child = run_child(words, request.stop);
  const std::string job = child.said.substr(0, child.said.find(';'));
  if (!WIFEXITED(child.status) || WEXITSTATUS(child.status) != 0 || job.empty() ||
      job.find_first_not_of("0123456789") != std::string::npos)
    throw voxel::Error(voxel::ErrorCode::Resource, "sbatch refused " + script[0] +
                                                       ": see what it says above; its options come from "
                                                       "--slurm");
  return job;
}

/// Whether a process ended with that status by GNU parallel's log, whose seventh column holds it.
bool log_tells_end_of_resources(const fs::path& log) {
  std::ifstream file(log);
  bool tells = false;
  for (std::string line; std::getline(file, line);) {
    std::istringstream columns(line);
    std::string word;
    for (int column = 0; column < 7; ++column) std::getline(columns, word, '\t');
    tells |= word == std::to_string(out_of_resources);
  }
  return tells;
}

}  // namespace

bool run_serial(const EngineRequest& request) {
  bool ran_out = false;
  for (std::size_t i = 0; i < request.labels.size(); ++i) {
    if (request.progress)
      request.progress("subject " + request.labels[i],
                       static_cast<double>(i) / static_cast<double>(request.labels.size()));
    const int status = run_child(with_label(request, request.labels[i]), request.stop).status;
    ran_out |= WIFEXITED(status) && WEXITSTATUS(status) == out_of_resources;
  }
  return ran_out;
}

bool run_parallel(const EngineRequest& request) {
  Words words{"parallel",   "--will-cite",
              "--joblog",   code_path(request, cohort_log).string(),
              "--arg-file", write_labels(request).string()};
  if (request.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(request.jobs)});
  words.push_back(shell_text(request.program) + " --participant-label {} >/dev/null");
  run_child(words, request.stop);
  return log_tells_end_of_resources(code_path(request, cohort_log));
}

std::vector<std::string> submit_slurm(const EngineRequest& request) {
  constexpr std::size_t array_size = 1000;  // Slurm's default limit is 1,001
  const fs::path labels = write_labels(request);
  const fs::path logs = code_path(request, "logs");
  fs::create_directories(logs);
  const auto head = [&](const std::string& name) {
    return "#!/bin/bash\n#SBATCH --requeue\n#SBATCH --job-name=" + name +
           "\n#SBATCH --output=" + (logs / "%x_%A_%a.txt").string() + "\n";
  };
  const fs::path participant = code_path(request, cohort_participant_script);
  write_cohort_file(request.out, cohort_participant_script,
                    head("octotomy") + "# $1 subjects lie before the array's first.\n" +
                        "label=$(sed -n \"$((SLURM_ARRAY_TASK_ID + $1))p\" " + shell_text({labels.string()}) +
                        ")\nexec " + shell_text(request.program) +
                        " --participant-label \"$label\" >/dev/null\n");
  const fs::path group = code_path(request, cohort_group_script);
  write_cohort_file(request.out, cohort_group_script,
                    head("octotomy-group") + "exec " + shell_text(request.group) + "\n");

  std::vector<std::string> jobs;
  std::string after = "--dependency=afterany";
  for (std::size_t begin = 0; begin < request.labels.size(); begin += array_size) {
    const std::size_t count = std::min(array_size, request.labels.size() - begin);
    jobs.push_back(submit(request, {"--array=1-" + std::to_string(count)},
                          {participant.string(), std::to_string(begin)}));
    after += ":" + jobs.back();
  }
  jobs.push_back(submit(request, {after}, {group.string()}));
  return jobs;
}

}  // namespace octotomy::planner
