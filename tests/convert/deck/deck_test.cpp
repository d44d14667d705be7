// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/deck.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/convert/cube_in_five.h"
#include "tests/convert/surfaces.h"
#include "tests/file_bytes.h"
#include "tests/unit_universe.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

using tests::bytes_of;
using tests::ScratchFolder;

std::ptrdiff_t file_count(const ScratchFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.path()),
                       std::filesystem::directory_iterator());
}

/// A cube far from the origin, with coordinates that need all their digits.
Tetrahedra far_cube() {
  return tests::cube_in_five({-123.456789012345, 98.7654321098765, 0.000123456789012345});
}

DeckOptions titled(const std::string& title) {
  DeckOptions options;
  options.title = title;
  return options;
}

struct InpDeck {
  Tetrahedra tetrahedra;
  std::vector<std::string> keywords;
  std::size_t longest_field = 0;
  std::size_t longest_set_line = 0;
  std::string section;
};

/// Reads an .inp file by Abaqus's rules: keyword lines, comma-separated fields, numbers from 1.
InpDeck read_inp(const std::filesystem::path& path) {
  InpDeck deck;
  std::ifstream in(path);
  std::string line;
  std::string keyword;
  while (std::getline(in, line)) {
    if (line.starts_with("**")) continue;
    if (line.starts_with("*")) {
      keyword = line.substr(0, line.find(','));
      deck.keywords.push_back(keyword);
      if (keyword == "*SOLID SECTION") deck.section = line;
      continue;
    }
    if (keyword == "*HEADING") continue;
    std::vector<std::string> fields;
    std::stringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) {
      field.erase(0, field.find_first_not_of(' '));
      deck.longest_field = std::max(deck.longest_field, field.size());
      fields.push_back(field);
    }
    if (keyword == "*NODE") {
      EXPECT_EQ(std::stoul(fields.at(0)), deck.tetrahedra.nodes_mm.size() + 1);
      deck.tetrahedra.nodes_mm.emplace_back(std::stod(fields.at(1)), std::stod(fields.at(2)),
                                            std::stod(fields.at(3)));
    } else if (keyword == "*ELEMENT") {
      std::array<std::uint32_t, 4> tet{};
      for (std::size_t i = 0; i < 4; ++i)
        tet.at(i) = static_cast<std::uint32_t>(std::stoul(fields.at(i + 1)) - 1);
      deck.tetrahedra.tets.push_back(tet);
    } else if (keyword == "*NSET") {
      deck.longest_set_line = std::max(deck.longest_set_line, fields.size());
      for (const std::string& field : fields)
        deck.tetrahedra.boundary_nodes.push_back(static_cast<std::uint32_t>(std::stoul(field) - 1));
    }
  }
  return deck;
}

TEST(Deck, AnAbaqusDeckReadsBackToTheSameElementsAndVolume) {
  const ScratchFolder folder;
  const Tetrahedra cube = far_cube();
  write_deck(cube, folder / "cube.inp", titled("A cube"));
  const InpDeck deck = read_inp(folder / "cube.inp");
  EXPECT_EQ(deck.tetrahedra.tets, cube.tets);
  EXPECT_EQ(deck.tetrahedra.boundary_nodes, cube.boundary_nodes);
  EXPECT_EQ(deck.keywords, (std::vector<std::string>{"*HEADING", "*NODE", "*ELEMENT", "*NSET", "*MATERIAL",
                                                     "*ELASTIC", "*SOLID SECTION"}));
  EXPECT_EQ(deck.section, "*SOLID SECTION, ELSET=SOLID, MATERIAL=BONE");
  ASSERT_EQ(deck.tetrahedra.nodes_mm.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i)  // twelve digits of three before the point leave nine behind it
    EXPECT_LT(glm::length(deck.tetrahedra.nodes_mm[i] - cube.nodes_mm[i]), 1e-9);
  EXPECT_NEAR(quality(deck.tetrahedra).volume_mm3, 1.0, 1e-8);
  EXPECT_GT(quality(deck.tetrahedra).min_volume_mm3, 0.0);
}

TEST(Deck, NoFieldOfAnAbaqusDeckIsLongerThanCalculixReadsAndNoSetLineLongerThanAbaqusDoes) {
  const ScratchFolder folder;
  Tetrahedra cube = far_cube();
  cube.nodes_mm[0].x = -1.23456789012345e-300;
  for (std::uint32_t i = 0; i < 100; ++i) {
    cube.nodes_mm.emplace_back(0.1 * i, 0, 0);
    cube.boundary_nodes.push_back(8 + i);
  }
  write_deck(cube, folder / "cube.inp");
  const InpDeck deck = read_inp(folder / "cube.inp");
  EXPECT_LE(deck.longest_field, 20U);
  EXPECT_GE(deck.longest_field, 19U);
  EXPECT_EQ(deck.longest_set_line, 16U);
  EXPECT_EQ(deck.tetrahedra.boundary_nodes, cube.boundary_nodes);
}

TEST(Deck, ATitleCannotBecomeAKeywordOrASecondLine) {
  const ScratchFolder folder;
  write_deck(far_cube(), folder / "cube.inp", titled("*NODE\n*STEP"));
  const InpDeck deck = read_inp(folder / "cube.inp");
  EXPECT_EQ(deck.keywords.size(), 7U);
  EXPECT_EQ(deck.tetrahedra.nodes_mm.size(), 8U);
}

TEST(Deck, AnAbaqusDeckIsAsciiHoweverItsNotesArePrinted) {
  const ScratchFolder folder;
  DeckOptions options = titled("Sch\u00e4del");
  options.notes = {"volume 36\u202f938 mm\u00b3 \u00b1 5\u00b0, \u2212 \xff\u00b3 \U0001F480"};
  write_deck(far_cube(), folder / "d.inp", options);
  const std::string deck = bytes_of(folder / "d.inp");
  EXPECT_NE(deck.find("\n Sch?del\n"), std::string::npos) << deck.substr(0, 200);
  EXPECT_NE(deck.find("** volume 36 938 mm3 +- 5 degrees, - ?3 ?\n"), std::string::npos)
      << deck.substr(0, 300);
  for (const char c : deck) ASSERT_LT(static_cast<unsigned char>(c), 0x80);
}

TEST(Deck, ATitleCannotEndACommentAndKeepsItsHyphens) {
  const ScratchFolder folder;
  for (const char* name : {"cube.vtu", "cube.feb"}) {
    write_deck(far_cube(), folder / name, titled("SHA-256 a---b-->c"));
    const std::string text = bytes_of(folder / name);
    EXPECT_NE(text.find("SHA-256 a-&#45;-b-&#45;&gt;c"), std::string::npos) << name;
    for (auto at = text.find("--"); at != std::string::npos; at = text.find("--", at + 2))
      EXPECT_TRUE(text.compare(at - 2, 4, "<!--") == 0 || text.compare(at, 3, "-->") == 0) << name;
  }
}

/// The appended block to which a DataArray's offset refers.
template <typename T>
std::vector<T> appended(const std::string& file, const std::string& name) {
  const std::size_t tag = file.find("Name=\"" + name + "\"");
  const std::size_t offset_at = file.find("offset=\"", tag) + 8;
  const std::size_t offset = std::stoul(file.substr(offset_at));
  const std::size_t data = file.find('_', file.find("<AppendedData")) + 1;
  std::uint64_t size = 0;
  std::memcpy(&size, file.data() + data + offset, sizeof size);
  std::vector<T> values(size / sizeof(T));
  std::memcpy(values.data(), file.data() + data + offset + sizeof size, size);
  return values;
}

TEST(Deck, AVtkGridHoldsEveryBitOfTheNodes) {
  const ScratchFolder folder;
  const Tetrahedra cube = far_cube();
  write_deck(cube, folder / "cube.vtu", titled("a -- b <c>"));
  const std::string file = bytes_of(folder / "cube.vtu");
  EXPECT_NE(file.find("NumberOfPoints=\"8\" NumberOfCells=\"5\""), std::string::npos);
  EXPECT_EQ(file.find("a -- b"), std::string::npos) << "two hyphens end an XML comment";
  std::vector<double> coordinates;
  for (const glm::dvec3& p : cube.nodes_mm) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  EXPECT_EQ(appended<double>(file, "Points"), coordinates);
  EXPECT_EQ(appended<std::int64_t>(file, "connectivity"),
            (std::vector<std::int64_t>{0, 1, 2, 4, 3, 2, 1, 7, 5, 1, 4, 7, 6, 2, 7, 4, 1, 2, 4, 7}));
  EXPECT_EQ(appended<std::int64_t>(file, "offsets"), (std::vector<std::int64_t>{4, 8, 12, 16, 20}));
  EXPECT_EQ(appended<std::uint8_t>(file, "types"), std::vector<std::uint8_t>(5, 10));
  EXPECT_EQ(appended<std::uint8_t>(file, "surface"), std::vector<std::uint8_t>(8, 1));
}

TEST(Deck, AVtkGridMarksTheFacesOfASurfaceByTheCornersAcross) {
  const ScratchFolder folder;
  DeckOptions options;
  options.surfaces = {{"CUT", {{0, 3}, {0, 1}, {4, 0}}}, {"REST", {{2, 2}}}};
  write_deck(far_cube(), folder / "cube.vtu", options);
  const std::string file = bytes_of(folder / "cube.vtu");
  EXPECT_EQ(appended<std::uint8_t>(file, "CUT"), (std::vector<std::uint8_t>{0b1010, 0, 0, 0, 0b0001}));
  EXPECT_EQ(appended<std::uint8_t>(file, "REST"), (std::vector<std::uint8_t>{0, 0, 0b0100, 0, 0}));
}

TEST(Deck, WhatASolverWouldRefuseIsRefusedBeforeAnythingIsWritten) {
  const ScratchFolder folder;
  const Tetrahedra cube = far_cube();
  Tetrahedra spoiled = cube;
  spoiled.tets[3][2] = 8;
  EXPECT_THROW(write_deck(spoiled, folder / "a.inp"), std::invalid_argument);
  spoiled = cube;
  spoiled.nodes_mm[1].y = std::nan("");
  EXPECT_THROW(write_deck(spoiled, folder / "a.vtu"), std::invalid_argument);
  DeckOptions two_words;
  two_words.element_set = "two words";
  DeckOptions incompressible;
  incompressible.materials[0].poisson_ratio = 0.5;
  EXPECT_THROW(write_deck({}, folder / "a.inp"), std::invalid_argument);
  EXPECT_THROW(write_deck(cube, folder / "a.stl"), std::invalid_argument);
  EXPECT_THROW(write_deck(cube, folder / "a.inp", two_words), std::invalid_argument);
  EXPECT_THROW(write_deck(cube, folder / "a.inp", incompressible), std::invalid_argument);
  EXPECT_EQ(file_count(folder), 0);
}

TEST(Deck, AFileThatCannotBeWrittenIsNamedAndNothingIsLeft) {
  const ScratchFolder folder;
  try {
    write_deck(far_cube(), folder / "absent" / "a.inp");
    FAIL() << "a folder that does not exist was written to";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("absent"), std::string::npos) << error.what();
  }
  // A folder occupies the file's path: the write succeeds, but the renaming cannot.
  std::filesystem::create_directories(folder / "b.inp" / "full");
  EXPECT_THROW(write_deck(far_cube(), folder / "b.inp"), std::runtime_error);
  EXPECT_EQ(file_count(folder), 1) << "the unfinished file is gone";
}

TEST(Deck, WritingTellsHowFarItIsAndAStopLeavesNoFile) {
  const ScratchFolder folder;
  const voxel::Universe universe = tests::unit_universe(5);
  const Tetrahedra ball =
      tetrahedra_of(voxel::combine(universe, voxel::Expression(voxel::Sphere{glm::dvec3(15.5), 15.0})),
                    BoundaryCells::Voxels);
  for (const char* name : {"ball.inp", "ball.feb", "ball.vtu", "ball.msh", "ball.node"}) {
    DeckOptions options;
    std::vector<double> fractions;
    options.progress.report = [&](double fraction) { fractions.push_back(fraction); };
    write_deck(ball, folder / name, options);
    ASSERT_GE(fractions.size(), 3U) << name;
    EXPECT_GT(fractions.back(), name == std::string("ball.node") ? 0.3 : 0.6) << name;
    EXPECT_LE(fractions.back(), 1.0) << name;

    for (const char* file : {name, "ball.ele", "ball.face"}) std::filesystem::remove(folder / file);
    const std::ptrdiff_t files = file_count(folder);
    std::stop_source source;
    options.progress.stop = source.get_token();
    options.progress.report = [&](double fraction) {
      if (fraction > 0.1) source.request_stop();
    };
    EXPECT_THROW(write_deck(ball, folder / name, options), voxel::Stopped) << name;
    EXPECT_EQ(file_count(folder), files) << name;
  }
}

TEST(Deck, ReplacesAnEarlierFileAsAWhole) {
  const ScratchFolder folder;
  write_deck(far_cube(), folder / "a.INP", titled("first"));
  write_deck(far_cube(), folder / "a.INP", titled("second"));
  EXPECT_EQ(bytes_of(folder / "a.INP").find("first"), std::string::npos);
  EXPECT_EQ(file_count(folder), 1);
}

TEST(Deck, OfSeveralFilesReplacesTheOnesThatAreNotNamedOnlyIfItWroteThem) {
  const ScratchFolder folder;
  write_deck(far_cube(), folder / "a.node", titled("first"));
  write_deck(far_cube(), folder / "a.ele", titled("second"));
  for (const char* name : {"a.node", "a.ele", "a.face"})
    EXPECT_NE(bytes_of(folder / name).find("second"), std::string::npos) << name;
  for (const char* of_user : {"mine\n", "# mine\n", "mine; mm, LPS", ""}) {
    tests::write_bytes(folder / "a.face", of_user);
    EXPECT_THROW(write_deck(far_cube(), folder / "a.node", titled("third")), voxel::Error);
    EXPECT_EQ(bytes_of(folder / "a.face"), of_user);
    EXPECT_EQ(bytes_of(folder / "a.node").find("third"), std::string::npos);
  }
  write_deck(far_cube(), folder / "a.face", titled("third"));
  EXPECT_NE(bytes_of(folder / "a.face").find("third"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::convert
