// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/large_memory.h"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "voxel/space/large_allocator.h"
#include "voxel/space/memory_need.h"

namespace octotomy::voxel {
namespace {

constexpr std::size_t mebi = std::size_t{1} << 20;
using Numbers = std::vector<std::uint32_t, LargeAllocator<std::uint32_t>>;

std::uint32_t number(std::size_t i) {
  return static_cast<std::uint32_t>(i * 2654435761U);
}

Numbers numbers(std::size_t bytes) {
  Numbers made(bytes / sizeof(std::uint32_t));
  for (std::size_t i = 0; i < made.size(); ++i) made[i] = number(i);
  return made;
}

bool are_right(const Numbers& made) {
  for (std::size_t i = 0; i < made.size(); ++i)
    if (made[i] != number(i)) return false;
  return true;
}

/// Mappings of this process that files without a name back.
int unnamed_files() {
  std::ifstream maps("/proc/self/maps");
  int count = 0;
  for (std::string line; std::getline(maps, line);) count += line.find("(deleted)") != std::string::npos;
  return count;
}

/// The status of a child process that runs `work`.
int status_of(int (*work)()) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 100;
}

class LargeMemory : public testing::Test {
 protected:
  void SetUp() override {
#ifdef OCTOTOMY_SANITIZED
    GTEST_SKIP() << "a sanitizer's shadow takes terabytes of data";
#endif
    ::setenv("TMPDIR", std::filesystem::current_path().c_str(), 1);
    if (room_for_large_blocks() < 2048 * mebi)
      GTEST_SKIP() << "the working folder's disk has less than 2 GiB free, or lies in memory";
  }
  void TearDown() override {
    ::unsetenv("TMPDIR");
  }
};

TEST_F(LargeMemory, ArraysBeyondTheLimitLieInFilesAndStayRight) {
  EXPECT_EQ(status_of([] {
              limit_memory(256 * mebi);
              const Numbers first = numbers(100 * mebi);
              if (unnamed_files() != 0) return 1;
              Numbers second = numbers(700 * mebi);
              if (unnamed_files() != 1) return 2;
              if (is_memory_over()) return 3;
              if (resident_file_bytes() > 680 * mebi) return 4;
              const Numbers moved = std::move(second);
              if (!are_right(first) || !are_right(moved)) return 5;
              Numbers copied = moved;
              if (unnamed_files() != 2 || !are_right(copied)) return 6;
              copied.push_back(1);
              copied.pop_back();
              if (unnamed_files() != 2 || !are_right(copied)) return 7;
              copied = Numbers();
              return unnamed_files() == 1 ? 0 : 8;
            }),
            0);
}

TEST_F(LargeMemory, ArraysLieInMemoryWhereNoDiskHasRoom) {
  EXPECT_EQ(status_of([] {
              ::setenv("TMPDIR", "/nowhere", 1);
              if (room_for_large_blocks() != 0) return 1;
              limit_memory(1024 * mebi);
              const Numbers made = numbers(600 * mebi);
              return unnamed_files() == 0 && are_right(made) ? 0 : 2;
            }),
            0);
}

TEST_F(LargeMemory, LimitsHalveForArrays) {
  EXPECT_EQ(status_of([] {
              limit_memory(1000 * mebi);
              return memory_for_large_blocks() <= 500 * mebi ? 0 : 1;
            }),
            0);
}

}  // namespace
}  // namespace octotomy::voxel
