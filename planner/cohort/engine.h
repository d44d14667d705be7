// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The programs and options with which a cohort's processes are started.
struct EngineRequest {
  std::vector<std::string> program;  ///< begins every command: "octotomy cohort IN OUT participant --plan P"
  std::vector<std::string> group;    ///< the group's command
  std::vector<std::string> labels;   ///< one process per label
  std::filesystem::path out;
  std::optional<int> jobs;         ///< of parallel at a time; none: as many as there are cores
  std::vector<std::string> slurm;  ///< options of sbatch: "--mem=8G", "--partition=long"
  std::stop_token stop;
  std::function<void(const std::string& doing, double fraction)> progress;
};

/// Ends this process by SIGTERM to itself when the process that runs its engine has ended, even by SIGKILL.
/// For a participant, before its work. Does nothing if run_parallel() did not start this process.
void end_with_engine();

/// Runs one process after another; a crash does not affect the others. Each writes its subject's record, or
/// none. The running process gets SIGTERM when this one ends for any reason. Returns whether a process ran
/// out of time, memory or disk (status 3). Throws voxel::Stopped after the running process has ended.
bool run_serial(const EngineRequest& request);

/// As run_serial(), but with GNU parallel, whose log is code/parallel.log. It ends with this process, and so
/// do its processes if they called end_with_engine(). Throws voxel::Error (Resource) if it is not installed.
bool run_parallel(const EngineRequest& request);

/// Submits job arrays of at most 1,000 subjects and a group job that waits for them; the scripts and the logs
/// are in code/. Does not wait; returns the jobs' numbers, the group's last. Throws voxel::Error (Resource)
/// if sbatch is not installed or refuses.
std::vector<std::string> submit_slurm(const EngineRequest& request);

}  // namespace octotomy::planner
