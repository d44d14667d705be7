// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/memory_need.h"

#include <gtest/gtest.h>
#include <limits>
#include <new>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

TEST(NeedMemory, RefusesWithBothFiguresWhatDoesNotFit) {
  EXPECT_NO_THROW(need_memory("small.nrrd", 1000, 2));
  try {
    need_memory("large.nrrd", std::uint64_t{1} << 50, 2);
    FAIL() << "two million gigabytes fit";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Resource);
    const std::string text = error.what();
    EXPECT_NE(text.find("large.nrrd: "), std::string::npos);
    EXPECT_NE(text.find("GB of memory, "), std::string::npos);
    EXPECT_NE(text.find("--memory"), std::string::npos);
  }
  EXPECT_THROW(need_memory("absurd.nrrd", std::numeric_limits<std::uint64_t>::max(), 2), Error);
}

TEST(NeedRoom, RefusesWithTheFiguresOfMemoryAndDisk) {
  EXPECT_NO_THROW(need_room("small.nrrd", 1000, 2));
  try {
    need_room("large.nrrd", std::uint64_t{1} << 50, 2);
    FAIL() << "two million gigabytes fit";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Resource);
    const std::string text = error.what();
    for (const char* part : {"large.nrrd: ", "GB of memory", "of disk", "--memory", "TMPDIR"})
      EXPECT_NE(text.find(part), std::string::npos) << part;
  }
}

TEST(LimitMemory, BoundsWhatIsFreeAndWhatIsGiven) {
#ifdef OCTOTOMY_SANITIZED
  GTEST_SKIP() << "a sanitizer's shadow takes terabytes of data";
#endif
  const pid_t child = ::fork();
  if (child == 0) {
    limit_memory(std::uint64_t{512} << 20);
    if (free_memory() > std::uint64_t{512} << 20) ::_exit(1);
    if (is_memory_over()) ::_exit(4);
    const std::vector<char> more(std::size_t{600} << 20, 'x');
    if (!is_memory_over() || free_memory() != 0) ::_exit(more[54321] == 'x' ? 5 : 6);
    try {
      const std::vector<char> many(std::size_t{1} << 30, 'x');
      ::_exit(many[12345] == 'x' ? 2 : 3);
    } catch (const std::bad_alloc&) {
      ::_exit(0);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace octotomy::voxel
