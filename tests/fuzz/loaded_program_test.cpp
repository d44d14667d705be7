// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/fuzz/loaded_program.h"

#include <gtest/gtest.h>

#include "tests/voxel/scratch_folder.h"

namespace octotomy::tests {
namespace {

class LoadedProgramTest : public testing::Test {
 protected:
  static constexpr bool unchecked = false, checked = true;

  static Subject faulty() {
    Subject subject;
    subject.program = OCTOTOMY_FAULTY_PROGRAM;
    subject.seconds = 2.0;
    subject.resident_mib = 40;
    subject.computing_mib = 80;
    subject.batch = 10;
    return subject;
  }

  std::string fault(const std::string& asked, bool check = unchecked, bool may_lack = false) {
    return program_.judge({asked}, check, may_lack).fault;
  }

  ScratchFolder folder_;
  LoadedProgram program_{faulty(), folder_.path()};
};

TEST_F(LoadedProgramTest, AnswersAndRefusalsOfManyChildrenAreNoFaults) {
  for (int i = 0; i < 35; ++i) {
    const LoadedProgram::Judged read = program_.judge({"read"}, i % 7 == 0);
    EXPECT_EQ(read.fault, "") << i;
    EXPECT_EQ(read.outcome.out.find(R"({"calls": 0, )"), 0u) << read.outcome.out;
    const LoadedProgram::Judged refused = program_.judge({"refuse"}, i % 5 == 0);
    EXPECT_EQ(refused.fault, "") << i;
    EXPECT_EQ(refused.outcome.status, 2);
    EXPECT_EQ(refused.outcome.errors, "octotomy: no such file\n");
    EXPECT_EQ(refused.outcome.out, "");
  }
}

TEST_F(LoadedProgramTest, EveryFaultIsToldAndTheNextCaseRuns) {
  for (const auto& [asked, told] : std::vector<std::pair<std::string, std::string>>{
           {"abort", "ended by signal 6"},
           {"hang", "did not end within"},
           {"status 7", "status 7"},
           {"lack", "status 3"},
           {"two lines", "2 lines instead of one"},
           {"refuse late", "said something on standard output"},
           {"say nothing", "no JSON was said"},
           {"abort at exit", "ended by signal 6"},
#ifndef OCTOTOMY_SANITIZED
           {"keep 48 MiB", "MiB of memory"},
#endif
       }) {
    // An exit is seen at a child's last case, or where it is checked.
    const std::string fault = this->fault(asked, asked == "abort at exit");
    EXPECT_NE(fault.find(told), std::string::npos) << asked << ": '" << fault << "'";
    if (asked == "abort at exit") program_.judge({"abort"}, unchecked);  // a new child, without that exit
    EXPECT_EQ(this->fault("read"), "") << "after " << asked;
  }
}

TEST_F(LoadedProgramTest, WantOfResourcesIsARefusalWhereAllowed) {
  EXPECT_EQ(fault("lack", checked, true), "");
  EXPECT_EQ(fault("read", checked, true), "");
#ifndef OCTOTOMY_SANITIZED
  EXPECT_EQ(fault("keep 48 MiB", unchecked, true), "");
  EXPECT_NE(fault("keep 96 MiB", unchecked, true).find("MiB of memory"), std::string::npos);
#endif
}

TEST_F(LoadedProgramTest, AnExitThatCrashesIsSeenAtTheEndOfABatch) {
  fault("abort at exit");
  std::string told;
  for (unsigned i = 1; i < faulty().batch; ++i) told += fault("read");
  EXPECT_NE(told.find("in a batch status -6"), std::string::npos) << told;
}

TEST_F(LoadedProgramTest, WhatOneCaseLeavesToTheNextIsAFault) {
  EXPECT_EQ(fault("calls", checked), "");
  EXPECT_NE(fault("calls", checked).find("in a batch"), std::string::npos);
  EXPECT_EQ(fault("calls", unchecked), "");
  EXPECT_NE(fault("abort later").find("in a batch status -6"), std::string::npos);
}

TEST_F(LoadedProgramTest, TimeAndMemoryOfABatchAreNotHeldAgainstACase) {
  fault("read");
  EXPECT_EQ(fault("hang later"), "");
#ifndef OCTOTOMY_SANITIZED
  std::size_t most_mib = 0;
  for (int i = 0; i < 20; ++i) {
    const LoadedProgram::Judged judged = program_.judge({"keep 8 MiB"}, unchecked);
    EXPECT_EQ(judged.fault, "") << i;
    most_mib = std::max(most_mib, judged.outcome.resident_mib);
  }
  EXPECT_GT(most_mib, 24u);
#endif
}

TEST_F(LoadedProgramTest, AProgramThatHasThreadsBeforeMainIsNotForked) {
  setenv("FAULTY_THREAD", "1", 1);
  EXPECT_THROW(LoadedProgram(faulty(), folder_.path()), std::runtime_error);
  unsetenv("FAULTY_THREAD");
}

}  // namespace
}  // namespace octotomy::tests
