// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The commands that an engine runs for a cohort, and its options.
struct EngineRequest {
  std::vector<std::string> program;  ///< begins every command: "octotomy cohort IN OUT participant --plan P"
  std::vector<std::string> group;    ///< the group's command
  std::vector<std::string> labels;   ///< one process per label
  std::filesystem::path out;
  std::optional<int> jobs;         ///< largest number of parallel processes; none: the number of cores
  std::vector<std::string> slurm;  ///< options of sbatch: "--mem=8G", "--partition=long"
  std::stop_token stop;
  std::function<void(const std::string& doing, double fraction)> progress;
};

/// Makes this process send SIGTERM to itself when the process that runs its engine has ended for any reason,
/// even by SIGKILL. A participant calls this before its work. Has no effect unless run_parallel() started
/// this process.
void end_with_engine();

/// Runs one process for each label, one after the other. If one fails or crashes, the others still run; its
/// subject then has no record, or one with the reason. A running process receives SIGTERM when this process
/// ends for any reason. Returns whether a process ran out of time, memory or disk (status 3). Throws
/// voxel::Stopped, after the running process has ended.
bool run_serial(const EngineRequest& request);

/// As run_serial(), but in parallel by GNU parallel, whose log is code/parallel.log. When this process ends,
/// GNU parallel ends, and so do the processes that have called end_with_engine(). Throws voxel::Error
/// (Resource) if GNU parallel is not installed.
bool run_parallel(const EngineRequest& request);

/// Submits job arrays of at most 1000 subjects, and a job for the group that starts after them. Scripts and
/// logs are in code/. Does not wait for the jobs. Returns their numbers; the group's is the last. Throws
/// voxel::Error (Resource) if sbatch is not installed or refuses.
std::vector<std::string> submit_slurm(const EngineRequest& request);

}  // namespace octotomy::planner
