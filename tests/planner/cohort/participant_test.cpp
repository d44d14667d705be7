// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/participant.h"

#include <functional>
#include <sys/stat.h>

#include "tests/file_bytes.h"
#include "tests/planner/cohort/ball_cohort.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using State = SubjectRecord::State;

class CohortParticipant : public tests::BallCohort {
 protected:
  /// Once its file was spoiled, the subject is not done and not evaluated, and the reason names the file.
  void expect_changed(const std::string& name, const std::function<void(const fs::path&)>& spoil) const {
    const Subject spoiled = subject("1");
    fs::remove_all(out_);
    ASSERT_EQ(run(spoiled).state, State::Done);
    ASSERT_EQ(subject_record(out_, spoiled).state, State::Done);
    spoil(out_ / "sub-1" / name);
    for (const SubjectRecord& record :
         {subject_record(out_, spoiled), run(spoiled), run(spoiled, true), subject_record(out_, spoiled)}) {
      EXPECT_EQ(to_string(record.state), "changed") << name;
      EXPECT_EQ(record.reason.rfind((out_ / "sub-1" / name).string() + ": is not as Octotomy wrote it", 0),
                0u)
          << record.reason;
    }
  }
};

TEST_F(CohortParticipant, AnAnswerThatWasChangedIsNotDone) {
  for (const std::string name : {"subject.json", "rows.csv", "result.json"}) {
    expect_changed(name, [](const fs::path& path) { std::ofstream(path, std::ios::app) << '\n'; });
    expect_changed(name, [](const fs::path& path) { tests::write_bytes(path, "no JSON"); });
    expect_changed(name, [](const fs::path& path) { tests::write_bytes(path, ""); });
  }
}

TEST_F(CohortParticipant, APipeOrDeviceInThePlaceOfAnAnswerIsNotWaitedFor) {
  for (const std::string name : {"subject.json", "rows.csv", "result.json"}) {
    expect_changed(name, [](const fs::path& path) {
      fs::remove(path);
      ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    });
    expect_changed(name, [](const fs::path& path) {
      fs::remove(path);
      fs::create_symlink("/dev/zero", path);
    });
  }
}

TEST_F(CohortParticipant, AnAnswerThatWasDeletedIsGivenAnew) {
  for (const std::string name : {"subject.json", "rows.csv", "result.json"}) {
    ASSERT_EQ(run(subject("1")).state, State::Done);
    fs::remove(out_ / "sub-1" / name);
    EXPECT_EQ(to_string(subject_record(out_, subject("1")).state), "missing") << name;
    const SubjectRecord anew = run(subject("1"));
    EXPECT_EQ(anew.state, State::Done) << anew.reason;
    EXPECT_FALSE(anew.was_kept);
    EXPECT_EQ(subject_record(out_, subject("1")).state, State::Done);
  }
}

TEST_F(CohortParticipant, APipeAsAScanFailsAtOnce) {
  fs::remove(folder_ / "ball.nrrd");
  ASSERT_EQ(::mkfifo((folder_ / "ball.nrrd").c_str(), 0600), 0);
  const SubjectRecord record = run(subject("1"));
  EXPECT_EQ(record.state, State::Failed);
  EXPECT_NE(record.reason.find("is a pipe or device"), std::string::npos) << record.reason;
}

}  // namespace
}  // namespace octotomy::planner
