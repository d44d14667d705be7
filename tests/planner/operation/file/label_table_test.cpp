// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/label_table.h"

#include <fstream>
#include <gtest/gtest.h>
#include <tuple>

#include "tests/planner/cli/program/command_line.h"
#include "voxel/scan/write_dicom_seg.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::ScratchFolder;
using tests::SortedJson;

using Names = std::map<int, std::string>;

std::filesystem::path put(const ScratchFolder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

TEST(LabelTable, EachProgramsTableGivesTheSameNames) {
  const ScratchFolder folder;
  const Names expected{{2, "left kidney"}, {5, "liver"}};
  for (const auto& [name, text] : {
           std::pair<const char*, const char*>{"by_name.json",
                                               R"({"liver": 5, "left kidney": 2, "background": 0})"},
           {"by_label.json", R"({"2": "left kidney", "5": "liver"})"},
           {"nested.json",
            R"({"labels": {"background": 0, "left kidney": 2, "liver": 5}, "channels": {"0": "CT"}})"},
           {"list.json", R"([{"label": 5, "name": "liver"}, {"label": 2, "name": "left kidney"}])"},
           {"plain.csv", "5,liver\n2,left kidney\n"},
           {"headed.csv", "Color,Name,LabelValue\nred,liver,5\nblue,\"left kidney\",2\n"},
           {"semicolons.csv", "Label;Name\n5;liver\n2;left kidney\n"},
           {"slicer.ctbl", "# Color table\n5 liver 9 9 9 255\n2 left_kidney 0 9 0 255\n"},
           {"shares.ctbl", "5 liver 0.9 0.9 0.9 1\n2 left kidney 0 .5 0 1.0\n"},
           {"words.ctbl", "5 liver 9 9 9 255\n2 left kidney 0 9 0 255\n"},
           {"headed.tsv", "index\tname\n5\tliver\n2\tleft kidney\n"},
           {"snap.txt",
            "# ITK-SNAP\n    0     0    0    0        0  0  0    \"Clear Label\"\n"
            "    5   255    0    0        1  1  1    \"liver\"\n    2 0 9 0 1 1 1 \"left kidney\"\r\n"},
       })
    EXPECT_EQ(read_label_table(put(folder, name, text)).names, expected) << name;
  EXPECT_EQ(
      read_label_table(put(folder, "slicer.ctbl", "# Color table\n0 background 0 0 0 0\n5 liver 9 9 9 255\n"))
          .names,
      (Names{{5, "liver"}}));
}

TEST(LabelTable, ASpoiledTableIsRefusedByItsLine) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& text) {
    try {
      read_label_table(put(folder, name, text));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(refusal("a.json", R"({"2": "liver", "5": "liver"})").find("the name of two labels, 2 and 5"),
            std::string::npos);
  EXPECT_NE(refusal("b.csv", "5,liver\n5,spleen\n").find("b.csv:2: label 5 has two names"),
            std::string::npos);
  EXPECT_NE(refusal("c.csv", "colour,organ\nred,liver\n").find("must be a heading"), std::string::npos);
  std::string all;
  for (int label = 1; label < 32767; ++label)
    all += std::to_string(label) + ",part" + std::to_string(label) + "\n";
  EXPECT_EQ(refusal("all.csv", all), "taken");
  EXPECT_NE(refusal("again.csv", all + "32767,part2\n")
                .find("again.csv:32767: 'part2' is the name of two labels, 2 and 32767"),
            std::string::npos);
  EXPECT_NE(refusal("d.txt", "5 255 0 0 1 1 1 \"liver\"\nliver 5\n").find("d.txt:2"), std::string::npos);
  EXPECT_NE(refusal("e.json", R"({"liver": true})").find("liver"), std::string::npos);
  EXPECT_NE(refusal("g.json", R"([{"label": "liver", "name": "liver"}])").find("has no label"),
            std::string::npos);
  EXPECT_NE(
      refusal("h.csv", "label,name,id\n5,liver,1\nsix,spleen,2\n").find("h.csv:3: must have a label from 0"),
      std::string::npos);
  EXPECT_NE(refusal("i.csv", "1,10,liver\n2,20,spleen\n").find("i.csv:1: has numbers in its second column"),
            std::string::npos);
  EXPECT_NE(refusal("f.csv", "5,liver\nsix,spleen\n").find("f.csv:2"), std::string::npos);
}

TEST(LabelTable, RowsThatNameNoLabelArePassedOverByTheirLine) {
  const ScratchFolder folder;
  const Names expected{{2, "left kidney"}, {5, "liver"}};
  for (const auto& [name, text, told] :
       {std::tuple<const char*, std::string, const char*>{
            "a.csv", "label,name\n-1,unknown\n5,liver\n2,left kidney\n", "a.csv:2: the row is left out"},
        {"b.csv", "5,liver\n2,left kidney\n40000000,spleen\n", "b.csv:3"},
        {"c.tsv", "index\tname\n5\tliver\n\tspleen\n2\tleft kidney\n",
         "c.tsv:3: the row is left out, because it has no label"},
        {"d.tsv", "index\tname\n5\tliver\n7\t\n2\tleft kidney\n", "label 7 has no name"},
        {"e.txt", "Label Name R G B A\n5 liver 9 9 9 255\n2 left kidney 0 9 0 255\n",
         "e.txt:1: the row is left out, because it is a heading"},
        {"f.ctbl", "-1 unknown 0 0 0 0\n5 liver 9 9 9 255\n2 left_kidney 0 9 0 255\n", "f.ctbl:1"}}) {
    const LabelTable table = read_label_table(put(folder, name, text));
    EXPECT_EQ(table.names, expected) << name;
    ASSERT_EQ(table.passed_over.size(), 1u) << name;
    EXPECT_NE(table.passed_over[0].find(told), std::string::npos) << table.passed_over[0];
  }
  EXPECT_TRUE(read_label_table(put(folder, "g.csv", "5,liver\n")).passed_over.empty());
  std::string many = "5,liver\n";
  for (int i = 1; i <= 20; ++i) many += "-" + std::to_string(i) + ",none\n";
  EXPECT_EQ(read_label_table(put(folder, "h.csv", many)).passed_over.size(), 9u);
}

TEST(LabelTable, RowsOfJsonThatNoLabelMapCanHaveArePassedOverToo) {
  const ScratchFolder folder;
  const Names expected{{2, "left kidney"}, {5, "liver"}};
  for (
      const auto& [name, text, told] :
      {std::tuple<const char*, const char*, const char*>{"a.json",
                                                         R"({"liver": 5, "ignore": -1, "left kidney": 2})",
                                                         "a.json: ignore: the row is left out"},
       {"b.json", R"({"5": "liver", "-1": "unknown", "2": "left kidney"})", "b.json: -1: the row"},
       {"c.json",
        R"([{"label": -1, "name": "x"}, {"label": 5, "name": "liver"}, {"label": 2, "name": "left kidney"}])",
        "c.json[0]: the row is left out, because labels cannot have the number -1"},
       {"d.json",
        R"([{"id": 5, "label": "liver"}, {"id": null, "label": "x"}, {"id": 2, "label": "left kidney"}])",
        "d.json[1]: the row is left out, because it has no label"}}) {
    const LabelTable table = read_label_table(put(folder, name, text));
    EXPECT_EQ(table.names, expected) << name;
    ASSERT_EQ(table.passed_over.size(), 1u) << name;
    EXPECT_NE(table.passed_over[0].find(told), std::string::npos) << table.passed_over[0];
  }
}

TEST(LabelTable, HeadingsOfOtherProgramsAreRead) {
  const ScratchFolder folder;
  const Names expected{{2, "left kidney"}, {5, "liver"}};
  for (const auto& [name, text] :
       {std::pair<const char*, const char*>{"a.csv", "No.,Label\n5,liver\n2,left kidney\n"},
        {"b.csv", "#No.,Label Name:,R\n5,liver,1\n2,left kidney,2\n"},
        {"c.csv", "Name,Label-Value\nliver,5\nleft kidney,2\n"},
        {"d.csv", "ID;Structure Name\n5;liver\n2;left kidney\n"},
        {"e.csv", "label,id\nliver,5\nleft kidney,2\n"},
        {"f.tsv", "index\tlabel\n5\tliver\n2\tleft kidney\n"},
        {"g.json",
         R"([{"LabelValue": 5, "Name": "liver"}, {"label_value": "2", "label_name": "left kidney"}])"},
        {"h.json",
         R"({"labels": [{"value": 5.0, "name": "liver"}, {"No.": 2, "Description": "left kidney"}]})"},
        {"i.lut", "5 0.9 0.9 0.9 liver\n2 0 0.5 0 left kidney\n"},
        {"j.txt", "# Label description\n5 255 0 0 1 1 1 liver\n2 0 9 0 1 1 1 left kidney\n"}}) {
    const LabelTable table = read_label_table(put(folder, name, text));
    EXPECT_EQ(table.names, expected) << name;
    EXPECT_TRUE(table.passed_over.empty()) << name;
  }
  const LabelTable headed =
      read_label_table(put(folder, "k.txt", "LabelValue Name R G B\n5 liver 9 9 9\n2 left kidney 0 9 0\n"));
  EXPECT_EQ(headed.names, expected);
  EXPECT_EQ(headed.passed_over.size(), 1u);
}

TEST(LabelTable, OfBidsTheIndexIsTheLabelAndOtherNumbersAreReported) {
  const ScratchFolder folder;
  const LabelTable bids =
      read_label_table(put(folder, "a_dseg.tsv", "label\tname\tindex\n11\tliver\t1\n12\tspleen\t2\n"));
  EXPECT_EQ(bids.names, (Names{{1, "liver"}, {2, "spleen"}}));
  ASSERT_EQ(bids.passed_over.size(), 1u);
  EXPECT_NE(bids.passed_over[0].find("WARN: the labels are read from the column 'index'; the column 'label'"),
            std::string::npos)
      << bids.passed_over[0];
  // A program's own table has its row numbers in "index".
  const LabelTable rows =
      read_label_table(put(folder, "b.csv", "index,label,name\n0,11,liver\n1,12,spleen\n"));
  EXPECT_EQ(rows.names, (Names{{11, "liver"}, {12, "spleen"}}));
  ASSERT_EQ(rows.passed_over.size(), 1u);
  EXPECT_NE(rows.passed_over[0].find("the column 'index' has other numbers"), std::string::npos);
  EXPECT_TRUE(read_label_table(put(folder, "c.tsv", "index\tlabel\tname\n1\t1\tliver\n2\t2\tspleen\n"))
                  .passed_over.empty());
}

TEST(LabelTable, OtherEncodingsAreReadAndSaid) {
  const ScratchFolder folder;
  const auto in_16_bits = [](const std::u16string& text, bool is_big) {
    std::string bytes;
    for (const char16_t unit : u"\ufeff" + text) {
      const char low = static_cast<char>(unit & 0xff), high = static_cast<char>(unit >> 8);
      bytes += is_big ? high : low;
      bytes += is_big ? low : high;
    }
    return bytes;
  };
  const Names expected{{5, "Gelenkh\u00f6cker"}, {6, "\U0001f9b7"}};
  const std::u16string text = u"5,Gelenkh\u00f6cker\n6,\U0001f9b7\n";
  for (const bool is_big : {false, true}) {
    const LabelTable table = read_label_table(put(folder, "a.csv", in_16_bits(text, is_big)));
    EXPECT_EQ(table.names, expected) << is_big;
    ASSERT_EQ(table.passed_over.size(), 1u);
    EXPECT_NE(table.passed_over[0].find("UTF-16"), std::string::npos);
  }
  const LabelTable latin = read_label_table(put(folder, "b.txt",
                                                "5 255 0 0 1 1 1 \"Gelenkh\xf6"
                                                "cker\"\n"));
  EXPECT_EQ(latin.names, (Names{{5, "Gelenkh\u00f6cker"}}));
  ASSERT_EQ(latin.passed_over.size(), 1u);
  EXPECT_NE(latin.passed_over[0].find("Latin-1, which is assumed"), std::string::npos);
  const LabelTable plain = read_label_table(put(folder, "c.csv",
                                                "\xef\xbb\xbf"
                                                "5,Gelenkh\u00f6cker\n"));
  EXPECT_EQ(plain.names, (Names{{5, "Gelenkh\u00f6cker"}}));
  EXPECT_TRUE(plain.passed_over.empty());
}

TEST(LabelTable, ANameMatchesWhetherItsMarksAreCombinedOrNot) {
  const LabelTable table{{{5, "Gelenkho\u0308cker"}, {6, "\u010celjust"}, {7, "Gelenkhocker"}}, "a.csv"};
  EXPECT_EQ(table.label("Gelenkh\u00f6cker"), 5);
  EXPECT_EQ(table.label("Gelenkho\u0308cker"), 5);
  EXPECT_EQ(table.label("C\u030celjust"), 6);
  EXPECT_EQ(table.label("Gelenkhocker"), 7);
  EXPECT_THROW(table.label("Gelenkho\u0301cker"), std::runtime_error);
}

TEST(LabelTable, OfALabelMapIsItsOwnOrTheOneBesideItAndOfADicomSegmentationItsSegments) {
  const ScratchFolder folder;
  const auto slicer =
      put(folder, "a.seg.nrrd",
          "NRRD0004\ntype: short\nSegment0_ID:=S1\nSegment0_Name:=Mandible\nSegment0_LabelValue:=7\n"
          "Segment1_Name:=Maxilla\nSegment1_LabelValue:=3\n\nSegment2_Name:=samples\n");
  EXPECT_EQ(label_table_of(slicer).names, (Names{{3, "Maxilla"}, {7, "Mandible"}}));
  EXPECT_TRUE(label_table_of(put(folder, "b.nii.gz", "")).names.empty());
  put(folder, "b_labels.csv", "4,hyoid\n");
  EXPECT_EQ(label_table_of(folder / "b.nii.gz").label("hyoid"), 4);
  EXPECT_EQ(label_table_of(folder / "b.nii.gz").file, folder / "b_labels.csv");
  voxel::Universe universe;
  universe.depth = 3;
  voxel::write_dicom_seg(voxel::combine(universe, voxel::Sphere{{3, 3, 3}, 2.0}), folder / "c.dcm",
                         {.label = "Skull"});
  EXPECT_EQ(label_table_of(folder / "c.dcm").names, (Names{{1, "Skull"}}));
}

TEST(LabelTable, ANameOfTwoLabelsIsRefusedWithBothNumbers) {
  const LabelTable table{{{2, "Bone"}, {5, "Fat"}, {7, "Bone"}}, "a.seg.nrrd"};
  EXPECT_EQ(table.label("Fat"), 5);
  try {
    table.label("Bone");
    FAIL() << "one of two labels was chosen";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("a.seg.nrrd: has 2 labels 'Bone', with the numbers 2, 7"),
              std::string::npos)
        << error.what();
  }
}

TEST(LabelTable, ATableThatContradictsTheUsedOneIsReportedAndOneThatAgreesIsNot) {
  const ScratchFolder folder;
  const auto map = put(folder, "a.nii.gz", "");
  put(folder, "a.json", R"({"Fat": 1, "Bone": 2})");
  put(folder, "a.csv", "1,Fat\n2,Bone\n3,Air\n");
  EXPECT_TRUE(label_table_of(map, {1, 2}).passed_over.empty());
  for (const char* other : {"1,Bone\n2,Fat\n", "1,Fat\n2,Muscle\n", "1,Fat\n3,Bone\n"}) {
    put(folder, "a.csv", other);
    const LabelTable table = label_table_of(map, {1, 2});
    EXPECT_EQ(table.names, (Names{{1, "Fat"}, {2, "Bone"}}));
    ASSERT_EQ(table.passed_over.size(), 1U) << other;
    EXPECT_NE(table.passed_over[0].find("a.csv: is not used, because it contradicts"), std::string::npos)
        << table.passed_over[0];
  }
  const auto slicer =
      put(folder, "b.seg.nrrd", "NRRD0004\ntype: short\nSegment0_Name:=Fat\nSegment0_LabelValue:=1\n\n");
  put(folder, "b.csv", "1,Bone\n");
  EXPECT_EQ(label_table_of(slicer, {1}).names, (Names{{1, "Fat"}}));
  EXPECT_EQ(label_table_of(slicer, {1}).passed_over.size(), 1U) << "the file's own names count, too";
}

TEST(LabelTable, NumbersOfAnAcquisitionOrLabelsThatDoNotOccurNameNothing) {
  const ScratchFolder folder;
  const auto map = put(folder, "a.nii.gz", "");
  put(folder, "a.json", R"({"SeriesNumber": 2, "SliceThickness": 1, "AcquisitionNumber": 3})");
  const LabelTable sidecar = label_table_of(map, {1, 2, 3});
  EXPECT_TRUE(sidecar.names.empty());
  ASSERT_EQ(sidecar.passed_over.size(), 1U);
  EXPECT_NE(sidecar.passed_over[0].find("is a quantity of a scan's acquisition"), std::string::npos)
      << sidecar.passed_over[0];
  put(folder, "a.json", R"({"left": 2, "right": 1})");
  EXPECT_EQ(label_table_of(map, {1, 2, 3}).names, (Names{{1, "right"}, {2, "left"}}));
  EXPECT_TRUE(label_table_of(map, {7}).names.empty());
  put(folder, "a.json", R"({"Manual": true, "Resolution": "native"})");
  put(folder, "a.txt", "notes of the reader\n");
  const LabelTable none = label_table_of(map, {1});
  EXPECT_TRUE(none.names.empty());
  EXPECT_EQ(none.passed_over.size(), 2U);
  put(folder, "a.csv", "1,0.25\n2,0.5\n");
  EXPECT_TRUE(label_table_of(map, {1}).names.empty()) << "volumes are no names";
}

TEST(LabelTable, OfBidsIsTheTsvBesideItOrTheInheritedOne) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "sub-01/anat");
  const auto map = put(folder, "sub-01/anat/sub-01_space-T1w_dseg.nii.gz", "");
  put(folder, "sub-01/anat/sub-01_space-T1w_dseg.json", R"({"Manual": true})");
  put(folder, "dseg.tsv", "index\tname\n1\tinherited\n");
  put(folder, "sub-02_dseg.tsv", "index\tname\n1\tof another\n");
  EXPECT_EQ(label_table_of(map, {1}).names, (Names{{1, "inherited"}}));
  put(folder, "sub-01/anat/sub-01_space-T1w_dseg.tsv",
      "\xef\xbb\xbfindex\tname\tmapping\r\n1\tLeft, upper\t11\r\n2\t\"Right\"\t12\r\n");
  const LabelTable own = label_table_of(map, {1});
  EXPECT_EQ(own.names, (Names{{1, "Left, upper"}, {2, "Right"}}));
  EXPECT_TRUE(own.passed_over.empty());
}

TEST(LabelTable, FurtherProgramsFormsAreRead) {
  const ScratchFolder folder;
  EXPECT_EQ(read_label_table(put(folder, "dcmqi.json", R"({"segmentAttributes": [[
      {"labelID": 1, "SegmentLabel": "Liver"}], [{"labelID": 4, "SegmentLabel": "Spleen"}]]})"))
                .names,
            (Names{{1, "Liver"}, {4, "Spleen"}}));
  EXPECT_EQ(read_label_table(
                put(folder, "nnunet.json", R"({"labels": {"background": 0, "whole": [1, 2], "core": 2}})"))
                .names,
            (Names{{2, "core"}}));
  EXPECT_EQ(read_label_table(put(folder, "lut.txt",
                                 "#No. Label Name:  R G B A\n0 Unknown 0 0 0 0\n"
                                 "17  Left-Hippocampus  220 216 20 0\n14175 wm_rh 1 2 3 0\n"))
                .names,
            (Names{{17, "Left-Hippocampus"}, {14175, "wm_rh"}}));
  EXPECT_EQ(read_label_table(put(folder, "large.csv", "70000,node\n")).names, (Names{{70000, "node"}}));
}

class LabelNames : public tests::CommandLine {};

TEST_F(LabelNames, TwoSegmentsOfOneNameAreRefusedByVerbAndPlan) {
  write("two.seg.nrrd",
        "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 1 1\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: ascii\n"
        "Segment0_Name:=Bone\nSegment0_LabelValue:=1\nSegment1_Name:=Bone\nSegment1_LabelValue:=2\n\n"
        "0 1 2\n");
  expect_refused(run("segment " + at("two.seg.nrrd") + " --named Bone -o " + at("x.octree")),
                 "with the numbers 1, 2");
  EXPECT_EQ(run("segment " + at("two.seg.nrrd") + " --label 2 -o " + at("x.octree")).status, 0);
  write("two.plan.json",
        R"({ "octotomy_plan": 1, "name": "n", "scans": { "seg": { "path": "two.seg.nrrd" } },
      "steps": [ { "id": "bone", "do": "segment", "scan": "seg", "named": "Bone" } ] })");
  expect_refused(run("run " + at("two.plan.json") + " -o " + at("report")), "with the numbers 1, 2");
}

TEST_F(LabelNames, ANamedLabelIsTheOctreeOfItsNumberUnshiftedAndAnUnknownNameIsRefused) {
  ASSERT_EQ(
      run("segment " + at("ball.nrrd") + " --window 0: --window=-2000:-1 -o " + at("map.nii.gz")).status, 0);
  write("map.json", R"({"ball": 1, "air": 2})");
  ASSERT_EQ(run("segment " + at("map.nii.gz") + " --named ball -o " + at("named.octree")).status, 0);
  ASSERT_EQ(run("segment " + at("map.nii.gz") + " --label 1 -o " + at("number.octree")).status, 0);
  const auto measured = [&](const std::string& file) {
    return SortedJson::parse(run("measure " + at(file) + " --json").out);
  };
  EXPECT_EQ(measured("named.octree")["volume_mm3"], measured("number.octree")["volume_mm3"]);
  EXPECT_EQ(measured("named.octree")["centroid_mm"], measured("number.octree")["centroid_mm"]);
  expect_refused(run("segment " + at("map.nii.gz") + " --named bal -o " + at("x.octree")),
                 "did you mean 'ball'");
  write("other.csv", "2,ball\n");
  ASSERT_EQ(run("segment " + at("map.nii.gz") + " --named ball --names " + at("other.csv") + " -o " +
                at("other.octree"))
                .status,
            0);
  EXPECT_NE(measured("other.octree")["volume_mm3"], measured("number.octree")["volume_mm3"]);
  write("named.plan.json",
        R"({ "octotomy_plan": 1, "name": "n", "scans": { "seg": { "path": "map.nii.gz" } },
      "steps": [ { "id": "ball", "do": "segment", "scan": "seg", "named": "ball" },
                 { "id": "size", "do": "measure", "object": "ball" } ] })");
  const CommandAnswer plan = run("run " + at("named.plan.json") + " -o " + at("report") + " --json");
  EXPECT_EQ(plan.status, 0) << plan.errors;
}

}  // namespace
}  // namespace octotomy::planner
