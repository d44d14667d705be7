// SPDX-License-Identifier: AGPL-3.0-or-later
// The house's order, as rooms.txt declares it: folders and rooms depend one way, files form no cycles, no
// room is overfull, and tests stand where their subjects do. Every rule is a function from the sources to its
// offences, so that each has a twin with spoiled sources.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string>;
using Offences = std::vector<std::string>;
/// Paths within the repository, and what each includes.
using Sources = std::map<std::string, std::vector<std::string>>;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The content of rooms.txt: for each folder or room, the places beside it on which it stands. "voxel/tree":
/// "voxel/space"
using Arrows = std::map<std::string, Names>;

Arrows arrows_of(const std::string& text) {
  Arrows arrows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    const std::string from = line.substr(0, colon);
    const std::string beside = from.substr(0, from.rfind('/') + 1);
    Names& to = arrows[from];
    for (const std::string& name : words_of(line.substr(colon + 1))) to.insert(beside + name);
  }
  return arrows;
}

const Arrows& arrows() {
  static const Arrows read = arrows_of(text_of(fs::path(OCTOTOMY_SOURCE_DIR) / "tests/house/rooms.txt"));
  return read;
}

bool has_rooms(const std::string& place) {
  const auto first = arrows().lower_bound(place + "/");
  return first != arrows().end() && first->first.starts_with(place + "/");
}

/// Whether sources may stand in a place: it is declared, and no other place is below it.
bool is_room(const std::string& place) {
  return arrows().contains(place) && !has_rooms(place);
}

/// The folders of the top level that rooms.txt names.
Names top_folders() {
  Names found;
  for (const auto& [place, beside] : arrows())
    if (place.find('/') == std::string::npos) found.insert(place);
  return found;
}

std::string folder_of(const std::string& path) {
  return path.substr(0, path.find('/'));
}

std::string room_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

std::string stem_of(const std::string& path) {
  const std::size_t first = path.rfind('/') + 1;
  return path.substr(first, path.rfind('.') - first);
}

/// The project's files that a source text includes.
std::vector<std::string> project_includes(const std::string& text) {
  static const std::regex include(R"re((?:^|\n)\s*#\s*include\s*"(\w+/[^"]*)")re");
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

/// The sources of the folders that rooms.txt names.
const Sources& house() {
  static const Sources sources = [] {
    Sources found;
    for (const std::string& folder : top_folders())
      for (const fs::directory_entry& entry :
           fs::recursive_directory_iterator(fs::path(OCTOTOMY_SOURCE_DIR) / folder)) {
        if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
        found[fs::relative(entry.path(), OCTOTOMY_SOURCE_DIR).generic_string()] =
            project_includes(text_of(entry.path()));
      }
    return found;
  }();
  return sources;
}

/// Whether one may reach another; either is the path of a source, or of a place with a slash at the end. At
/// the folder where the two paths part, the one place must stand on the other; everything below that one may
/// then be reached. A folder and the places below it do not reach one another.
bool may_reach(const std::string& from, const std::string& to) {
  const std::string from_room = from.substr(0, from.rfind('/') + 1);
  const std::string to_room = to.substr(0, to.rfind('/') + 1);
  if (from_room == to_room) return true;
  std::size_t parting = 0;
  for (std::size_t i = 0; i < std::min(from_room.size(), to_room.size()) && from_room[i] == to_room[i]; ++i)
    if (from_room[i] == '/') parting = i + 1;
  const auto found = arrows().find(from_room.substr(0, from_room.find('/', parting)));
  return found != arrows().end() && found->second.contains(to_room.substr(0, to_room.find('/', parting)));
}

Offences forbidden_arrows(const Sources& sources) {
  Offences offences;
  for (const auto& [from, includes] : sources)
    for (const std::string& to : includes)
      if (!may_reach(from, to)) offences.push_back(from + " -> " + to);
  return offences;
}

/// The first cycle that a walk from each file finds, its files in order.
Offences cycles(const Sources& sources) {
  enum class Seen { Not, Open, Done };
  std::map<std::string, Seen> seen;
  std::vector<std::string> open;
  Offences offences;
  const std::function<void(const std::string&)> walk = [&](const std::string& path) {
    const auto found = sources.find(path);
    if (found == sources.end() || seen[path] == Seen::Done) return;
    if (seen[path] == Seen::Open) {
      std::string cycle;
      for (auto at = std::find(open.begin(), open.end(), path); at != open.end(); ++at) cycle += *at + " -> ";
      offences.push_back(cycle + path);
      return;
    }
    seen[path] = Seen::Open;
    open.push_back(path);
    for (const std::string& next : found->second) walk(next);
    open.pop_back();
    seen[path] = Seen::Done;
  };
  for (const auto& [path, includes] : sources) walk(path);
  return offences;
}

/// Stems that a room may hold.
constexpr std::size_t most_stems = 40;

Offences overfull_rooms(const Sources& sources) {
  std::map<std::string, Names> stems;
  for (const auto& [path, includes] : sources) stems[room_of(path)].insert(stem_of(path));
  Offences offences;
  for (const auto& [room, names] : stems)
    if (names.size() > most_stems) offences.push_back(room + ": " + std::to_string(names.size()));
  return offences;
}

std::string page_of(const std::string& room) {
  return text_of(fs::path(OCTOTOMY_SOURCE_DIR) / room / "README.md");
}

/// Headers that other rooms include though their room's page does not offer them: it names those that may be
/// called before it comes to what is private.
Offences unnamed_headers(const Sources& sources, const std::function<std::string(const std::string&)>& page) {
  Offences offences;
  for (const auto& [from, includes] : sources)
    for (const std::string& to : includes) {
      if (room_of(to) == room_of(from)) continue;
      const std::string text = page(room_of(to));
      const std::string offered = text.substr(0, text.find("## Private"));
      if (offered.find("`" + stem_of(to) + ".h`") == std::string::npos)
        offences.push_back(to + ", of " + from);
    }
  return offences;
}

/// The first #include of a text, with its brackets or quotes.
std::string first_include(const std::string& text) {
  static const std::regex include(R"re((?:^|\n)\s*#\s*include\s*([<"][^>"]*[>"]))re");
  std::smatch match;
  return std::regex_search(text, match, include) ? match[1].str() : "";
}

/// Sources that include something before the header of their own stem; by path, the first of their includes.
Offences headers_not_first(const std::map<std::string, std::string>& first_includes) {
  Offences offences;
  for (const auto& [path, first] : first_includes) {
    const std::string header = room_of(path) + "/" + stem_of(path) + ".h";
    if (path.ends_with(".cpp") && first_includes.contains(header) && first != "\"" + header + "\"")
      offences.push_back(path + ": " + first);
  }
  return offences;
}

/// Sources beside the rooms of their folder, or in a place that rooms.txt does not name.
Offences homeless(const Sources& sources) {
  Offences offences;
  for (const auto& [path, includes] : sources)
    if (!is_room(room_of(path))) offences.push_back(path);
  return offences;
}

/// Tests, named by their paths under tests/, that stand in no room, or in another one than the source of
/// their stem.
Offences misplaced_tests(const Names& tests, const Sources& sources) {
  std::map<std::string, Names> rooms_of_stem;  // "voxel/octree": "voxel/tree"
  for (const auto& [path, includes] : sources)
    rooms_of_stem[folder_of(path) + "/" + stem_of(path)].insert(room_of(path));
  Offences offences;
  for (const std::string& test : tests) {
    const std::string stem = stem_of(test).substr(0, stem_of(test).rfind("_test"));
    const auto found = rooms_of_stem.find(folder_of(test) + "/" + stem);
    if (!is_room(room_of(test)) || (found != rooms_of_stem.end() && !found->second.contains(room_of(test))))
      offences.push_back(test);
  }
  return offences;
}

Names tests_of_rooms() {
  Names tests;
  const fs::path root = fs::path(OCTOTOMY_SOURCE_DIR) / "tests";
  for (const std::string& folder : top_folders())
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.path().filename().string().ends_with("_test.cpp"))
        tests.insert(fs::relative(entry.path(), root).generic_string());
  return tests;
}

/// Places, each with a slash at the end, whose targets a list of sources names: octotomy_voxel_tree is that
/// of voxel/tree. A target without a place is itself in the list.
Names targets_in(const std::string& cmake) {
  std::map<std::string, std::string> places;
  for (const auto& [place, beside] : arrows())
    places["octotomy_" + std::regex_replace(place, std::regex("/"), "_")] = place + "/";
  static const std::regex target(R"(octotomy_(?:voxel|brep|convert|verify|planner)(?:_[a-z0-9]+)*)");
  const std::string text = std::regex_replace(cmake, std::regex("#[^\n]*"), "");
  Names found;
  for (std::sregex_iterator match(text.begin(), text.end(), target), end; match != end; ++match) {
    const auto place = places.find(match->str());
    found.insert(place == places.end() ? match->str() : place->second);
  }
  return found;
}

TEST(Rooms, TheDeclaredArrowsFormNoCycle) {
  EXPECT_GT(arrows().size(), 30u) << "rooms.txt was not read";
  Sources graph;
  for (const auto& [from, beside] : arrows()) {
    EXPECT_TRUE(from.find('/') == std::string::npos || arrows().contains(room_of(from)))
        << from << ": its folder is not declared";
    for (const std::string& to : beside) {
      EXPECT_TRUE(arrows().contains(to)) << from << ": there is no " << to;
      graph[from].push_back(to);
    }
  }
  EXPECT_EQ(cycles(graph), Offences{});
}

TEST(Rooms, NoSourceReachesAgainstTheArrows) {
  std::size_t includes = 0;
  for (const auto& [path, to] : house()) includes += to.size();
  EXPECT_GT(house().size(), 400u) << "the test looks in the wrong place";
  EXPECT_GT(includes, 1000u);
  EXPECT_EQ(forbidden_arrows(house()), Offences{});
}

TEST(Rooms, AForbiddenArrowIsSeen) {
  const auto arrow = [](const std::string& from, const std::string& text) {
    return forbidden_arrows({{from, project_includes(text)}});
  };
  EXPECT_EQ(arrow("voxel/tree/octree.h", "#pragma once\n#include \"brep/mesh/mesh.h\"\n").size(), 1u);
  EXPECT_EQ(arrow("brep/mesh/mesh.h", "#include <vector>\n  # include \"voxel/space/scene.h\"").size(), 1u);
  EXPECT_EQ(arrow("convert/tet/tetrahedra.h", "#include \"planner/plan/plan.h\"").size(), 1u);
  EXPECT_EQ(arrow("voxel/tree/octree.h", "#include \"voxel/solid/combine.h\"").size(), 1u);
  EXPECT_EQ(arrow("voxel/filter/smooth.cpp", "#include \"voxel/scan/read_scene.h\"").size(), 1u);
  EXPECT_EQ(arrow("voxel/cellar/wine.h", "#include \"voxel/tree/octree.h\"").size(), 1u);
  EXPECT_EQ(arrow("voxel/solid/combine.h", "#include \"voxel/tree/octree.h\"").size(), 0u);
  // Within a folder of a folder, and from one such folder to another.
  EXPECT_EQ(arrow("planner/operation/file/a.h", "#include \"planner/operation/object/provenance.h\"").size(),
            1u);
  EXPECT_EQ(arrow("planner/operation/file/a.h", "#include \"planner/result/report/report.h\"").size(), 1u);
  EXPECT_EQ(arrow("planner/result/report/a.h", "#include \"planner/operation/object/provenance.h\"").size(),
            0u);
  EXPECT_EQ(arrow("planner/operation/loose.h", "#include \"planner/operation/object/provenance.h\"").size(),
            1u);
  EXPECT_EQ(
      arrow("convert/voxel/voxelise.h", "#include \"brep/mesh/mesh.h\"\n#include \"voxel/tree/octree.h\"")
          .size(),
      0u);
}

// So its source proves that the header compiles alone, wherever no precompiled header stands before it; those
// without a source are compiled by the target `headers`.
TEST(Rooms, AHeaderIsTheFirstThatItsSourceIncludes) {
  std::map<std::string, std::string> first;
  for (const auto& [path, includes] : house())
    first[path] = first_include(text_of(fs::path(OCTOTOMY_SOURCE_DIR) / path));
  EXPECT_EQ(headers_not_first(first), Offences{});
  EXPECT_EQ(first_include("// a\n#include <map>\n#include \"a/b.h\"\n"), "<map>");
  EXPECT_EQ(headers_not_first({{"a/b.h", ""}, {"a/b.cpp", "<map>"}, {"a/c.cpp", "<map>"}}),
            Offences{"a/b.cpp: <map>"});
  EXPECT_EQ(headers_not_first({{"a/b.h", ""}, {"a/b.cpp", "\"a/b.h\""}}), Offences{});
}

TEST(Rooms, FilesFormNoCycle) {
  EXPECT_EQ(cycles(house()), Offences{});
}

TEST(Rooms, ACycleIsSeen) {
  EXPECT_EQ(cycles({{"a/a.h", {"a/b.h"}}, {"a/b.h", {"a/c.h"}}, {"a/c.h", {"a/b.h"}}}),
            Offences{"a/b.h -> a/c.h -> a/b.h"});
}

TEST(Rooms, NoneIsOverfull) {
  EXPECT_EQ(overfull_rooms(house()), Offences{});
}

TEST(Rooms, AnOverfullOneIsSeen) {
  Sources sources;
  for (int i = 0; i < 41; ++i) {
    sources["voxel/tree/stem" + std::to_string(i) + ".h"];
    sources["voxel/tree/stem" + std::to_string(i) + ".cpp"];
  }
  EXPECT_EQ(overfull_rooms(sources), Offences{"voxel/tree: 41"});
  sources.erase("voxel/tree/stem40.h");
  sources.erase("voxel/tree/stem40.cpp");
  EXPECT_EQ(overfull_rooms(sources), Offences{});
}

TEST(Rooms, EverySourceHasOneAndEveryPlaceAPage) {
  EXPECT_EQ(homeless(house()), Offences{});
  EXPECT_EQ(
      homeless({{"voxel/loose.h", {}}, {"brep/cellar/wine.h", {}}, {"verify/phantom/implicit_solid.h", {}}}),
      (Offences{"brep/cellar/wine.h", "voxel/loose.h"}));
  for (const auto& [place, beside] : arrows()) {
    EXPECT_NE(page_of(place), "") << place;
  }
}

TEST(Rooms, APageNamesEveryHeaderThatOthersInclude) {
  EXPECT_EQ(unnamed_headers(house(), page_of), Offences{});
}

TEST(Rooms, AHeaderMissingFromItsPageIsSeen) {
  const auto page = [](const std::string&) {
    return std::string("- `octree.h`: the tree.\n## Private\n`leaf.h`\n");
  };
  EXPECT_EQ(
      unnamed_headers({{"voxel/solid/combine.cpp", {"voxel/tree/octree.h", "voxel/solid/combine.h"}}}, page),
      Offences{});
  EXPECT_EQ(unnamed_headers({{"voxel/solid/combine.cpp", {"voxel/tree/leaf.h"}}}, page),
            Offences{"voxel/tree/leaf.h, of voxel/solid/combine.cpp"});
}

TEST(Rooms, TestsMirrorThem) {
  EXPECT_GT(tests_of_rooms().size(), 150u) << "the test looks in the wrong place";
  EXPECT_EQ(misplaced_tests(tests_of_rooms(), house()), Offences{});
}

TEST(Rooms, AMisplacedTestIsSeen) {
  const Sources sources{{"voxel/tree/octree.h", {}}, {"verify/phantom/implicit_solid.h", {}}};
  EXPECT_EQ(
      misplaced_tests({"voxel/solid/octree_test.cpp", "voxel/octree_test.cpp", "voxel/tree/octree_test.cpp",
                       "voxel/solid/set_identities_test.cpp", "verify/phantom/implicit_solid_test.cpp"},
                      sources),
      (Offences{"voxel/octree_test.cpp", "voxel/solid/octree_test.cpp"}));
}

// Libraries, too: what a target links decides what its sources could reach.
TEST(Rooms, NoTargetLinksAgainstTheArrows) {
  int links = 0;
  for (const auto& [place, beside] : arrows()) {
    const std::string text = text_of(fs::path(OCTOTOMY_SOURCE_DIR) / place / "CMakeLists.txt");
    ASSERT_FALSE(text.empty()) << place;
    for (const std::string& target : targets_in(text)) {
      ++links;
      const bool is_own = target.starts_with(place + "/");
      const bool is_program = place == "planner/cli/program" && target == "planner/";
      EXPECT_TRUE(is_own || is_program || may_reach(place + "/", target))
          << place << "/CMakeLists.txt names " << target;
    }
  }
  EXPECT_GT(links, 40);
}

TEST(Rooms, ATargetIsSeen) {
  EXPECT_EQ(
      targets_in("target_link_libraries(a octotomy_brep PRIVATE octotomy_voxel_tree) # octotomy_verify"),
      (Names{"brep/", "voxel/tree/"}));
  EXPECT_FALSE(may_reach("voxel/tree/", "voxel/solid/"));
  EXPECT_FALSE(may_reach("voxel/tree/", "brep/"));
  EXPECT_FALSE(may_reach("voxel/tree/", "voxel/"));
  EXPECT_TRUE(may_reach("convert/tet/", "voxel/"));
  EXPECT_EQ(targets_in("octotomy_voxel_cellar"), Names{"octotomy_voxel_cellar"});
}

TEST(TopLevel, HoldsWhatTheHouseNamesAndNothingElse) {
  const Names top{"CMakeLists.txt", "README.md", "LICENSE", "voxel", "brep",
                  "convert",        "verify",    "planner", "tests"};
  for (const fs::directory_entry& entry : fs::directory_iterator(OCTOTOMY_SOURCE_DIR)) {
    const std::string name = entry.path().filename();
    if (name.starts_with(".") || name == "build") continue;
    EXPECT_TRUE(top.contains(name)) << name;
  }
  for (const std::string& name : top) EXPECT_TRUE(fs::exists(fs::path(OCTOTOMY_SOURCE_DIR) / name)) << name;
}

}  // namespace
