// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What a user put somewhere is there after a verb that fails: outputs are refused before the work, and
// written together or not at all.
#include "planner/operation/file/outputs.h"

#include <map>
#include <sys/mount.h>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "tests/brep/shapes.h"
#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using brep::shapes::together;

/// In a folder with the ball's scan, a folder `d` with the extension of each output, and a file `mine` that
/// every test tries to lose.
class VerbOutputs : public tests::CommandLine {
 protected:
  VerbOutputs() {
    for (const char* name : {"d.octree", "d.json", "d.png"}) fs::create_directory(folder_ / name);
    brep::write_mesh(brep::shapes::sphere({0, 0, 0}, 10.0, 2), folder_ / "a.stl");
    brep::write_mesh(brep::shapes::sphere({0, 0, 0}, 11.0, 2), folder_ / "b.stl");
  }
  /// Runs a shell's command in the folder; its output is stored elsewhere.
  tests::CommandAnswer shell(const std::string& line) const {
    return tests::run_command("{ cd " + at("") + " && " + line + "; }", said_ / "");
  }
  tests::CommandAnswer run(const std::string& arguments) const {
    return shell(OCTOTOMY_BINARY_DIR "/octotomy " + arguments);
  }
  /// A verb that stands still as soon as a file is there, and goes on after `meanwhile`, whose $! it is.
  tests::CommandAnswer stopped_at(const std::string& file, const std::string& arguments,
                                  const std::string& meanwhile) const {
    return shell("{ " OCTOTOMY_BINARY_DIR "/octotomy " + arguments +
                 " & } && for i in $(seq 3000); do [ -e " + file +
                 " ] && break; sleep 0.01; done; kill -STOP $!; " + meanwhile + "; kill -CONT $!; wait $!");
  }
  std::string bytes(const std::string& name) const { return tests::bytes_of(folder_ / name); }
  /// The files in the folder, with their bytes.
  std::map<std::string, std::string> all() const {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_.path()))
      files[entry.path().string()] = entry.is_regular_file() ? tests::bytes_of(entry.path()) : "";
    return files;
  }
  /// Expects a refusal that leaves every file unchanged.
  void expect_untouched(const std::string& arguments, const std::string& word) const {
    SCOPED_TRACE(arguments);
    const auto before = all();
    expect_refused(run(arguments), word);
    EXPECT_TRUE(before == all()) << "a file was made, changed or removed";
  }

 private:
  tests::ScratchFolder said_;
};

const std::string follow = "contours ball.nrrd --window 0: ";

TEST_F(VerbOutputs, AFolderInPlaceOfTheSecondFileLeavesTheFirst) {
  for (const char* name : {"old.nrrd", "c.ply", "c.json", "c.octree"}) write(name, "mine");
  const std::string taken = "is not replaced";
  expect_untouched("prepare ball.nrrd --step remove_headrest=-300,5,3,5 -o old.nrrd --removed d.octree",
                   taken);
  expect_untouched("prepare ball.nrrd --step remove_headrest=-300,5,3,5 -o ball.nrrd --removed d.octree",
                   taken);
  expect_untouched("compare a.stl b.stl -o c.ply --picture d.png", taken);
  expect_untouched(follow + "-o c.json --codes d.json", taken);
  expect_untouched("segment ball.nrrd --window 0: -o c.octree --contours d.json", taken);
  expect_untouched("segment ball.nrrd --named x -o c.octree --contours c.json", "--window");
}

TEST_F(VerbOutputs, AFolderInPlaceOfALaterPieceLeavesTheOthers) {
  brep::write_mesh(
      together(brep::shapes::sphere({0, 0, 0}, 10.0, 2), brep::shapes::box({30, 30, 30}, {34, 34, 34})),
      folder_ / "p.stl");
  ASSERT_EQ(run("separate p.stl -o q.stl").status, 0);
  fs::remove(folder_ / "q-2.stl");
  fs::create_directory(folder_ / "q-2.stl");
  expect_untouched("separate p.stl -o q.stl --least 1", "q-2.stl: is a folder");
}

TEST_F(VerbOutputs, AFileThatNobodyTypedAndOctotomyDidNotWriteStays) {
  brep::write_mesh(
      together(brep::shapes::sphere({0, 0, 0}, 10.0, 2), brep::shapes::box({30, 30, 30}, {34, 34, 34})),
      folder_ / "p.stl");
  ASSERT_EQ(run("segment ball.nrrd --window 0: -o labels.nrrd").status, 0);
  for (const auto& [verb, file] : {std::pair{"separate p.stl -o q.stl", "q-2.stl"},
                                   std::pair{"surfaces labels.nrrd -o '{name}.ply'", "label_1.ply"}}) {
    const std::string refused = std::string(file) + ": is there already";
    write(file, "mine");
    expect_untouched(verb, refused);
    fs::remove(folder_ / file);
    fs::create_symlink("a.stl", folder_ / file);
    expect_untouched(verb, refused);
    fs::remove(folder_ / file);
    EXPECT_EQ(run(verb).status, 0);
  }
}

TEST_F(VerbOutputs, APieceDoesNotReplaceTheSurfaceThatItIsOf) {
  for (const char* name : {"p-1.stl", "p-2.stl"}) {
    brep::write_mesh(
        together(brep::shapes::sphere({0, 0, 0}, 10.0, 2), brep::shapes::box({30, 30, 30}, {34, 34, 34})),
        folder_ / name);
    expect_untouched(std::string("separate ") + name + " -o p.stl", "which this run reads");
  }
  EXPECT_EQ(run("separate p-1.stl --piece 1 -o p-1.stl").status, 0) << "a name that was typed";
}

TEST_F(VerbOutputs, OneFileForTwoOutputsIsRefused) {
  ASSERT_EQ(run(follow + "-o x.json").status, 0);
  fs::create_symlink("x.json", folder_ / "link.json");
  fs::create_symlink("new.json", folder_ / "open.json");
  fs::create_hard_link(folder_ / "x.json", folder_ / "hard.json");
  for (const char* second : {"x.json", "./x.json", "link.json", "hard.json"})
    expect_untouched(follow + "-o x.json --codes " + second, "is the same file as");
  expect_untouched(follow + "-o new.json --codes new.json", "is the same file as");
  expect_untouched(follow + "-o new.json --codes open.json", "is the same file as");
  expect_untouched("contours x.json -o new.json --codes x.json", "which this run reads");
  ASSERT_EQ(run("contours x.json -o x.json").status, 0) << "one output may replace what it is made of";
  ASSERT_EQ(run(follow + "-o x.json --codes y.json").status, 0);
  EXPECT_NE(bytes("x.json"), bytes("y.json"));
}

TEST_F(VerbOutputs, AnExtensionOfSomethingElseIsRefused) {
  ASSERT_EQ(run("octree ball.nrrd --window 0: -o ball.octree").status, 0);
  write("v.nrrd", "mine");
  const std::string not_json = "written as .json", not_form = "use .txt";
  expect_untouched(follow + "-o x.json --codes v.nrrd", not_json);
  expect_untouched("segment ball.nrrd --window 0: --contours v.nrrd", not_json);
  for (const char* form : {"linear", "bits"})
    for (const char* out : {"v.nrrd", "ball.octree", "x.json", "x.stl"})
      expect_untouched(std::string("octree ball.octree --as ") + form + " -o " + out, not_form);
  for (const char* out : {"x.bin", "x.txt", "x.linear", "x"})
    EXPECT_EQ(run(std::string("octree ball.octree --as linear -o ") + out).status, 0) << out;
  expect_untouched("render ball.octree -o v.nrrd", "written as .png");
  expect_untouched("slice ball.nrrd -o v.nrrd", "written as .png");
  expect_untouched("measure a.stl --thickness -o v.nrrd", "written as .vtp");
  expect_untouched("measure ball.octree -o v.vtp", "--thickness");
  write("marks.json", R"({"landmarks": [{"name": "ans", "point_mm": [0, 0, 0]}]})");
  expect_untouched("procedure le_fort_i --scan ball.nrrd --landmarks marks.json -o v.nrrd",
                   "written as .json");
}

TEST_F(VerbOutputs, ADataFileThatIsNotTheHeadersOwnStays) {
  for (const auto& [header, data] : {std::pair{"k.nhdr", "k.raw.gz"}, std::pair{"k.mhd", "k.zraw"}}) {
    write(data, "mine");
    expect_untouched(std::string("convert ball.nrrd -o ") + header, data);
    write(header, "no header");
    expect_untouched(std::string("convert ball.nrrd -o ") + header, data);
    for (const char* name : {header, data}) fs::remove(folder_ / name);
    for (int i = 0; i < 2; ++i)
      ASSERT_EQ(run(std::string("convert ball.nrrd -o ") + header).status, 0)
          << "the second replaces its own";
    ASSERT_EQ(run(std::string("prepare ") + header + " --step gaussian=1 -o " + header).status, 0);
    EXPECT_EQ(run(std::string("info ") + header).status, 0);
  }
  // The header has its samples in another file.
  std::string header = bytes("k.mhd");
  header.replace(header.find("k.zraw"), 6, "m.data");
  write("m.mhd", header);
  fs::rename(folder_ / "k.zraw", folder_ / "m.data");
  ASSERT_EQ(run("info m.mhd").status, 0);
  write("m.zraw", "mine");
  expect_untouched("prepare m.mhd --step gaussian=1 -o m.mhd", "m.zraw");
  fs::create_symlink("k.nhdr", folder_ / "link.nhdr");
  expect_untouched("convert ball.nrrd -o link.nhdr", "is a link");
}

TEST_F(VerbOutputs, AnOlderHeaderIsRefusedWhereItsSamplesWereReplaced) {
  for (const auto& [header, data] : {std::pair{"k.nhdr", "k.raw.gz"}, std::pair{"k.mhd", "k.zraw"}}) {
    ASSERT_EQ(run(std::string("convert ball.nrrd -o ") + header).status, 0);
    const std::string older = bytes(header);
    ASSERT_EQ(run(std::string("prepare ball.nrrd --step gaussian=1 -o ") + header).status, 0);
    EXPECT_FALSE(fs::exists(folder_ / data)) << "the new samples have another name, the old ones are gone";
    EXPECT_EQ(run(std::string("info ") + header).status, 0);
    write(header, older);
    expect_refused(run(std::string("info ") + header), data);
    fs::remove(folder_ / header);
  }
}

TEST_F(VerbOutputs, ADeckDoesNotReplaceFilesOfNoDeck) {
  write("t.ele", "mine");
  expect_untouched("tet a.stl -o t.node", "t.ele");
  fs::remove(folder_ / "t.ele");
  for (int i = 0; i < 2; ++i) ASSERT_EQ(run("tet a.stl -o t.node").status, 0);
}

TEST_F(VerbOutputs, APlanIsNotWrittenWithoutItsReport) {
  write("marks.json", R"({"landmarks": [{"name": "ans", "point_mm": [0, 0, 0]}]})");
  write("own.json", R"({"procedure": "own", "says": "Own.", "landmarks": [{"name": "ans", "says": "any."}],
      "values": [], "steps": [{"id": "bone", "do": "window", "scan": "ct", "low": 0}]})");
  fs::create_directory(folder_ / "full");
  write("full/a.txt", "mine");
  write("p.plan.json", "mine");
  expect_untouched("procedure own.json --scan ball.nrrd --landmarks marks.json -o p.plan.json --report full",
                   "full");
}

TEST_F(VerbOutputs, AnInterruptedSeriesLeavesNothing) {
  write("flat.raw", std::string(2 * 16 * 16 * 3000, '\0'));
  const auto before = all();
  // Two signals end the verb at once, between the first slice and the last.
  const tests::CommandAnswer answer =
      stopped_at(".octotomy-*/series/slice_0001.dcm",
                 "convert flat.raw --raw 16x16x3000 int16 --spacing 1,1,1 --dicom -o series",
                 "kill -TERM $!; kill -INT $!");
  EXPECT_EQ(answer.status, 3) << answer.errors;
  EXPECT_NE(answer.errors.find("interrupted"), std::string::npos) << answer.errors;
  EXPECT_TRUE(before == all()) << "something was left";
}

TEST_F(VerbOutputs, ALookShowsPicturesFirstAndTakesThemBackWhenItIsInterrupted) {
  ASSERT_EQ(run("phantom head -o head.nrrd").status, 0);
  const auto before = all();
  const tests::CommandAnswer answer = stopped_at("seen/report.html", "look head.nrrd -o seen",
                                                 "ls seen/views; cat seen/result.json; kill -TERM $!");
  EXPECT_EQ(answer.status, 3) << answer.errors;
  EXPECT_NE(answer.out.find("bone_anterior.png"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("\"audit\": ["), std::string::npos);
  EXPECT_NE(answer.out.find("\"certificates\": []"), std::string::npos);
  EXPECT_TRUE(before == all()) << "something was left";
}

TEST_F(VerbOutputs, AFullDiskTakesNeitherOfTwoFiles) {
  ASSERT_EQ(run(follow + "-o c.json --codes e.json").status, 0);
  const fs::path disk = folder_ / "disk";
  fs::create_directory(disk);
  // A page less than both take.
  const auto pages = [&](const char* name) { return (fs::file_size(folder_ / name) + 4095) / 4096; };
  const std::string size = "size=" + std::to_string(4 * (pages("c.json") + pages("e.json") - 1)) + "k";
  if (::mount("none", disk.c_str(), "tmpfs", 0, size.c_str()) != 0)
    GTEST_SKIP() << "mounting a small disk needs root";
  const tests::CommandAnswer answer = run(follow + "-o disk/c.json --codes disk/e.json");
  const bool is_empty = fs::is_empty(disk);
  ::umount(disk.c_str());
  EXPECT_EQ(answer.status, 3) << answer.errors;
  EXPECT_NE(answer.errors.find("disk/e.json: cannot be written"), std::string::npos) << answer.errors;
  EXPECT_TRUE(is_empty) << "a file was left on the disk";
}

}  // namespace
}  // namespace octotomy::planner
