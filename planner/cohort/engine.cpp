// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/engine.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <poll.h>
#include <sstream>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "planner/cohort/child_process.h"
#include "planner/cohort/cohort_folder.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Exit status of an `octotomy` process that ran out of time, memory or disk.
constexpr int out_of_resources = 3;

/// The environment variable with the number of a pipe's reading end, for participants that GNU parallel
/// starts. Only this process has the writing end. The system closes it when this process ends for any reason,
/// and the participants notice that. They cannot rely on a signal at the end of their parent, because their
/// parent is a shell.
constexpr const char* pipe_variable = "OCTOTOMY_ENGINE_PIPE";

Words with_label(const EngineRequest& request, const std::string& label) {
  Words words = request.program;
  words.insert(words.end(), {"--participant-label", label});
  return words;
}

/// The words as one command line, quoted for a shell.
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

/// Submits a script and returns the job's number. `sbatch --parsable` prints it before a ";" and the
/// cluster's name.
std::string submit(const EngineRequest& request, const Words& options, const Words& script) {
  Words words{"sbatch", "--parsable"};
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), request.slurm.begin(), request.slurm.end());
  words.insert(words.end(), script.begin(), script.end());
  const ChildEnd child = run_child_process({words}, request.stop);
  const std::string job = child.said.substr(0, child.said.find(';'));
  if (!WIFEXITED(child.status) || WEXITSTATUS(child.status) != 0 || job.empty() ||
      job.find_first_not_of("0123456789") != std::string::npos)
    throw voxel::Error(voxel::ErrorCode::Resource, "sbatch refused " + script[0] +
                                                       ": see its message above; its options come from "
                                                       "--slurm");
  return job;
}

/// Whether GNU parallel's log lists a process with the exit status out_of_resources. The status is in the
/// seventh column.
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

void end_with_engine() {
  const char* text = std::getenv(pipe_variable);
  const int file = text == nullptr ? -1 : std::atoi(text);
  struct stat of_file {};
  if (file < 0 || fstat(file, &of_file) != 0 || !S_ISFIFO(of_file.st_mode)) return;
  // Detached: the thread waits until the engine's process or this one ends.
  std::thread([file] {
    pollfd engine{file, 0, 0};
    while (poll(&engine, 1, -1) < 0 && errno == EINTR) continue;
    kill(getpid(), SIGTERM);
  }).detach();
}

bool run_serial(const EngineRequest& request) {
  bool ran_out = false;
  for (std::size_t i = 0; i < request.labels.size(); ++i) {
    if (request.progress)
      request.progress("subject " + request.labels[i],
                       static_cast<double>(i) / static_cast<double>(request.labels.size()));
    const int status = run_child_process({with_label(request, request.labels[i])}, request.stop).status;
    ran_out |= WIFEXITED(status) && WEXITSTATUS(status) == out_of_resources;
  }
  return ran_out;
}

bool run_parallel(const EngineRequest& request) {
  Words words{"parallel",   "--will-cite",
              "--joblog",   code_path(request, cohort_log).string(),
              "--arg-file", write_labels(request).string()};
  if (request.jobs) words.insert(words.end(), {"--jobs", std::to_string(*request.jobs)});
  words.push_back(shell_text(request.program) + " --participant-label {} >/dev/null");
  const Pipe pipe;
  run_child_process({.words = words,
                     // Another shell of the user may close the pipe, as csh does.
                     .environment = {"PARALLEL_SHELL=/bin/sh",
                                     std::string(pipe_variable) + "=" + std::to_string(pipe.reading())},
                     .inherited_file = pipe.reading(),
                     // Early after its start, GNU parallel ignores SIGTERM and would process the whole list.
                     .signal_at_our_end = SIGKILL},
                    request.stop);
  return log_tells_end_of_resources(code_path(request, cohort_log));
}

std::vector<std::string> submit_slurm(const EngineRequest& request) {
  constexpr std::size_t array_size = 1000;  // Slurm's default largest size is 1001
  const fs::path labels = write_labels(request);
  const fs::path logs = code_path(request, "logs");
  fs::create_directories(logs);
  const auto head = [&](const std::string& name) {
    return "#!/bin/bash\n#SBATCH --requeue\n#SBATCH --job-name=" + name +
           "\n#SBATCH --output=" + (logs / "%x_%A_%a.txt").string() + "\n";
  };
  const fs::path participant = code_path(request, cohort_participant_script);
  write_cohort_file(request.out, cohort_participant_script,
                    head("octotomy") + "# $1: number of subjects before the first one of this array\n" +
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
