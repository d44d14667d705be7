// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::planner {

/// How a cohort's processes are started.
struct EngineRequest {
  std::vector<std::string> program;  ///< begins every command: "octotomy cohort IN OUT participant --plan P"
  std::vector<std::string> group;    ///< the group's command
  std::vector<std::string> labels;   ///< one process each
  std::filesystem::path out;
  int jobs = 0;                    ///< of parallel; 0: as many as there are cores
  std::vector<std::string> slurm;  ///< options of sbatch: "--mem=8G", "--partition=long"
  std::stop_token stop;
  std::function<void(const std::string& doing, double fraction)> progress;
};

/// Ends this process by SIGTERM to itself when the process that runs its engine has ended, even by SIGKILL.
/// For a participant, before its work. Does nothing where run_parallel() did not start it.
void end_with_engine();

/// One process after another; one that crashes takes nobody with it. Each leaves its subject's record, or
/// none. The process at work gets SIGTERM when this one ends, however it ends. Returns whether a process ran
/// out of time, memory or disk (status 3). Throws voxel::Stopped after the process at work ended.
bool run_serial(const EngineRequest& request);

/// The same by GNU parallel, whose log is code/parallel.log. It ends with this process, and so do the
/// processes that it started if they called end_with_engine(). Throws voxel::Error (Resource) where it is not
/// installed.
bool run_parallel(const EngineRequest& request);

/// Submits job arrays of at most 1,000 subjects and a group job that waits for them; the scripts and the
/// logs are in code/. Does not wait; returns the jobs' numbers, the group's last. Throws voxel::Error
/// (Resource) where sbatch is not installed or refuses.
std::vector<std::string> submit_slurm(const EngineRequest& request);

}  // namespace octotomy::planner
