// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/write_scene.h"

#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <set>
#include <stdexcept>
#include <thread>

#include "tests/file_bytes.h"
#include "tests/voxel/linear_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;
using tests::bytes_of;
using tests::linear_scene;
using tests::oblique_lattice;
using tests::ScratchFolder;

/// Greatest distance between the corners of two lattices' index ranges.
double worst_shift_mm(const Lattice& a, const Lattice& b) {
  double worst = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(a.dims - 1);
    worst = std::max(worst, glm::length(a.lps_mm(p) - b.lps_mm(p)));
  }
  return worst;
}

Scene half_scene(const Lattice& lattice) {
  Scene scene = linear_scene(lattice);
  voxel::FloatSamples samples;
  for (const std::int16_t sample : std::get<voxel::Int16Samples>(scene.samples))
    samples.push_back(0.5f * static_cast<float>(sample));
  scene.samples = samples;
  scene.meaning = Meaning::Raw;
  scene.modality = "MR";
  return scene;
}

class EveryFormat : public testing::TestWithParam<const char*> {};

TEST_P(EveryFormat, KeepsSamplesMeaningAndTheirPlaceInThePatient) {
  const std::string extension = GetParam();
  for (const bool left_handed : {false, true}) {
    const ScratchFolder folder;
    const Scene whole = linear_scene(oblique_lattice(left_handed));
    for (Scene written : {whole, half_scene(whole.lattice)}) {
      const fs::path path = folder / ("scan" + extension);
      write_scene(written, path);
      const Scene read = read_scene(path);
      EXPECT_EQ(read.samples, written.samples);
      EXPECT_EQ(read.lattice.dims, written.lattice.dims);
      EXPECT_EQ(read.meaning, written.meaning);
      EXPECT_EQ(read.modality, written.modality);
      EXPECT_LT(worst_shift_mm(read.lattice, written.lattice), 1e-6)
          << extension << (left_handed ? ", left-handed" : ", right-handed");
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
      EXPECT_FALSE(entry.is_directory()) << entry.path() << " was left behind";
  }
}

TEST_P(EveryFormat, RemembersALabelMap) {
  const ScratchFolder folder;
  Scene written = linear_scene(oblique_lattice());
  written.meaning = Meaning::Label;
  write_scene(written, folder / (std::string("labels") + GetParam()));
  EXPECT_EQ(read_scene(folder / (std::string("labels") + GetParam())).meaning, Meaning::Label);
}

TEST(WriteScene, BelievesANiftisHeaderWhereSomebodyChangedIt) {
  const ScratchFolder folder;
  const Scene written = linear_scene(oblique_lattice());
  write_scene(written, folder / "scan.nii");
  std::string bytes = bytes_of(folder / "scan.nii");
  // The origin's x in the sform and the qform, by 5 mm.
  for (const std::size_t at : {std::size_t{268}, std::size_t{292}}) {
    float x_mm = 0.0f;
    std::memcpy(&x_mm, bytes.data() + at, sizeof x_mm);
    x_mm += 5.0f;
    std::memcpy(bytes.data() + at, &x_mm, sizeof x_mm);
  }
  std::ofstream(folder / "moved.nii", std::ios::binary) << bytes;
  const Scene read = read_scene(folder / "moved.nii");
  EXPECT_NEAR(worst_shift_mm(read.lattice, written.lattice), 5.0, 1e-4);
  EXPECT_EQ(tests::verdict(read, "geometry"), Verdict::Warn);
}

TEST_P(EveryFormat, IsRefusedWhereItsSamplesAreCutShortOrDamaged) {
  const ScratchFolder folder;
  write_scene(linear_scene(oblique_lattice()), folder / (std::string("scan") + GetParam()));
  // The file with the samples is the larger one.
  fs::path data;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
    if (data.empty() || entry.file_size() > fs::file_size(data)) data = entry.path();
  const std::string whole = bytes_of(data);
  const auto is_refused = [&](const std::string& bytes) {
    std::ofstream(data, std::ios::binary) << bytes;
    try {
      read_scene(folder / (std::string("scan") + GetParam()));
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused(whole));
  for (const std::size_t keep : {whole.size() / 2, whole.size() - 40})
    EXPECT_TRUE(is_refused(whole.substr(0, keep))) << keep << " of " << whole.size();
  if (std::string(GetParam()) == ".nii") return;  // has no checksum to see a changed byte by
  std::string damaged = whole;
  damaged[whole.size() * 2 / 3] = static_cast<char>(damaged[whole.size() * 2 / 3] ^ 0x55);
  EXPECT_TRUE(is_refused(damaged));
}

INSTANTIATE_TEST_SUITE_P(WriteScene, EveryFormat,
                         testing::Values(".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd"),
                         [](const testing::TestParamInfo<const char*>& format) {
                           std::string name = format.param + 1;
                           std::erase(name, '.');
                           return name;
                         });

Lattice sheared_lattice() {
  Lattice lattice = axis_aligned_lattice({20, 20, 10}, {1.0, 1.0, 2.0}, {-20.0, -25.0, 10.5});
  lattice.lps_from_voxel[2].y = 0.6;
  return lattice;
}

TEST(WriteScene, KeepsShearInNrrdAndNiftiAndRefusesItWhereItCannotBeSaid) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(sheared_lattice());
  for (const char* name : {"sheared.nrrd", "sheared.nii", "sheared.nii.gz"}) {
    write_scene(scene, folder / name);
    const Scene read = read_scene(folder / name);
    EXPECT_LT(worst_shift_mm(read.lattice, scene.lattice), 1e-6) << name;
    EXPECT_EQ(tests::finding(read, "forms"), nullptr) << name << ": no qform can say it, so none is stated";
  }
  for (const char* name : {"sheared.mha", "sheared.mhd"}) {
    EXPECT_THROW(write_scene(scene, folder / name), std::invalid_argument) << name;
    EXPECT_FALSE(fs::exists(folder / name)) << name;
  }
}

TEST(WriteScene, LeavesTheOldFileWhereItFails) {
  const ScratchFolder folder;
  std::ofstream(folder / "scan.mha") << "precious";
  EXPECT_THROW(write_scene(linear_scene(sheared_lattice()), folder / "scan.mha"), std::invalid_argument);
  EXPECT_EQ(bytes_of(folder / "scan.mha"), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

std::set<std::string> entry_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(WriteScene, AnOlderHeaderNeverReadsNewSamples) {
  for (const auto& [name, data] :
       {std::pair{"scan.nhdr", "scan.raw.gz"}, std::pair{"scan.mhd", "scan.zraw"}}) {
    const ScratchFolder folder;
    const fs::path header = folder / name;
    const Scene older = linear_scene(oblique_lattice()), newer = half_scene(older.lattice);
    write_scene(older, header);
    const std::string older_header = bytes_of(header), older_data = bytes_of(folder / data);
    write_scene(newer, header);
    EXPECT_EQ(read_scene(header).samples, newer.samples);
    EXPECT_EQ(entry_names(folder.path()).size(), 2u) << "the older samples are gone";
    std::ofstream(header, std::ios::binary) << older_header;
    EXPECT_THROW(read_scene(header), std::runtime_error) << "the older header alone";
    // As a kill leaves it that comes after the new samples and before the new header.
    std::ofstream(folder / data, std::ios::binary) << older_data;
    EXPECT_EQ(entry_names(folder.path()).size(), 3u);
    EXPECT_EQ(read_scene(header).samples, older.samples);
    write_scene(newer, header);
    EXPECT_EQ(read_scene(header).samples, newer.samples);
    EXPECT_FALSE(fs::exists(folder / data));
  }
}

TEST(WriteScene, SamplesThatTheOlderHeaderDoesNotNameStay) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(oblique_lattice());
  write_scene(scene, folder / "scan.mhd");
  std::ofstream(folder / "scan.samples-2.zraw") << "mine";
  write_scene(scene, folder / "scan.mhd");
  EXPECT_EQ(bytes_of(folder / "scan.samples-2.zraw"), "mine");
  // A header whose samples have another name.
  std::string header = bytes_of(folder / "scan.mhd");
  const std::string named = "scan.samples-3.zraw";
  ASSERT_NE(header.find(named), std::string::npos) << header;
  std::ofstream(folder / "scan.mhd") << header.replace(header.find(named), named.size(), "other.data");
  fs::rename(folder / named, folder / "other.data");
  EXPECT_FALSE(own_data_file(folder / "scan.mhd"));
  write_scene(scene, folder / "scan.mhd");
  EXPECT_EQ(entry_names(folder.path()),
            (std::set<std::string>{"other.data", "scan.mhd", "scan.samples-2.zraw", "scan.zraw"}));
  EXPECT_EQ(own_data_file(folder / "scan.mhd"), folder / "scan.zraw");
}

TEST(WriteScene, NamesTheFolderThatIsNotThereAndTheUnknownExtension) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(oblique_lattice());
  for (const fs::path& path : {folder / "absent" / fs::path("scan.nrrd"), folder / "scan.docx"}) {
    try {
      write_scene(scene, path);
      FAIL() << path << " was written";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path.parent_path().string()), std::string::npos)
          << error.what();
    }
  }
}

TEST(WriteDicomSeries, WritesTheSameBytesForTheSameScene) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(oblique_lattice());
  write_dicom_series(scene, folder / "a");
  write_dicom_series(scene, folder / "b");
  write_dicom_series(scene, folder / "c", {.series_description = "Another"});
  const std::string first = bytes_of(folder / "a" / fs::path("slice_0007.dcm"));
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first, bytes_of(folder / "b" / fs::path("slice_0007.dcm")));
  EXPECT_NE(first, bytes_of(folder / "c" / fs::path("slice_0007.dcm")));
}

TEST(WriteDicomSeries, AFolderAppearsWithAllItsSlices) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(axis_aligned_lattice({16, 16, 300}, {1, 1, 2}, {-10, -8, 5}));
  const std::jthread writer([&] { write_dicom_series(scene, folder / "made/series"); });
  while (!fs::exists(folder / "made/series")) std::this_thread::yield();
  EXPECT_EQ(entry_names(folder / "made/series").size(), 300u);
}

TEST(WriteDicomSeries, AFolderThatIsThereKeepsItsOtherFiles) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(oblique_lattice());
  fs::create_directory(folder / "series");
  fs::create_directory_symlink("series", folder / "link");
  std::ofstream(folder / "series/notes.txt") << "mine";
  write_dicom_series(scene, folder / "link/");
  EXPECT_EQ(entry_names(folder / "series").size(), static_cast<std::size_t>(scene.lattice.dims.z) + 1);
  EXPECT_EQ(bytes_of(folder / "series/notes.txt"), "mine");
  EXPECT_EQ(entry_names(folder.path()), (std::set<std::string>{"link", "series"}));
  EXPECT_EQ(read_scene(folder / "series").samples, scene.samples);
}

TEST(WriteDicomSeries, PlacesEverySliceToAMillionthOfAMillimetre) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(oblique_lattice());
  write_dicom_series(scene, folder / "series");
  const Scene read = read_scene(folder / "series");
  EXPECT_EQ(read.samples, scene.samples);
  EXPECT_LT(worst_shift_mm(read.lattice, scene.lattice), 1e-6);
}

TEST(WriteDicomSeries, SaysWhereValuesAreNotHounsfield) {
  const ScratchFolder folder;
  Scene scene = linear_scene(oblique_lattice());
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(scene.samples))
    sample = static_cast<std::int16_t>(std::max<int>(sample, -800));  // takes away the air that tells
  write_dicom_series(scene, folder / "hounsfield");
  EXPECT_EQ(read_scene(folder / "hounsfield").meaning, Meaning::Hounsfield);
  scene.meaning = Meaning::Raw;
  write_dicom_series(scene, folder / "raw");
  EXPECT_EQ(read_scene(folder / "raw").meaning, Meaning::Raw);
}

TEST(WriteDicomSeries, KeepsTheUnitThatTheSceneDeclares) {
  const ScratchFolder folder;
  for (const char* unit : {"HU", "US", "OD", "Z_EFF", "MGML"}) {
    Scene scene = linear_scene(oblique_lattice());
    scene.modality = "CT";
    scene.declared_unit = unit;
    write_dicom_series(scene, folder / unit);
    const Scene read = read_scene(folder / unit);
    EXPECT_EQ(read.declared_unit, unit);
    EXPECT_EQ(read.modality, "CT");
    EXPECT_FALSE(is_written_as_secondary_capture(scene));
  }
  // A declared unit other than HU is none of Hounsfield, whatever the values look like.
  EXPECT_EQ(read_scene(folder / "OD").meaning, Meaning::Raw);
}

TEST(WriteDicomSeries, WritesOtherModalitiesAsWhatTheyAre) {
  const ScratchFolder folder;
  for (const auto& [modality, unit] :
       {std::pair{"PT", "BQML"}, std::pair{"RTDOSE", "GY"}, std::pair{"OT", ""}}) {
    Scene scene = linear_scene(oblique_lattice());
    scene.meaning = Meaning::Raw;
    scene.modality = modality;
    scene.declared_unit = unit;
    EXPECT_TRUE(is_written_as_secondary_capture(scene));
    write_dicom_series(scene, folder / modality);
    const std::string bytes = bytes_of(folder / modality / "slice_0001.dcm");
    EXPECT_NE(bytes.find("1.2.840.10008.5.1.4.1.1.7"), std::string::npos) << modality;
    const Scene read = read_scene(folder / modality);
    EXPECT_EQ(read.modality, modality);
    EXPECT_EQ(read.meaning, Meaning::Raw);
    EXPECT_EQ(read.declared_unit, *unit == '\0' ? "US" : unit);
    EXPECT_EQ(read.samples, scene.samples);
  }
}

TEST(WriteDicomSeries, KeepsFractionsByASlope) {
  const ScratchFolder folder;
  const Scene halves = half_scene(oblique_lattice());
  write_dicom_series(halves, folder / "halves");
  EXPECT_EQ(read_scene(folder / "halves").samples, halves.samples) << "halves are multiples of the slope";
  for (const double scale : {1e-3, 0.37, 1.0, 41.7}) {
    Scene odd = halves;
    for (float& sample : std::get<FloatSamples>(odd.samples))
      sample = static_cast<float>(scale * std::sin(sample) - 0.3 * scale);
    odd.meaning = Meaning::Raw;
    const std::string name = "odd" + std::to_string(scale);
    write_dicom_series(odd, folder / name);
    const Scene read = read_scene(folder / name);
    const Range values = range(odd);
    const double slope_bound = 2.0 * (values.high - values.low) / 65533.0;
    double worst = 0.0;
    std::visit(
        [&](const auto& samples) {
          for (std::size_t i = 0; i < samples.size(); ++i)
            worst = std::max(worst, std::abs(static_cast<double>(samples[i]) -
                                             static_cast<double>(std::get<FloatSamples>(odd.samples)[i])));
        },
        read.samples);
    EXPECT_LE(worst, 0.5 * slope_bound * 1.001) << scale;
    EXPECT_GT(worst, 0.0) << "the test has seen rounding";
  }
}

TEST(WriteDicomSeries, SaysResampledOnlyIfItIsAndGivesAWindow) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(axis_aligned_lattice({20, 16, 8}, {1, 1, 2}, {-10, -8, 5}));
  write_dicom_series(scene, folder / "source");
  DicomOptions options;
  options.source = dicom_source(folder / "source");
  ASSERT_TRUE(options.source->lattice);
  EXPECT_EQ(*options.source->lattice, scene.lattice);
  Scene cropped = linear_scene(axis_aligned_lattice({10, 8, 3}, {1, 1, 2}, {-7, -5, 9}));
  cropped.modality = "CT";
  write_dicom_series(cropped, folder / "cropped", options);
  const std::string same = bytes_of(folder / "cropped" / fs::path("slice_0002.dcm"));
  EXPECT_NE(same.find("not resampled"), std::string::npos);
  const std::string window = std::string("\x28\0\x50\x10", 4) + "DS";
  EXPECT_NE(same.find(window), std::string::npos);
  Scene between = linear_scene(axis_aligned_lattice({10, 8, 3}, {1, 1, 2}, {-7, -5, 10}));
  write_dicom_series(between, folder / "between", options);
  const std::string other = bytes_of(folder / "between" / fs::path("slice_0002.dcm"));
  EXPECT_NE(other.find("Resampled"), std::string::npos);
  EXPECT_EQ(other.find("not resampled"), std::string::npos);
}

TEST(WriteDicomSeries, RefusesWhatItCannotHoldAndOverwritesNothing) {
  const ScratchFolder folder;
  const Scene scene = linear_scene(oblique_lattice());
  Scene endless = half_scene(scene.lattice);
  std::get<FloatSamples>(endless.samples)[7] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(write_dicom_series(endless, folder / "endless"), std::invalid_argument);
  EXPECT_TRUE(entry_names(folder.path()).empty());
  Scene skewed = scene;
  skewed.lattice.lps_from_voxel[1] += 0.2 * skewed.lattice.lps_from_voxel[0];
  EXPECT_THROW(write_dicom_series(skewed, folder / "skewed"), std::invalid_argument);
  EXPECT_THROW(write_dicom_series(scene, folder / "name", {.patient_name = std::string(65, 'x')}),
               std::invalid_argument);
  write_dicom_series(scene, folder / "series");
  EXPECT_THROW(write_dicom_series(scene, folder / "series"), std::runtime_error);
  fs::create_directory(folder / "longer");
  EXPECT_NO_THROW(need_no_slices(folder / "longer"));
  fs::copy(folder / "series/slice_0002.dcm", folder / "longer/slice_9000.dcm");
  try {
    write_dicom_series(scene, folder / "longer");
    FAIL() << "slices of another series were added";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("longer/slice_9000.dcm"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::voxel
