// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A library that is preloaded into a program (LD_PRELOAD) and has it serve cases in place of running main()
// once: loading and linking, most of what a short run costs, are then paid once. Its only argument is the
// number of the socket that requests come from; standard output and error are files opened for appending,
// which hold what the case under way said.
//
// 1. The server is the process as it is just before main(). It has one thread and never runs main().
// 2. It forks a child, says that it begins, and waits for its end, which it reports. Then it forks the next.
// 3. A child runs main() for one request after the other.
// The server ends when its harness is gone.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "tests/fuzz/case_report.h"

namespace {

using octotomy::tests::CaseReport;
using Main = int (*)(int, char**, char**);
using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);

Main program_main = nullptr;

void tell(int socket, const CaseReport& report) {
  if (send(socket, &report, sizeof report, MSG_NOSIGNAL) != sizeof report) _exit(0);
}

[[noreturn]] void run_cases(int socket, char* program, char** environment) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::vector<char> request(std::size_t{1} << 16);
  for (;;) {
    const ssize_t size = recv(socket, request.data(), request.size(), 0);
    if (size <= 0) _exit(0);
    std::vector<char*> words{program};
    for (char* word = request.data() + 1; word < request.data() + size; word += std::strlen(word) + 1)
      words.push_back(word);
    words.push_back(nullptr);
    if (ftruncate(STDOUT_FILENO, 0) != 0 || ftruncate(STDERR_FILENO, 0) != 0) std::abort();
    const int status = program_main(static_cast<int>(words.size()) - 1, words.data(), environment);
    if (request[0] == octotomy::tests::last_of_child) std::exit(status);
    std::cout.flush();
    std::fflush(nullptr);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    tell(socket, {CaseReport::Returned, getpid(), status & 0xff, usage.ru_maxrss});
  }
}

int serve(int count, char** arguments, char** environment) {
  if (count != 2) std::abort();
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int socket = std::atoi(arguments[1]);
  fcntl(socket, F_SETFD, FD_CLOEXEC);
  // A child would hold another thread's locks for ever. The harness detects that the server ended.
  const std::filesystem::directory_iterator threads("/proc/self/task");
  if (std::distance(begin(threads), end(threads)) != 1) std::abort();
  for (;;) {
    const pid_t child = fork();
    if (child == 0) run_cases(socket, arguments[0], environment);
    if (child < 0) std::abort();
    tell(socket, {CaseReport::Begun, child, 0, 0});
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    tell(socket, {CaseReport::Ended, child, WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
                  usage.ru_maxrss});
  }
}

}  // namespace

/// The C library's entry, which the program's start calls with its main().
extern "C" int __libc_start_main(Main main, int count, char** arguments, void (*init)(), void (*finish)(),
                                 void (*loader_finish)(), void* stack_end) {
  program_main = main;
  unsetenv("LD_PRELOAD");  // the programs that this one starts run as ever
  const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(serve, count, arguments, init, finish, loader_finish, stack_end);
}
