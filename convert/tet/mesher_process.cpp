// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/mesher_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "voxel/space/helper_file.h"
#include "voxel/space/spawn.h"
#include "voxel/space/write_failure.h"

// Request, answer and log are files in memory, so neither side waits for the other and a child that dies early
// raises no SIGPIPE here.

namespace octotomy::convert {
namespace {

using Clock = std::chrono::steady_clock;

/// How often to poll a running child: a hundredth of the shortest run that a user notices as slow.
constexpr std::chrono::milliseconds look_every{1};
constexpr std::chrono::milliseconds report_every{200};
/// Bytes to quote from the end of the mesher's log.
constexpr std::size_t last_words_bytes = 400;

[[noreturn]] void fail(const std::string& what, int error) {
  throw voxel::Error(voxel::ErrorCode::Resource,
                     "tetrahedralise: " + what + ": " + std::strerror(error) + voxel::way_out_of(error));
}

/// A file in memory, without a name and not inherited.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : file_(memfd_create(name, MFD_CLOEXEC)) {
    if (file_ < 0) fail("cannot make a file in memory for the mesher", errno);
    // The child replaces its file descriptors 0 to 2 one after the other. So a file that replaces one of them
    // must have a descriptor above 2.
    if (file_ <= STDERR_FILENO) {
      const int higher = fcntl(file_, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
      const int error = errno;
      close(file_);
      if (higher < 0) fail("cannot make a file in memory for the mesher", error);
      file_ = higher;
    }
  }
  ~MemoryFile() { close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int file() const { return file_; }
  std::uint64_t size() const {
    const off_t end = lseek(file_, 0, SEEK_END);
    return end < 0 ? 0 : static_cast<std::uint64_t>(end);
  }
  void rewind() const { lseek(file_, 0, SEEK_SET); }

  void write_all(const void* source, std::size_t bytes) const {
    const auto* at = static_cast<const std::byte*>(source);
    while (bytes > 0) {
      const ssize_t put = write(file_, at, bytes);
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) fail("cannot hand the surface to the mesher", errno);
      at += put;
      bytes -= static_cast<std::size_t>(put);
    }
  }
  bool read_all(void* target, std::size_t bytes) const {
    auto* at = static_cast<std::byte*>(target);
    while (bytes > 0) {
      const ssize_t got = read(file_, at, bytes);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      at += got;
      bytes -= static_cast<std::size_t>(got);
    }
    return true;
  }

 private:
  int file_;
};

/// Starts the executable with three files as its standard streams.
pid_t start(const std::filesystem::path& executable, int in, int out, int log) {
  try {
    return voxel::spawn(
        {.words = {executable.string()}, .in = in, .out = out, .errors = log, .has_environment = false});
  } catch (const std::system_error& error) {
    fail(executable.string() + " cannot be started", error.code().value());
  }
}

enum class Ended { ByItself, OutOfTime, Stopped };
struct Ending {
  Ended how = Ended::ByItself;
  int status = 0;
};

/// The processor time that a child has used; zero once it has ended.
std::chrono::nanoseconds processor_time(pid_t child) {
  clockid_t clock{};
  timespec used{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &used) != 0) return {};
  return std::chrono::seconds(used.tv_sec) + std::chrono::nanoseconds(used.tv_nsec);
}

/// Waits for the child and kills it when a limit is passed. The child is gone on return.
Ending wait_within(pid_t child, const MesherLimits& limits) {
  const Clock::time_point started = Clock::now();
  const Clock::time_point deadline = started + most_clock_times() * limits.time;
  Clock::time_point next_report = started + report_every;
  Ending ending;
  ending.status = voxel::wait_for_end(child, look_every, [&] {
    if (ending.how != Ended::ByItself) return;
    if (limits.progress.report && Clock::now() >= next_report) {
      next_report += report_every;
      limits.progress.report(
          std::min(1.0, std::chrono::duration<double>(processor_time(child)) / limits.time));
    }
    const bool stopped = limits.progress.stop.stop_requested();
    if (!stopped && processor_time(child) < limits.time && Clock::now() < deadline) return;
    ending.how = stopped ? Ended::Stopped : Ended::OutOfTime;
    kill(child, SIGKILL);
  });
  return ending;
}

/// The end of the mesher's log, on one line.
std::string last_words(const MemoryFile& log) {
  const std::uint64_t size = log.size();
  const std::uint64_t count = std::min<std::uint64_t>(size, last_words_bytes);
  std::string words(count, ' ');
  lseek(log.file(), static_cast<off_t>(size - count), SEEK_SET);
  if (!log.read_all(words.data(), words.size())) return {};
  std::string line;
  for (const char c : words) {
    const bool space = static_cast<unsigned char>(c) <= ' ';
    if (!space) line += c;
    if (space && !line.empty() && line.back() != ' ') line += ' ';
  }
  if (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

struct Reason {
  std::string what;
  bool worth_another_try = true;
  voxel::ErrorCode code = voxel::ErrorCode::Geometry;
};

/// Statuses from mesher_exit_base on add the numbers of TetGen 1.5's terminatetetgen().
Reason reason_of_status(int status, const MesherLimits& limits) {
  const std::string memory = std::to_string(limits.memory_bytes >> 20) + " MiB";
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGKILL)
      return {"was ended by signal " + std::to_string(signal) + " (SIG" + sigabbrev_np(signal) +
                  "): out of processor time, or ended from outside",
              true, voxel::ErrorCode::Resource};
    if (signal == SIGXFSZ)
      return {"passed the limit on the size of files (ulimit -f) with its answer: raise it", false,
              voxel::ErrorCode::Resource};
    const char* name = sigabbrev_np(signal);
    return {"crashed with signal " + std::to_string(signal) + " (SIG" + (name == nullptr ? "?" : name) + ")"};
  }
  switch (WEXITSTATUS(status)) {
    case mesher_exit_memory:
      return {"needs more than the memory limit of " + memory + ": raise it or coarsen the surface", true,
              voxel::ErrorCode::Resource};
    case mesher_exit_protocol:
      return {"did not understand the request: its executable is of another build than this program", false,
              voxel::ErrorCode::Resource};
    case mesher_exit_base + 2:
      return {"met an internal error"};
    case mesher_exit_base + 3:
      return {"found the surface intersecting itself: check its health, then repair or smooth it", false};
    case mesher_exit_base + 4:
      return {"found features too small for its tolerance: smooth or decimate the surface"};
    case mesher_exit_base + 5:
      return {"found two triangles too close to each other: smooth or decimate the surface"};
    case mesher_exit_base + 10:
      return {"refused the surface as malformed", false};
    default:
      return {"ended with status " + std::to_string(WEXITSTATUS(status))};
  }
}

/// A request and the blocks of bytes that follow it.
struct Sent {
  MesherRequest request;
  std::vector<std::pair<const void*, std::size_t>> blocks;  ///< in the request's order, with their bytes

  template <typename T>
  std::uint64_t add(const std::vector<T>& values) {
    blocks.emplace_back(values.data(), values.size() * sizeof(T));
    return values.size();
  }
};

Sent sent(const MesherInput& input) {
  Sent made;
  made.request.points = made.add(input.points_mm);
  made.request.triangles = made.add(input.triangles);
  made.request.holes = made.add(input.holes_mm);
  made.request.sizes = made.add(input.sizes_mm);
  return made;
}

Sent sent(const LabelImage& image) {
  Sent made;
  made.request.points = made.add(image.planes);
  made.request.holes = made.add(image.start_mm);
  made.request.sizes = made.add(image.shares);
  made.request.labels = made.add(image.labels);
  for (int axis = 0; axis < 3; ++axis) {
    made.request.dims.at(static_cast<std::size_t>(axis)) = image.dims[axis];
    made.request.spacing_mm.at(static_cast<std::size_t>(axis)) = image.spacing_mm[axis];
  }
  return made;
}

void write_request(const MemoryFile& file, Sent& sent, const std::string& switches,
                   const MesherLimits& limits) {
  MesherRequest& request = sent.request;
  if (switches.size() >= request.switches.size())
    throw std::invalid_argument("tetrahedralise: switches '" + switches + "' are too long");
  std::copy(switches.begin(), switches.end(), request.switches.begin());
  request.memory_limit_bytes = limits.memory_bytes;
  request.parent = ::getpid();
  // wait_within() enforces the limit. This limit of the system ends the child if the parent has ended.
  request.cpu_limit_seconds =
      static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(limits.time).count() + 2);
  file.write_all(&request, sizeof request);
  for (const auto& [data, bytes] : sent.blocks) file.write_all(data, bytes);
  file.rewind();
}

/// False if the answer is incomplete.
bool read_answer(const MemoryFile& file, MesherOutcome& outcome) {
  const std::uint64_t size = file.size();
  file.rewind();
  MesherAnswer answer;
  if (size < sizeof answer || !file.read_all(&answer, sizeof answer)) return false;
  if (answer.version != MesherRequest::this_version) return false;
  const std::uint64_t point_bytes = sizeof(glm::dvec3);
  const std::uint64_t tet_bytes = 4 * sizeof(std::uint32_t);
  if (answer.points > size / point_bytes || answer.tetrahedra > size / tet_bytes) return false;
  if (answer.labels != 0 && answer.labels != answer.tetrahedra) return false;
  outcome.points_mm.resize(answer.points);
  outcome.tetrahedra.resize(answer.tetrahedra);
  outcome.labels.resize(answer.labels);
  return file.read_all(outcome.points_mm.data(), answer.points * point_bytes) &&
         file.read_all(outcome.tetrahedra.data(), answer.tetrahedra * tet_bytes) &&
         file.read_all(outcome.labels.data(), answer.labels * sizeof(std::uint32_t));
}

/// A mesher that runs in a separate process.
struct Mesher {
  std::string executable;
  std::string name;  ///< in messages
};

MesherOutcome run(const Mesher& mesher, Sent sent, const std::string& switches, const MesherLimits& limits) {
  const MemoryFile request("tetgen request");
  const MemoryFile answer("tetgen answer");
  const MemoryFile log("tetgen log");
  write_request(request, sent, switches, limits);

  const std::filesystem::path executable = voxel::helper_file(mesher.executable);
  const Clock::time_point started = Clock::now();
  const Ending ending = wait_within(start(executable, request.file(), answer.file(), log.file()), limits);
  const auto ran = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - started);

  MesherOutcome outcome;
  std::string why;
  if (ending.how == Ended::Stopped) throw voxel::Stopped(mesher.name + " was stopped on request");
  if (ending.how == Ended::OutOfTime) {
    outcome.code = voxel::ErrorCode::Resource;
    why = "did not end within the time limit of " + std::to_string(limits.time.count()) +
          " ms of a processor: raise it, ease the radius-edge bound or coarsen the surface";
    outcome.worth_another_try = true;
  } else if (ending.status != 0) {
    const Reason reason = reason_of_status(ending.status, limits);
    why = reason.what;
    outcome.worth_another_try = reason.worth_another_try;
    outcome.code = reason.code;
  } else if (!read_answer(answer, outcome)) {
    why = "gave an incomplete answer";
    outcome.worth_another_try = true;
  } else {
    return outcome;
  }
  const std::string words = last_words(log);
  outcome.points_mm.clear();
  outcome.tetrahedra.clear();
  outcome.labels.clear();
  outcome.failure = mesher.name + " " + why + " (after " + std::to_string(ran.count()) + " ms" +
                    (words.empty() ? "" : "; its log ends: " + words) + ")";
  return outcome;
}

}  // namespace

MesherOutcome run_tetgen(const MesherInput& input, const std::string& switches, const MesherLimits& limits) {
  return run({"octotomy-tetgen", "TetGen -" + switches}, sent(input), switches, limits);
}

MesherOutcome run_mesh3(const MesherInput& input, const Mesh3Sizes& sizes, const MesherLimits& limits) {
  std::array<char, std::tuple_size_v<decltype(MesherRequest::switches)>> text{};
  std::snprintf(text.data(), text.size(), "%.9g %.9g %.9g %.9g", sizes.distance, sizes.cell, sizes.grading,
                sizes.max_cell_mm);
  return run({"octotomy-mesh3", "CGAL's Mesh_3"}, sent(input), text.data(), limits);
}

MesherOutcome run_mesh3(const LabelImage& image, const LabelSizes& sizes, const MesherLimits& limits) {
  std::array<char, std::tuple_size_v<decltype(MesherRequest::switches)>> text{};
  std::snprintf(text.data(), text.size(), "%.9g %.9g %.9g %d", sizes.facet_mm, sizes.distance_mm,
                sizes.cell_mm, image.share_step);
  return run({"octotomy-mesh3-labels", "CGAL's Mesh_3 of labels"}, sent(image), text.data(), limits);
}

}  // namespace octotomy::convert
