// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A program that does wrong when asked to, for the test of what runs programs with damaged files.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

int calls = 0;
std::vector<std::string> kept;

/// Allocates this number of MiB and writes to them.
void keep(std::size_t mib) {
  kept.emplace_back(mib << 20, 'x');
}

int refuse(const char* text) {
  std::fputs(text, stderr);
  return 2;
}

[[maybe_unused]] const bool has_thread = [] {
  if (std::getenv("FAULTY_THREAD") != nullptr) std::thread([] { pause(); }).detach();
  return true;
}();

}  // namespace

int main(int count, char** arguments) {
  ++calls;
  const std::string asked = count > 1 ? arguments[1] : "";
  if (asked == "abort" || (asked == "abort later" && calls > 1)) std::abort();
  if (asked == "abort at exit") std::atexit([] { std::abort(); });
  if (asked == "hang" || (asked == "hang later" && calls > 1)) pause();
  if (asked == "status 7") return 7;
  if (asked == "lack") std::_Exit(refuse("octotomy: no memory\n") + 1);
  if (asked == "refuse") return refuse("octotomy: no such file\n");
  if (asked == "two lines") return refuse("octotomy: no such file\nand more\n");
  if (asked == "keep 8 MiB") keep(8);
  if (asked == "keep 48 MiB") keep(48);
  if (asked == "keep 96 MiB") keep(96);
  if (asked == "say nothing") return 0;
  std::printf(R"({"calls": %d, "timings_ms": {"all": %d}})", asked == "calls" ? calls : 0, getpid());
  if (asked == "refuse late") return refuse("octotomy: no such file\n");
  return 0;
}
