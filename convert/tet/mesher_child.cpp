// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/mesher_child.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace octotomy::convert {
namespace {

void limit(__rlimit_resource resource, std::uint64_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

[[noreturn]] void end(int status) {
  std::fflush(stdout);
  _exit(status);
}

MesherTask begin() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  MesherTask task;
  task.answer_file = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  if (!read_all(&task.request, sizeof task.request) || task.request.version != MesherRequest::this_version)
    end(mesher_exit_protocol);
  // The parent may have ended before prctl().
  if (task.request.parent != ::getppid()) end(mesher_exit_protocol);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_AS, task.request.memory_limit_bytes);
  limit(RLIMIT_CPU, task.request.cpu_limit_seconds);
  return task;
}

}  // namespace

bool read_all(void* target, std::size_t bytes) {
  auto* at = static_cast<std::byte*>(target);
  while (bytes > 0) {
    const ssize_t got = read(STDIN_FILENO, at, bytes);
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int file, const void* source, std::size_t bytes) {
  const auto* at = static_cast<const std::byte*>(source);
  while (bytes > 0) {
    const ssize_t put = write(file, at, bytes);
    if (put <= 0) return false;
    at += put;
    bytes -= static_cast<std::size_t>(put);
  }
  return true;
}

void run_mesher(bool (*answer)(const MesherTask&)) {
  const MesherTask task = begin();
  int status = 0;
  try {
    if (!answer(task)) status = mesher_exit_protocol;
  } catch (int reason) {
    // TetGen's exit reason; 1 means that memory was exhausted.
    status = reason == 1 ? mesher_exit_memory : mesher_exit_base + (reason & 15);
  } catch (const std::bad_alloc&) {
    status = mesher_exit_memory;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    status = mesher_exit_base + 2;
  }
  end(status);
}

}  // namespace octotomy::convert
