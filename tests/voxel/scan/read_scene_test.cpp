// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_scene.h"

#include <algorithm>
#include <fstream>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gtest/gtest.h>
#include <stdexcept>
#include <tbb/global_control.h>

#include "tests/file_bytes.h"
#include "tests/reference_data.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scan/dicom_frames.h"
#include "tests/voxel/scan/spoiled_series.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/dicom/dicom_file.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::bytes_of;
using tests::finding;
using tests::linear_field;
using tests::linear_scene;
using tests::oblique_lattice;
using tests::ScratchFolder;
using tests::verdict;
using tests::write_bytes;

/// Replaces a text in a file by another of the same length.
void exchange(const fs::path& path, const std::string& from, const std::string& to) {
  std::string bytes = bytes_of(path);
  const std::size_t at = bytes.find(from);
  ASSERT_EQ(from.size(), to.size());
  ASSERT_NE(at, std::string::npos) << path << " has no '" << from << "'";
  write_bytes(path, bytes.replace(at, from.size(), to));
}

std::string reason_of(const fs::path& path) {
  try {
    read_scene(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

fs::path slice(int number) {
  char name[32];
  std::snprintf(name, sizeof name, "slice_%04d.dcm", number);
  return name;
}

/// Greatest difference from the linear field at points at least a voxel inside the scanned lattice.
double worst_error(const Scene& scene, const Lattice& scanned) {
  double worst = 0.0;
  const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto x = static_cast<int>(i % static_cast<std::size_t>(scene.lattice.dims.x));
    const auto row = static_cast<int>(i / static_cast<std::size_t>(scene.lattice.dims.x));
    const glm::dvec3 p_mm = scene.lattice.lps_mm({x, row % scene.lattice.dims.y, row / scene.lattice.dims.y});
    const glm::dvec3 p_voxel = scanned.voxel(p_mm);
    if (glm::any(glm::lessThan(p_voxel, glm::dvec3(-1e-6))) ||
        glm::any(glm::greaterThan(p_voxel, glm::dvec3(scanned.dims - 1) + 1e-6)))
      continue;
    ++compared;
    worst = std::max(worst, std::abs(static_cast<double>(samples[i]) - linear_field(p_mm)));
  }
  EXPECT_GT(compared, scanned.sample_count() / 2)
      << "too few points were compared for the answer to mean anything";
  return worst;
}

/// An axial lattice whose slices drift towards the back by `drift` mm per mm of height.
Lattice leaning_lattice(double drift) {
  Lattice lattice = axis_aligned_lattice({40, 50, 20}, {1.0, 1.0, 2.0}, {-20.0, -25.0, 10.5});
  lattice.lps_from_voxel[2].y = 2.0 * drift;
  return lattice;
}

TEST(ReadDicom, OrdersSlicesByPositionWhateverTheFilesAreCalled) {
  const ScratchFolder folder;
  const Scene written = linear_scene(leaning_lattice(0.0));
  write_dicom_series(written, folder / "written");
  fs::create_directories(folder / "read" / fs::path("below"));
  for (int k = 1; k <= 20; ++k)  // 7 is prime to 20: a shuffle, half of it in a subfolder
    fs::copy(folder / "written" / slice(k),
             folder / "read" / (k % 2 == 0 ? "below" : "") / std::to_string(k * 7 % 20));
  const Scene read = read_scene(folder / "read");
  EXPECT_EQ(read.lattice, written.lattice);
  EXPECT_EQ(read.samples, written.samples);
  for (const Finding& line : read.audit)
    EXPECT_EQ(line.verdict, Verdict::Pass) << line.check << ": " << line.detail;
}

TEST(ReadDicom, ComesBackInTheSamePlaceFromAnyOrientation) {
  for (const bool left_handed : {false, true}) {
    const ScratchFolder folder;
    const Lattice lattice = oblique_lattice(left_handed);
    write_dicom_series(linear_scene(lattice), folder / "series");
    const Scene read = read_scene(folder / "series");
    EXPECT_TRUE(read.lattice.right_handed());
    EXPECT_NEAR(read.lattice.voxel_mm3(), lattice.voxel_mm3(), 1e-6);
    EXPECT_LE(worst_error(read, lattice), 0.5 + 1e-6) << (left_handed ? "left-handed" : "right-handed");
  }
}

TEST(ReadDicom, StraightensATiltedGantryAndSaysTheAngle) {
  const ScratchFolder folder;
  const double drift = std::tan(15.0 * std::acos(-1.0) / 180.0);
  for (const double sign : {1.0, -1.0}) {
    const Lattice lattice = leaning_lattice(sign * drift);
    const fs::path series = folder / (sign > 0.0 ? "back" : "front");
    write_dicom_series(linear_scene(lattice), series);
    const Scene read = read_scene(series);
    ASSERT_EQ(verdict(read, "gantry_tilt"), Verdict::Warn);
    EXPECT_NE(finding(read, "gantry_tilt")->detail.find("15.00 degrees"), std::string::npos)
        << finding(read, "gantry_tilt")->detail;
    EXPECT_EQ(read.lattice.lps_from_voxel[2], glm::dvec4(0, 0, 2, 0));
    EXPECT_GE(read.lattice.dims.y, 50 + static_cast<int>(38.0 * drift)) << "no slice may be cut off";
    // Rounding when written, and again when interpolated.
    EXPECT_LE(worst_error(read, lattice), 1.0 + 1e-6) << "tilt of sign " << sign;
  }
}

TEST(ReadDicom, RefusesALeanOfMorePixelsThanAnyScannerHas) {
  const ScratchFolder folder;
  Lattice lattice = leaning_lattice(0.5);
  for (const int axis : {0, 1}) lattice.lps_from_voxel[axis] *= 1e-4;
  write_dicom_series(linear_scene(lattice), folder / "series");
  try {
    read_scene(folder / "series");
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("displaced sideways"), std::string::npos) << error.what();
  }
}

TEST(ReadDicom, LeavesAShiftBelowATenthOfAPixelAlone) {
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.002)), folder / "straight");  // 0.076 pixels in all
  EXPECT_EQ(verdict(read_scene(folder / "straight"), "gantry_tilt"), Verdict::Pass);
  write_dicom_series(linear_scene(leaning_lattice(0.004)), folder / "leaning");
  EXPECT_EQ(verdict(read_scene(folder / "leaning"), "gantry_tilt"), Verdict::Warn);
}

TEST(ReadDicom, GivesTheSameBitsOnOneThread) {
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.2)), folder / "series");
  const Scene many = read_scene(folder / "series");
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(read_scene(folder / "series").samples, many.samples);
}

TEST(ReadDicom, FillsMissingSlicesAndCountsThem) {
  const ScratchFolder folder;
  const Scene written = linear_scene(leaning_lattice(0.0));
  write_dicom_series(written, folder / "series");
  fs::remove(folder / "series" / slice(5));
  fs::remove(folder / "series" / slice(12));
  fs::remove(folder / "series" / slice(13));
  const Scene read = read_scene(folder / "series");
  EXPECT_EQ(read.lattice, written.lattice);
  ASSERT_EQ(verdict(read, "missing_slices"), Verdict::Warn);
  EXPECT_TRUE(finding(read, "missing_slices")->detail.starts_with("3 of 20"))
      << finding(read, "missing_slices")->detail;
  EXPECT_LE(worst_error(read, written.lattice), 1.0 + 1e-6);
}

TEST(ReadDicom, MissesASliceThatIsCutShort) {
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.0)), folder / "series");
  fs::resize_file(folder / "series" / slice(5), fs::file_size(folder / "series" / slice(5)) - 1);
  const Scene read = read_scene(folder / "series");
  EXPECT_EQ(verdict(read, "missing_slices"), Verdict::Warn);
  ASSERT_EQ(verdict(read, "damaged_files"), Verdict::Fail);
  EXPECT_NE(finding(read, "damaged_files")->detail.find("cut short"), std::string::npos)
      << finding(read, "damaged_files")->detail;
  EXPECT_EQ(finding(read, "damaged_files")->files, std::vector<std::string>{slice(5)});
}

TEST(ReadDicom, ResamplesUnevenSlices) {
  const ScratchFolder folder;
  const Lattice lattice = leaning_lattice(0.0);
  write_dicom_series(linear_scene(lattice), folder / "series");
  exchange(folder / "series" / slice(8), "\\24.5", "\\24.9");  // 0.4 mm of 2
  const Scene read = read_scene(folder / "series");
  ASSERT_EQ(verdict(read, "slice_spacing"), Verdict::Warn);
  EXPECT_NE(finding(read, "slice_spacing")->detail.find("gaps from 1.6 to 2.4"), std::string::npos)
      << finding(read, "slice_spacing")->detail;
}

TEST(ReadDicom, TellsACopyFromAnotherImageAtTheSamePlace) {
  const ScratchFolder folder;
  const Scene written = linear_scene(leaning_lattice(0.0));
  write_dicom_series(written, folder / "series");
  fs::copy(folder / "series" / slice(3), folder / "series" / "copy.dcm");
  const Scene with_copy = read_scene(folder / "series");
  EXPECT_EQ(verdict(with_copy, "duplicates"), Verdict::Warn);
  EXPECT_EQ(with_copy.samples, written.samples);
  std::string rival = bytes_of(folder / "series" / "copy.dcm");
  const std::size_t uid = rival.find("2.25.", rival.find("1.2.840.10008.5.1.4.1.1.2", 200));
  ASSERT_NE(uid, std::string::npos);
  rival[uid + 7] = rival[uid + 7] == '1' ? '2' : '1';
  write_bytes(folder / "series" / "copy.dcm", rival);
  const Scene renamed = read_scene(folder / "series");
  EXPECT_EQ(verdict(renamed, "duplicates"), Verdict::Warn);
  EXPECT_NE(finding(renamed, "duplicates")->detail.find("under a new identifier"), std::string::npos);
  rival.back() = static_cast<char>(rival.back() ^ 1);
  write_bytes(folder / "series" / "copy.dcm", rival);
  EXPECT_EQ(verdict(read_scene(folder / "series"), "duplicates"), Verdict::Fail);
}

TEST(ReadDicom, WarnsOfImagesUnderOneIdentifier) {
  const ScratchFolder folder;
  const Scene written = linear_scene(leaning_lattice(0.0));
  write_dicom_series(written, folder / "series");
  EXPECT_EQ(finding(read_scene(folder / "series"), "instance_uids"), nullptr);
  const auto uid_of = [&](int i) {
    const std::string bytes = bytes_of(folder / "series" / slice(i));
    const std::size_t from = bytes.find("2.25.", bytes.find("1.2.840.10008.5.1.4.1.1.2", 200));
    return bytes.substr(from, bytes.find_first_not_of("0123456789.", from) - from);
  };
  int twin = 4;
  while (uid_of(twin).size() != uid_of(3).size()) ++twin;
  const std::string own = uid_of(twin);
  // In the file's meta information, then in the data set.
  for (int i = 0; i < 2; ++i) exchange(folder / "series" / slice(twin), own, uid_of(3));
  const Scene read = read_scene(folder / "series");
  ASSERT_EQ(verdict(read, "instance_uids"), Verdict::Warn);
  EXPECT_EQ(finding(read, "instance_uids")->files.size(), 1U);
  EXPECT_EQ(read.samples, written.samples);
}

TEST(ReadDicom, TakesTheLongestSeriesAndNamesTheOthers) {
  const ScratchFolder folder;
  const Scene longer = linear_scene(leaning_lattice(0.0));
  write_dicom_series(longer, folder / "a" / fs::path("longer"), {.series_description = "Longer"});
  const Scene shorter = linear_scene(axis_aligned_lattice({8, 8, 3}, glm::dvec3(1.0), glm::dvec3(0.0)));
  write_dicom_series(shorter, folder / "a" / fs::path("shorter"), {.series_description = "Scout"});
  const Scene read = read_scene(folder / "a");
  EXPECT_EQ(read.samples, longer.samples);
  ASSERT_EQ(verdict(read, "series"), Verdict::Warn);
  EXPECT_NE(finding(read, "series")->detail.find("'Scout' (CT, 3 slices)"), std::string::npos)
      << finding(read, "series")->detail;
}

TEST(ReadDicom, CountsStrayFilesAndNamesTheFirst) {
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.0)), folder / "series");
  write_bytes(folder / "series" / "READ.ME", "no scan");
  write_bytes(folder / "series" / "empty", "");
  const Scene read = read_scene(folder / "series");
  ASSERT_EQ(verdict(read, "stray_files"), Verdict::Warn);
  EXPECT_TRUE(finding(read, "stray_files")->detail.starts_with("2 files"))
      << finding(read, "stray_files")->detail;
  EXPECT_NE(finding(read, "stray_files")->detail.find("READ.ME"), std::string::npos);
}

TEST(ReadDicom, CountsLinksThatLeadToNoFileAsStrayFiles) {
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.0)), folder / "series");
  fs::create_symlink("self", folder / "series" / fs::path("self"));
  fs::create_symlink("nowhere", folder / "series" / fs::path("lost"));
  fs::create_directory_symlink("..", folder / "series" / fs::path("above"));
  const Scene read = read_scene(folder / "series");
  EXPECT_EQ(read.lattice.dims.z, 20);
  ASSERT_EQ(verdict(read, "stray_files"), Verdict::Warn);
  EXPECT_EQ(finding(read, "stray_files")->files, (std::vector<std::string>{"lost", "self"}));
  EXPECT_NE(reason_of(folder / "series" / fs::path("self")).find("no such file"), std::string::npos)
      << reason_of(folder / "series" / fs::path("self"));
}

TEST(ReadDicom, AppliesEachSlicesOwnRescale) {
  const ScratchFolder folder;
  const Scene written = linear_scene(leaning_lattice(0.0));
  write_dicom_series(written, folder / "series");
  using namespace std::string_literals;
  const std::string intercept = "\x28\0\x52\x10"s + "DS\x02\0"s;
  exchange(folder / "series" / slice(2), intercept + "0 ", intercept + "7 ");
  const Scene read = read_scene(folder / "series");
  EXPECT_EQ(verdict(read, "rescale"), Verdict::Warn);
  const auto& before = std::get<voxel::Int16Samples>(written.samples);
  const auto& after = std::get<voxel::Int16Samples>(read.samples);
  EXPECT_EQ(after[0], before[0]);
  EXPECT_EQ(after[40 * 50], before[40 * 50] + 7);
  const std::string slope = "\x28\0\x53\x10"s + "DS\x02\0"s;
  exchange(folder / "series" / slice(1), slope + "1 ", slope + ".5");
  const Scene halved = read_scene(folder / "series");
  ASSERT_TRUE(std::holds_alternative<voxel::FloatSamples>(halved.samples)) << "halves are no integers";
  EXPECT_EQ(std::get<voxel::FloatSamples>(halved.samples)[0], 0.5f * static_cast<float>(before[0]));
}

TEST(ReadDicom, RefusesToCallValuesHounsfieldWhoseAirIsAtZero) {
  const ScratchFolder folder;
  Scene scene = linear_scene(leaning_lattice(0.0));
  write_dicom_series(scene, folder / "hounsfield");
  EXPECT_EQ(read_scene(folder / "hounsfield").meaning, Meaning::Hounsfield);
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(scene.samples))
    sample = static_cast<std::int16_t>(std::max(0, sample + 1024));
  write_dicom_series(scene, folder / "without_intercept");
  const Scene read = read_scene(folder / "without_intercept");
  EXPECT_EQ(read.meaning, Meaning::Raw);
  EXPECT_EQ(verdict(read, "air_level"), Verdict::Fail);
}

TEST(ReadDicom, RefusesScatteredSlicesInsteadOfInventingHundreds) {
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.0)), folder / "series");
  exchange(folder / "series" / slice(20), "\\48.5", "\\9e5 ");
  EXPECT_NE(reason_of(folder / "series").find("too scattered"), std::string::npos)
      << reason_of(folder / "series");
}

TEST(ReadDicom, NamesTheFolderThatHoldsNoScan) {
  const ScratchFolder folder;
  EXPECT_NE(reason_of(folder.path()).find(folder.path().string()), std::string::npos);
  EXPECT_NE(reason_of(folder.path()).find("no DICOM slice"), std::string::npos);
}

/// The compressed pixels of a file.
std::vector<std::string> fragments_of(const fs::path& path) {
  const std::string bytes = bytes_of(path);
  const DicomFile file(bytes, bytes.size());
  std::vector<std::string> fragments;
  for (const DicomExtent& extent : *file.fragments()) fragments.emplace_back(file.at(extent));
  return fragments;
}

TEST(ReadDicom, PartsJpegFramesWithoutAnOffsetTableByTheirMarkers) {
  using tests::DicomBytes;
  const ScratchFolder folder;
  const Scene written = linear_scene(axis_aligned_lattice({16, 12, 4}, {0.25, 0.5, 2}, {-10, -20, 30}));
  write_dicom_series(written, folder / "raw");
  for (const auto type : {gdcm::TransferSyntax::JPEGLosslessProcess14_1, gdcm::TransferSyntax::JPEGLSLossless,
                          gdcm::TransferSyntax::JPEG2000Lossless}) {
    std::string items = DicomBytes::item("");
    for (int k = 1; k <= 4; ++k) {
      gdcm::ImageReader reader;
      reader.SetFileName((folder / "raw" / slice(k)).c_str());
      ASSERT_TRUE(reader.Read());
      gdcm::ImageChangeTransferSyntax change;
      change.SetTransferSyntax(gdcm::TransferSyntax(type));
      change.SetInput(reader.GetImage());
      ASSERT_TRUE(change.Change());
      gdcm::ImageWriter writer;
      writer.SetFile(reader.GetFile());
      writer.SetImage(change.GetOutput());
      writer.SetFileName((folder / "frame").c_str());
      ASSERT_TRUE(writer.Write());
      // Each frame in two fragments, so that their number does not tell where frames begin.
      const std::string whole = fragments_of(folder / "frame").front();
      const std::size_t half = whole.size() / 4 * 2;
      items += DicomBytes::item(whole.substr(0, half)) + DicomBytes::item(whole.substr(half));
    }
    tests::DicomFrames frames;
    frames.count = 4;
    frames.columns = 16;
    frames.rows = 12;
    std::string attributes = frames.attributes();
    attributes.resize(attributes.find(DicomBytes::tag(0x7fe00010)));
    const std::string old_intercept = DicomBytes::element(0x00281052, "DS", "-1000");
    attributes.replace(attributes.find(old_intercept), old_intercept.size(),
                       DicomBytes::element(0x00281052, "DS", "000000"));
    attributes += DicomBytes::tag(0x7fe00010) + "OB" + DicomBytes::number(0, 2) +
                  DicomBytes::number(0xffffffff, 4) + items + DicomBytes::tag(0xfffee0dd) +
                  DicomBytes::number(0, 4);
    write_bytes(folder / "frames.dcm", DicomBytes::file(gdcm::TransferSyntax::GetTSString(type), attributes));
    EXPECT_EQ(read_scene(folder / "frames.dcm").samples, written.samples);
  }
}

TEST(ReadDicom, ReadsUnknownOpenSequencesOfBigEndianFilesInEitherOrder) {
  const ScratchFolder folder;
  for (const bool little_inside : {false, true}) {
    std::vector<tests::SpoiledImage> images = tests::sound_series(3);
    for (tests::SpoiledImage& image : images) {
      image.syntax = "1.2.840.10008.1.2.2";
      image.big_endian = true;
      // A private sequence without lengths, of unknown representation, before the pixels.
      const auto number = [&](std::uint32_t value, int count) {
        const std::string little = tests::DicomBytes::number(value, count);
        return little_inside ? little : std::string(little.rbegin(), little.rend());
      };
      const auto tag = [&](std::uint32_t value) {
        return number(value >> 16, 2) + number(value & 0xffff, 2);
      };
      image.open_unknown = tag(0xfffee000) + number(0xffffffff, 4) + tag(0x00110012) + number(4, 4) + "text" +
                           tag(0xfffee00d) + number(0, 4) + tag(0xfffee0dd) + number(0, 4);
      std::ofstream(folder / image.name, std::ios::binary) << image.bytes();
    }
    const Scene scene = read_scene(folder.path());
    EXPECT_EQ(scene.lattice.dims, glm::ivec3(24, 20, 3)) << little_inside;
    EXPECT_EQ(std::get<Int16Samples>(scene.samples)[1], -999);
  }
}

class EverySyntax : public testing::TestWithParam<gdcm::TransferSyntax::TSType> {};

TEST_P(EverySyntax, GivesTheSameSamples) {
  const ScratchFolder folder;
  const Scene written = linear_scene(leaning_lattice(0.0));
  write_dicom_series(written, folder / "raw");
  fs::create_directories(folder / "recoded");
  for (int k = 1; k <= 20; ++k) {
    gdcm::ImageReader reader;
    reader.SetFileName((folder / "raw" / slice(k)).c_str());
    ASSERT_TRUE(reader.Read());
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(gdcm::TransferSyntax(GetParam()));
    change.SetInput(reader.GetImage());
    ASSERT_TRUE(change.Change());
    gdcm::ImageWriter writer;
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    writer.SetFileName((folder / "recoded" / slice(k)).c_str());
    ASSERT_TRUE(writer.Write());
  }
  ASSERT_NE(bytes_of(folder / "raw" / slice(1)), bytes_of(folder / "recoded" / slice(1)));
  const Scene read = read_scene(folder / "recoded");
  EXPECT_EQ(read.lattice, written.lattice);
  EXPECT_EQ(read.samples, written.samples);
  // Damage to compressed pixels, which crashes codecs, is answered with a reason and leaves the program
  // whole.
  const std::string whole = bytes_of(folder / "recoded" / slice(1));
  for (std::size_t seed = 0; seed < 40; ++seed) {
    std::string mutant = whole;
    for (std::size_t i = 0; i < 20; ++i)
      mutant[whole.size() - 1 - (seed * 7919 + i * 104729) % 1000] = static_cast<char>(seed * 31 + i);
    write_bytes(folder / "mutant.dcm", mutant);
    const std::string reason = reason_of(folder / "mutant.dcm");
    EXPECT_TRUE(reason == "nothing was thrown" || reason.starts_with((folder / "mutant.dcm").string()))
        << reason;
  }
  EXPECT_EQ(read_scene(folder / "recoded").samples, written.samples);
}

INSTANTIATE_TEST_SUITE_P(
    ReadDicom, EverySyntax,
    testing::Values(gdcm::TransferSyntax::ImplicitVRLittleEndian, gdcm::TransferSyntax::ExplicitVRBigEndian,
                    gdcm::TransferSyntax::RLELossless, gdcm::TransferSyntax::JPEGLosslessProcess14_1,
                    gdcm::TransferSyntax::JPEGLSLossless, gdcm::TransferSyntax::JPEG2000Lossless));

TEST(ReadDicom, RefusesAnAttributeLongerThanItsFile) {
  // A reader that allocates what an attribute claims takes four gigabytes here.
  const ScratchFolder folder;
  write_dicom_series(linear_scene(leaning_lattice(0.0)), folder / "series");
  using namespace std::string_literals;
  const fs::path path = folder / "series" / slice(1);
  exchange(path, "\xe0\x7f\x10\0OW\0\0\xa0\x0f\0\0"s, "\xe0\x7f\x10\0OW\0\0\xfe\xff\xff\xff"s);
  EXPECT_NE(reason_of(path).find("attribute (7fe0,0010) claims 4294967294 bytes"), std::string::npos)
      << reason_of(path);
}

/// A text that claims `dims` and then holds 24 bytes of samples, 0 to 23.
std::string nrrd_with(const std::string& fields) {
  std::string text = "NRRD0004\n" + fields + "endian: little\nencoding: raw\n\n";
  for (char value = 0; value < 24; ++value) text += value;
  return text;
}

TEST(ReadVolumeFile, TurnsOtherFramesIntoLps) {
  const ScratchFolder folder;
  write_bytes(folder / "ras.nrrd",
              nrrd_with("type: uint8\ndimension: 3\nspace: right-anterior-superior\nsizes: 2 3 4\n"
                        "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n"));
  const Scene read = read_scene(folder / "ras.nrrd");
  EXPECT_EQ(read.lattice.lps_mm({0, 0, 0}), glm::dvec3(-10, -20, 30));
  EXPECT_EQ(read.lattice.lps_mm({1, 2, 3}), glm::dvec3(-12, -26, 42));
  ASSERT_TRUE(std::holds_alternative<voxel::Int16Samples>(read.samples));
  EXPECT_EQ(std::get<voxel::Int16Samples>(read.samples)[23], 23) << "x fastest, z slowest";
  EXPECT_EQ(verdict(read, "orientation"), Verdict::Pass);
  write_bytes(folder / "unnamed.nrrd",
              nrrd_with("type: uint8\ndimension: 3\nsizes: 2 3 4\nspacings: 2 3 4\n"));
  EXPECT_EQ(verdict(read_scene(folder / "unnamed.nrrd"), "orientation"), Verdict::Warn);
}

TEST(ReadVolumeFile, TakesWhatIsNoNumberAsPaddingAndSaysSo) {
  const ScratchFolder folder;
  Scene scene = linear_scene(axis_aligned_lattice({4, 4, 4}, glm::dvec3(1.0), glm::dvec3(0.0)));
  voxel::FloatSamples samples(64, 2.5f);
  samples[1] = -7.5f;
  samples[5] = std::numeric_limits<float>::quiet_NaN();
  scene.samples = samples;
  write_scene(scene, folder / "nan.nrrd");
  const Scene read = read_scene(folder / "nan.nrrd");
  EXPECT_EQ(verdict(read, "finite"), Verdict::Warn);
  ASSERT_TRUE(read.padding.has_value());
  EXPECT_LT(*read.padding, -7.5) << "below every measured sample";
  EXPECT_EQ(std::get<voxel::FloatSamples>(read.samples)[5], static_cast<float>(*read.padding));
  EXPECT_EQ(voxel::range(read).low, -7.5);
}

/// The lowest numbers of either type have none below them of the same type.
TEST(ReadVolumeFile, HasPaddingBelowTheLowestNumbersToo) {
  const ScratchFolder folder;
  for (const float low : {-32768.0f, -3e38f}) {
    Scene scene = linear_scene(axis_aligned_lattice({4, 4, 4}, glm::dvec3(1.0), glm::dvec3(0.0)));
    voxel::FloatSamples samples(64, 2.0f);
    samples[1] = low;
    samples[5] = std::numeric_limits<float>::infinity();
    scene.samples = samples;
    write_scene(scene, folder / "lowest.nrrd");
    const Scene read = read_scene(folder / "lowest.nrrd");
    ASSERT_TRUE(read.padding.has_value()) << low;
    EXPECT_LT(*read.padding, static_cast<double>(low));
    EXPECT_EQ(voxel::range(read).low, static_cast<double>(low));
  }
}

TEST(ReadVolumeFile, DoesNotAllocateWhatTheFileCannotHold) {
  const ScratchFolder folder;
  const std::string rest =
      "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
      "space origin: (0,0,0)\n";
  for (const char* sizes :
       {"60000 60000 60000", "2 3 50", "2147483647 2147483647 2147483647", "-2 3 4", "0 3 4"}) {
    write_bytes(folder / "lie.nrrd",
                nrrd_with("type: int16\ndimension: 3\n" + rest + "sizes: " + std::string(sizes) + "\n"));
    const std::string reason = reason_of(folder / "lie.nrrd");
    EXPECT_NE(reason, "nothing was thrown") << sizes;
    if (sizes[0] == '6' || sizes[4] == '5') {
      EXPECT_NE(reason.find("more than its data can hold"), std::string::npos) << sizes << ": " << reason;
    }
  }
}

TEST(ReadVolumeFile, SaysInOneLineWhatIsWrong) {
  const ScratchFolder folder;
  for (const char* name : {"text.nrrd", "text.nii", "text.nii.gz", "text.mha", "text.mhd"}) {
    const fs::path path = folder / name;
    EXPECT_EQ(reason_of(path), path.string() + ": no such file or folder");
    write_bytes(path, "this is a letter, not a scan\nand has two lines\n");
    const std::string reason = reason_of(path);
    EXPECT_TRUE(reason.starts_with(path.string())) << reason;
    EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
    EXPECT_NE(reason.find("is not a"), std::string::npos) << reason;
  }
  write_bytes(folder / "broken.nrrd", nrrd_with("type: nonsense\ndimension: 3\nsizes: 2 3 4\n"));
  const std::string reason = reason_of(folder / "broken.nrrd");
  EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
  EXPECT_NE(reason.find("nonsense"), std::string::npos) << reason;
}

TEST(ReadVolumeFile, RefusesAVolumeWhoseDataFileIsGone) {
  const ScratchFolder folder;
  write_scene(linear_scene(oblique_lattice()), folder / "scan.nhdr");
  fs::remove(folder / "scan.raw.gz");
  EXPECT_NE(reason_of(folder / "scan.nhdr").find("keep header and data together"), std::string::npos)
      << reason_of(folder / "scan.nhdr");
}

TEST(ReadVolumeFile, MutatedHeadersAreReadOrRefusedButNeverCrash) {
  // The samples are 24 bytes: whatever is read must be as small.
  const ScratchFolder folder;
  const std::string whole = nrrd_with(
      "type: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 4\n"
      "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n");
  int refused_count = 0;
  int read_count = 0;
  for (std::size_t seed = 0; seed < 300; ++seed) {
    std::string mutant = whole;
    const std::size_t at = seed * 7919 % whole.size();
    if (seed % 3 == 0)
      mutant.resize(at);
    else
      mutant[at] = static_cast<char>(seed % 3 == 1 ? '0' + seed % 10 : seed * 31 % 128);
    write_bytes(folder / "mutant.nrrd", mutant);
    try {
      EXPECT_LE(read_scene(folder / "mutant.nrrd").lattice.sample_count(), mutant.size())
          << "mutant " << seed;
      ++read_count;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos)
          << "mutant " << seed << ": " << error.what();
      ++refused_count;
    }
  }
  EXPECT_GT(refused_count, 30);
  EXPECT_GT(read_count, 30);
}

TEST(ReadVolumeFile, RefusesANiftiOfPositionsThatNoScannerReaches) {
  const ScratchFolder folder;
  const fs::path path = folder / "scan.nii";
  write_scene(linear_scene(oblique_lattice()), path);
  std::string bytes = bytes_of(path);
  bytes[291] = 0x7f;  // the exponent of the affine's third number: about 1e38
  write_bytes(path, bytes);
  EXPECT_NE(reason_of(path).find("its sform has a number larger than any length in a scan"),
            std::string::npos)
      << reason_of(path);
}

TEST(ReadVolumeFile, RefusesAMetaImageLineWithoutAValue) {
  const ScratchFolder folder;
  const fs::path path = folder / "scan.mha";
  write_scene(linear_scene(oblique_lattice()), path);
  exchange(path, "TransformMatrix = ", "TransformMatrix 8 ");
  EXPECT_NE(reason_of(path).find("neither 'Key = Value' nor 'Key: Value'"), std::string::npos)
      << reason_of(path);
}

template <typename Predicate>
std::ptrdiff_t count_if(const Scene& scene, const Predicate& predicate) {
  const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  return std::count_if(samples.begin(), samples.end(), predicate);
}

TEST(ReadScene, ReadsTheSkullPhantomBesideItsDirectoryFile) {
  OCTOTOMY_NEEDS_DATA("ct_philips_skullphantom_5mm");
  const Scene scene = read_scene(tests::reference_data("ct_philips_skullphantom_5mm"));
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(512, 512, 28));
  EXPECT_EQ(scene.lattice.spacing_mm(), glm::dvec3(0.451171875, 0.451171875, 5.0));
  EXPECT_EQ(scene.meaning, Meaning::Hounsfield);
  EXPECT_EQ(verdict(scene, "stray_files"), Verdict::Warn);
  EXPECT_NE(finding(scene, "stray_files")->detail.find("DIRFILE"), std::string::npos);
  EXPECT_EQ(count_if(scene, [](int value) { return value > 300; }), 337019);
}

TEST(ReadScene, SeesThatTheSlicerHeadIsNotHounsfield) {
  OCTOTOMY_NEEDS_DATA("ct_slicer_cthead_lowres_dicom");
  const Scene scene = read_scene(tests::reference_data("ct_slicer_cthead_lowres_dicom"));
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(64, 64, 93));
  EXPECT_EQ(scene.meaning, Meaning::Raw);
  EXPECT_EQ(verdict(scene, "air_level"), Verdict::Fail);
  EXPECT_EQ(count_if(scene, [](int value) { return value > 1150; }), 34240);
}

TEST(ReadScene, PutsTheHeadOfACoronalSeriesUp) {
  OCTOTOMY_NEEDS_DATA("mr_ctk_mrhead_coronal_dicom");
  const Scene scene = read_scene(tests::reference_data("mr_ctk_mrhead_coronal_dicom"));
  EXPECT_EQ(scene.lattice.dims, glm::ivec3(256, 256, 100));
  EXPECT_NEAR(scene.lattice.spacing_mm().z, 2.5, 1e-5);
  EXPECT_TRUE(scene.lattice.right_handed());
  EXPECT_EQ(scene.meaning, Meaning::Raw);
  // The vertex is narrow, neck and shoulders leave the field wide: what shines in the highest and lowest 16
  // mm.
  const Box box = bounds(scene.lattice);
  int above = 0;
  int below = 0;
  for (double x_mm = box.low_mm.x + 2.0; x_mm < box.high_mm.x; x_mm += 4.0)
    for (double y_mm = box.low_mm.y + 2.0; y_mm < box.high_mm.y; y_mm += 4.0)
      for (double z_mm = 2.0; z_mm < 16.0; z_mm += 4.0) {
        above += interpolate(scene, scene.lattice.voxel({x_mm, y_mm, box.high_mm.z - z_mm})) > 100.0;
        below += interpolate(scene, scene.lattice.voxel({x_mm, y_mm, box.low_mm.z + z_mm})) > 100.0;
      }
  EXPECT_GT(below, 4 * above);
}

TEST(ReadScene, ReadsWhatNrrdNiftiAndMetaImageHold) {
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  const Scene ct = read_scene(tests::reference_data("ct_unc_cthead.nrrd"));
  EXPECT_EQ(ct.lattice, axis_aligned_lattice({256, 256, 113}, {1, 1, 2}, {-127.5, -127.5, 0}));
  EXPECT_EQ(ct.meaning, Meaning::Hounsfield);
  EXPECT_EQ(count_if(ct, [](int value) { return value > 300; }), 396166);
  const Scene mr = read_scene(tests::reference_data("mr_ch2_nifti") / "ch2.nii.gz");
  EXPECT_EQ(mr.lattice.dims, glm::ivec3(181, 217, 181));
  EXPECT_EQ(mr.lattice.lps_mm({0, 0, 0}), glm::dvec3(90, 125, -71)) << "RAS (-90, -125, -71)";
  EXPECT_EQ(mr.lattice.lps_mm({1, 1, 1}), glm::dvec3(89, 124, -70));
  EXPECT_EQ(mr.meaning, Meaning::Raw);
  const Scene tiny = read_scene(tests::reference_data("mr_vtk_headmrvolume") / "HeadMRVolume.mhd");
  EXPECT_EQ(tiny.lattice.dims, glm::ivec3(48, 62, 42));
  EXPECT_EQ(tiny.lattice.spacing_mm(), glm::dvec3(4.0));
}

}  // namespace
}  // namespace octotomy::voxel
