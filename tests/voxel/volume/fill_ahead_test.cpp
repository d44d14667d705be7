// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/fill_ahead.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>
#include <tbb/global_control.h>
#include <vector>

namespace octotomy::voxel {
namespace {

char byte_at(std::size_t i) {
  return static_cast<char>(1 + (i ^ (i >> 12)) % 127);
}

TEST(FillAhead, KeepsWhatIsFilledInHoweverManyThreadsTouchPages) {
  for (const std::size_t threads : {1, 2, 4})
    for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{150} * 1000 * 1000 + 7}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      std::vector<char> memory(bytes + 1, 0);
      const char* next = memory.data();
      const std::size_t filled = fill_ahead(memory.data(), bytes, [&](char* part, std::size_t count) {
        EXPECT_EQ(part, next) << "parts follow each other";
        next += count;
        const auto first = static_cast<std::size_t>(part - memory.data());
        for (std::size_t i = 0; i < count; ++i) part[i] = byte_at(first + i);
        return count;
      });
      EXPECT_EQ(filled, bytes);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < bytes; ++i) wrong += memory[i] != byte_at(i);
      EXPECT_EQ(wrong, 0U) << threads << " threads, " << bytes << " bytes";
      EXPECT_EQ(memory[bytes], 0);
    }
}

TEST(FillAhead, EndsWhereAPartIsNotFilled) {
  std::vector<char> memory(100'000'000);
  int calls = 0;
  EXPECT_EQ(fill_ahead(memory.data(), memory.size(),
                       [&](char*, std::size_t count) { return ++calls == 3 ? 5 : count; }),
            std::size_t{8} * 1024 * 1024 + 5);
  EXPECT_EQ(calls, 3);
}

TEST(FillAhead, PassesOnWhatIsThrown) {
  std::vector<char> memory(100'000'000);
  int calls = 0;
  EXPECT_THROW(fill_ahead(memory.data(), memory.size(),
                          [&](char*, std::size_t count) {
                            if (++calls == 2) throw std::runtime_error("damaged");
                            return count;
                          }),
               std::runtime_error);
}

}  // namespace
}  // namespace octotomy::voxel
