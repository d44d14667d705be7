// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A table of kinds, one paragraph a group: longer than most sources because each kind is one entry.
#include "tests/voxel/scan/spoiled_series.h"

#include <cmath>
#include <fstream>

#include "tests/voxel/scan/dicom_bytes.h"

namespace octotomy::tests {

namespace {

constexpr int columns = 24, rows = 20;
constexpr auto pass = voxel::Verdict::Pass;
constexpr auto warn = voxel::Verdict::Warn;
constexpr auto fail = voxel::Verdict::Fail;
using Images = std::vector<SpoiledImage>;

int hounsfield(int x, int y, int k) {
  const double r = std::hypot(x - 11.5, y - 9.5, 1.5 * (k - 5.5));
  return r < 8.0 ? 400 + (x * 7 + y * 3 + k * 5) % 50 : -1000 + (x + 2 * y + k) % 8;
}

/// The ball's pixels in slice k, plus an offset, each times a factor.
std::string pixels_of(int k, int offset = 1024, int divisor = 1) {
  std::string bytes;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      bytes += DicomBytes::number(static_cast<std::uint32_t>((hounsfield(x, y, k) + offset) / divisor), 2);
  return bytes;
}

std::string decimal(double value) {
  char text[20];
  std::snprintf(text, sizeof text, "%.8g", value);
  return text;
}

std::string swapped(std::string bytes) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
  return bytes;
}

std::string big(std::uint32_t value, int count) {
  const std::string little = DicomBytes::number(value, count);
  return {little.rbegin(), little.rend()};
}

/// Sets one text in the images from `first` to `last`.
std::function<void(Images&)> text(std::uint32_t tag, const char* vr, const std::string& value, int first = 0,
                                  int last = 1000) {
  return [=](Images& images) {
    for (int i = first; i <= last && i < static_cast<int>(images.size()); ++i)
      images[static_cast<std::size_t>(i)].text(tag, vr, value);
  };
}

std::function<void(Images&)> number(std::uint32_t tag, std::uint16_t value, int first = 0, int last = 1000) {
  return text(tag, "US", DicomBytes::number(value, 2), first, last);
}

std::function<void(Images&)> without(std::vector<std::uint32_t> tags, int first = 0, int last = 1000) {
  return [=](Images& images) {
    for (int i = first; i <= last && i < static_cast<int>(images.size()); ++i)
      for (const std::uint32_t tag : tags) images[static_cast<std::size_t>(i)].elements.erase(tag);
  };
}

std::function<void(Images&)> removed(std::vector<int> numbers) {
  return [=](Images& images) {
    for (auto number = numbers.rbegin(); number != numbers.rend(); ++number)
      images.erase(images.begin() + *number);
  };
}

std::function<void(Images&)> moved(int i, double x_mm, double y_mm, double z_mm) {
  return [=](Images& images) {
    images[static_cast<std::size_t>(i)].place(-6 + x_mm, -5 + y_mm, 30 + 2 * i + z_mm);
  };
}

/// A second set of images at the places of the first, with one attribute of another value.
std::function<void(Images&)> doubled(std::uint32_t tag, const char* vr, const char* one, const char* other) {
  return [=](Images& images) {
    Images second = sound_series(12, "b");
    for (SpoiledImage& image : images) image.text(tag, vr, one);
    for (std::size_t i = 0; i < second.size(); ++i) {
      second[i].text(tag, vr, other);
      second[i].text(0x00080018, "UI", "1.2.3.9." + std::to_string(i));
      second[i].text(0x7fe00010, "OW", pixels_of(static_cast<int>(i), 1100));
    }
    second.pop_back();
    images.insert(images.end(), second.begin(), second.end());
  };
}

/// An image like that of slice i beside it, changed by `change`.
std::function<void(Images&)> added(int i, const std::function<void(SpoiledImage&)>& change) {
  return [=](Images& images) {
    SpoiledImage image = images[static_cast<std::size_t>(i)];
    image.name = "x";
    change(image);
    images.push_back(image);
  };
}

std::function<void(Images&)> both(const std::function<void(Images&)>& a,
                                  const std::function<void(Images&)>& b) {
  return [=](Images& images) {
    a(images);
    b(images);
  };
}

void each(Images& images, const std::function<void(SpoiledImage&, int)>& change) {
  for (std::size_t i = 0; i < images.size(); ++i) change(images[i], static_cast<int>(i));
}

std::string packed(const std::string& words) {
  std::string bytes;
  const auto word = [&](std::size_t i) {
    return static_cast<unsigned char>(words[2 * i]) | static_cast<unsigned char>(words[2 * i + 1]) << 8;
  };
  for (std::size_t i = 0; i + 1 < words.size() / 2; i += 2) {
    const int low = word(i) & 0xfff, high = word(i + 1) & 0xfff;
    bytes += static_cast<char>(low & 0xff);
    bytes += static_cast<char>(low >> 8 | (high & 0xf) << 4);
    bytes += static_cast<char>(high >> 4);
  }
  return bytes;
}

std::vector<std::string> names(const char* prefix, int first, int last) {
  std::vector<std::string> list;
  for (int i = first; i <= last; ++i)
    list.push_back(std::string(prefix) + (i < 10 ? "0" : "") + std::to_string(i));
  return list;
}

std::vector<SpoiledKind> of_identity() {
  return {
      {"another_patients_slice",
       "patient",
       fail,
       "another patient",
       {"a03"},
       text(0x00100020, "LO", "B", 3, 3)},
      {"another_patients_half", "patient", fail, "left out 5", names("a", 7, 11),
       text(0x00100020, "LO", "B", 7)},
      {"another_study", "study", fail, "another study", {"a05"}, text(0x0020000d, "UI", "1.9", 5, 5)},
      {"another_modality", "modality", fail, "another modality", {"a05"}, text(0x00080060, "CS", "PT", 5, 5)},
      {"another_frame_of_reference",
       "frame_of_reference",
       fail,
       "another frame of reference",
       {"a05", "a06"},
       text(0x00200052, "UI", "1.8", 5, 6)},
      {"another_issuer_of_the_patients_number",
       "patient_issuer",
       fail,
       "another issuer",
       {"a05"},
       [](std::vector<SpoiledImage>& images) {
         for (std::size_t i = 0; i < images.size(); ++i)
           images[i].text(0x00100021, "LO", i == 5 ? "HOSP B" : "HOSP A");
       }},
      {"another_birth_date",
       "patient_birth_date",
       warn,
       "another birth date",
       {"a05"},
       [](std::vector<SpoiledImage>& images) {
         for (std::size_t i = 0; i < images.size(); ++i)
           images[i].text(0x00100030, "DA", i == 5 ? "19600101" : "19500101");
       }},
      {"another_sex",
       "patient_sex",
       warn,
       "another sex",
       {"a05"},
       [](std::vector<SpoiledImage>& images) {
         for (std::size_t i = 0; i < images.size(); ++i) images[i].text(0x00100040, "CS", i == 5 ? "M" : "F");
       }},
      {"acquired_half_a_year_later",
       "acquisition_date",
       warn,
       "days lie between",
       {"a05"},
       [](std::vector<SpoiledImage>& images) {
         for (std::size_t i = 0; i < images.size(); ++i)
           images[i].text(0x00080022, "DA", i == 5 ? "20240701" : "20240101");
       }},
      {"name_spelled_differently",
       "patient_name",
       warn,
       "another name",
       {"a05"},
       text(0x00100010, "PN", "Doe^J", 5, 5)},
      {"patient_turned",
       "patient_position",
       warn,
       "FFS",
       {"a09", "a10", "a11"},
       text(0x00185100, "CS", "FFS", 9)},
      {"another_scanner", "scanner", warn, "Other", {"a00"}, text(0x00081090, "LO", "Other", 0, 0)},
  };
}

std::vector<SpoiledKind> of_stacks() {
  return {
      {"slice_of_another_kernel", "kernel", warn, "H60s", {"a04"}, text(0x00181210, "SH", "H60s", 4, 4)},
      {"half_of_another_kernel", "kernel", warn, "7 slices of 'H30s', 5 of 'H60s'", names("a", 7, 11),
       text(0x00181210, "SH", "H60s", 7)},
      {"two_kernels_at_each_place", "stacks", fail, "kernel H60s", names("b", 0, 10),
       doubled(0x00181210, "SH", "H30s", "H60s")},
      {"slice_of_another_voltage", "tube_voltage", warn, "'80'", {"a04"}, text(0x00180060, "DS", "80", 4, 4)},
      {"half_with_contrast", "contrast_agent", warn, "Iodine", names("a", 7, 11),
       text(0x00180010, "LO", "Iodine", 7)},
      {"two_acquisitions_in_turn", "acquisition", warn, "may have moved", names("a", 7, 11),
       text(0x00200012, "IS", "2", 7)},
      {"two_acquisitions_at_each_place", "stacks", fail, "acquisition 3", names("b", 0, 10),
       doubled(0x00200012, "IS", "2", "3")},
      {"an_acquisition_a_slice",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) { image.text(0x00200012, "IS", std::to_string(i)); });
       }},
      {"two_phases_at_each_place", "stacks", fail, "phase 2", names("b", 0, 10),
       doubled(0x00200100, "IS", "1", "2")},
      {"two_heart_phases_at_each_place", "stacks", fail, "phase 70", names("b", 0, 10),
       doubled(0x00209241, "DS", "30", "70")},
      {"two_echoes_at_each_place", "stacks", fail, "echo 80", names("b", 0, 10),
       doubled(0x00180081, "DS", "20", "80")},
      {"two_stacks_at_each_place", "stacks", fail, "stack B", names("b", 0, 10),
       doubled(0x00209056, "SH", "A", "B")},
      {"slice_that_is_derived",
       "image_type",
       warn,
       "DERIVED",
       {"a02"},
       text(0x00080008, "CS", "DERIVED\\SECONDARY\\MPR", 2, 2)},
      {"two_series",
       "series",
       warn,
       "choose another by --series N",
       {},
       [](Images& images) {
         Images second = sound_series(5, "b");
         each(second, [](SpoiledImage& image, int) { image.text(0x0020000e, "UI", "1.2.4"); });
         images.insert(images.end(), second.begin(), second.end());
       }},
      {"scout_view_in_the_series",
       "localizers",
       warn,
       "x",
       {"x"},
       added(4,
             [](SpoiledImage& image) {
               image.text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER");
               image.text(0x00080018, "UI", "1.2.3.77");
             })},
      {"scout_view_only",
       "localizers",
       fail,
       "scout view",
       {},
       text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\LOCALIZER")},
  };
}

std::vector<SpoiledKind> of_values() {
  return {
      {"lossy_in_all", "compression", warn, "ratio 12", names("a", 0, 11),
       both(text(0x00282110, "CS", "01"), text(0x00282112, "DS", "12"))},
      {"lossy_in_one",
       "compression",
       warn,
       "1 slice lost values",
       {"a06"},
       text(0x00282110, "CS", "01", 6, 6)},
      {"steps_of_32",
       "sample_steps",
       warn,
       "steps of 32",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.text(0x7fe00010, "OW", pixels_of(i, 1024, 32));
           image.text(0x00281053, "DS", "32");
         });
       }},
      {"slope_zero", "rescale", fail, "RescaleSlope is 0 in 12 slices", names("a", 0, 11),
       text(0x00281053, "DS", "0")},
      {"slope_zero_in_one",
       "rescale",
       fail,
       "RescaleSlope is 0 in 1 slice",
       {"a07"},
       text(0x00281053, "DS", "0", 7, 7)},
      {"slope_negative", "rescale", fail, "below 0", {"a07"}, text(0x00281053, "DS", "-1", 7, 7)},
      {"slope_beyond_single_precision",
       "unusable_images",
       fail,
       "exceed single precision",
       {"a07"},
       text(0x00281053, "DS", "1e300", 7, 7)},
      {"slope_beyond_single_precision_in_all",
       "refused",
       fail,
       "exceed single precision",
       {},
       text(0x00281053, "DS", "1e300")},
      {"intercept_beyond_single_precision",
       "unusable_images",
       fail,
       "exceed single precision",
       {"a07"},
       text(0x00281052, "DS", "-1e39", 7, 7)},
      {"intercept_lost", "air_level", fail, "not Hounsfield", {}, text(0x00281052, "DS", "0")},
      {"intercept_lost_in_one", "rescale", warn, "1 differ", {"a07"}, text(0x00281052, "DS", "0", 7, 7)},
      {"rescale_absent", "rescale", warn, "absent", {}, without({0x00281052, 0x00281053, 0x00281054})},
      {"rescale_absent_in_one",
       "rescale",
       fail,
       "absent in 1 slice",
       {"a07"},
       without({0x00281052, 0x00281053, 0x00281054}, 7, 7)},
      {"modality_absent_of_a_ct", "modality_class", warn, "absent", {}, without({0x00080060})},
      {"modality_other_of_a_ct", "modality_class", warn, "'OT'", {}, text(0x00080060, "CS", "OT")},
      {"unit_of_atomic_numbers", "rescale", warn, "'Z_EFF'", {}, text(0x00281054, "LO", "Z_EFF")},
      {"mosaic_in_one",
       "unusable_images",
       fail,
       "mosaic",
       {"a07"},
       text(0x00080008, "CS", "ORIGINAL\\PRIMARY\\MOSAIC", 7, 7)},
      {"positions_all_zero",
       "frame_positions",
       warn,
       "SliceLocation",
       {},
       [](Images& images) {
         for (std::size_t i = 0; i < images.size(); ++i) {
           images[i].text(0x00200032, "DS", "0\\0\\0");
           images[i].text(0x00201041, "DS", std::to_string(2 * i));
         }
       }},
      {"intercept_absent_in_one",
       "rescale",
       fail,
       "absent in 1 slice, where 1 or 0 is ",
       {"a07"},
       without({0x00281052}, 7, 7)},
      {"rescale_half_there", "rescale", warn, "absent", {"a07"}, without({0x00281053}, 7, 7)},
      {"unit_not_hounsfield", "rescale", warn, "'US'", {}, text(0x00281054, "LO", "US")},
      {"unit_differs_in_one", "rescale", warn, "unit", {"a02"}, text(0x00281054, "LO", "US", 2, 2)},
      {"inverted", "photometric", warn, "MONOCHROME1", {}, text(0x00280004, "CS", "MONOCHROME1")},
      {"inverted_in_one",
       "photometric",
       fail,
       "exchanged",
       {"a02"},
       text(0x00280004, "CS", "MONOCHROME1", 2, 2)},
      {"palette_in_one",
       "unusable_images",
       fail,
       "PALETTE COLOR",
       {"a02"},
       text(0x00280004, "CS", "PALETTE COLOR", 2, 2)},
      {"colour_in_one", "unusable_images", fail, "colour", {"a02"}, number(0x00280002, 3, 2, 2)},
      {"twelve_bits_in_one",
       "pixel_format",
       warn,
       "12 of 16 bits",
       {"a02"},
       both(number(0x00280101, 12, 2, 2), number(0x00280102, 11, 2, 2))},
      {"signed_in_one", "pixel_format", warn, "signed", {"a02"}, number(0x00280103, 1, 2, 2)},
      {"padded", "padding", warn, "padding value", {}, number(0x00280120, 24)},
      {"blank_slice",
       "blank_slices",
       warn,
       "one value",
       {"a06"},
       text(0x7fe00010, "OW", std::string(2 * columns * rows, '\0'), 6, 6)},
      {"slice_repeated_elsewhere",
       "repeated_slices",
       warn,
       "repeat",
       {"a06"},
       text(0x7fe00010, "OW", pixels_of(5), 6, 6)},
  };
}

std::vector<SpoiledKind> of_places() {
  return {
      {"thinner_than_apart",
       "slice_thickness",
       warn,
       "0.75 mm between them were not measured",
       {},
       text(0x00180050, "DS", "1.25")},
      {"thicker_than_apart", "slice_thickness", warn, "overlap", {}, text(0x00180050, "DS", "3")},
      {"thickness_mixed", "slice_thickness", warn, "mixed", {"a08"}, text(0x00180050, "DS", "5", 8, 8)},
      {"spacing_tag_wrong", "spacing_tag", warn, "by their positions", {}, text(0x00180088, "DS", "2.5")},
      {"size_in_one",
       "size",
       fail,
       "left 1 slice: a03",
       {"a03"},
       both(number(0x00280010, 10, 3, 3), text(0x7fe00010, "OW", std::string(2 * columns * 10, 'x'), 3, 3))},
      {"pixel_spacing_in_one",
       "size",
       fail,
       "left 1 slice: a03",
       {"a03"},
       text(0x00280030, "DS", "0.6\\0.6", 3, 3)},
      {"orientation_in_one",
       "orientation",
       fail,
       "left 1 slice: a03",
       {"a03"},
       text(0x00200037, "DS", "1\\0\\0\\0\\0\\-1", 3, 3)},
      {"half_a_millimetre_sideways", "sideways", warn, "0.5 mm to the side", {"a05"}, moved(5, 0.5, 0, 0)},
      {"far_sideways", "refused", fail, "to the side", {}, moved(5, 30, 0, 0)},
      {"tilted",
       "gantry_tilt",
       warn,
       "14.04 degrees",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) { image.place(-6, -5 + 0.5 * i, 30 + 2 * i); });
       }},
      {"tilt_tag_only", "gantry_tilt", warn, "ignored", {}, text(0x00181120, "DS", "15")},
      {"one_missing", "missing_slices", warn, "1 of 12 slices are missing", {"a04", "a06"}, removed({5})},
      {"four_missing",
       "missing_slices",
       fail,
       "8 mm were not measured",
       {"a03", "a08"},
       removed({4, 5, 6, 7})},
      {"three_gaps",
       "missing_slices",
       warn,
       "gap of 6 mm after slice 5",
       {"a01", "a03", "a05", "a08", "a09", "a11"},
       both(removed({2, 6, 7}), [](Images& images) { images.erase(images.begin() + 7); })},
      {"two_distances_tilted",
       "slice_spacing",
       warn,
       "of 2 mm, 6 of 4 mm",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           const double z = i < 6 ? 2 * i : 10 + 4 * (i - 5);
           image.place(-6, -5 + 0.2 * z, 30 + z);
         });
       }},
      {"two_distances_squeezed_seam", "slice_spacing", warn, "uneven", names("a", 6, 10),
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.place(-6, -5, 30 + (i < 6 ? 4.002 * i : 21.091 + 6.999 * (i - 6)));
         });
       }},
      {"one_off_the_lattice", "slice_spacing", warn, "off the lattice: a06", {"a06"}, moved(6, 0, 0, 0.6)},
      {"one_squeezed_in",
       "slice_spacing",
       warn,
       "off the lattice: x",
       {"x"},
       added(6,
             [](SpoiledImage& image) {
               image.place(-6, -5, 43);
               image.text(0x00080018, "UI", "1.2.3.77");
               image.text(0x7fe00010, "OW", pixels_of(6, 1030));
             })},
      {"position_of_no_place",
       "unusable_images",
       fail,
       "ImagePositionPatient is beyond 1e9 mm",
       {"a03"},
       text(0x00200032, "DS", "1e300\\0\\0", 3, 3)},
      {"orientation_of_no_direction",
       "unusable_images",
       fail,
       "not two unit vectors",
       {"a03"},
       text(0x00200037, "DS", "1e300\\0\\0\\0\\1\\0", 3, 3)},
      {"pixels_of_no_size",
       "unusable_images",
       fail,
       "PixelSpacing is not 1e-6 to 1e6 mm",
       {"a03"},
       text(0x00280030, "DS", "1e-300\\1e-300", 3, 3)},
      {"one_far_away", "refused", fail, "too scattered", {}, moved(11, 0, 0, 9e4)},
      {"single_slice",
       "slice_spacing",
       warn,
       "single slice",
       {},
       removed({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11})},
      {"spacing_at_the_detector",
       "pixel_spacing",
       warn,
       "ImagerPixelSpacing",
       {},
       both(without({0x00280030}), text(0x00181164, "DS", "0.5\\0.5"))},
      {"axes_not_perpendicular",
       "refused",
       fail,
       "perpendicular",
       {},
       text(0x00200037, "DS", "1\\0\\0\\0.5\\1\\0")},
      {"two_positions_exchanged",
       "instance_order",
       warn,
       "run against",
       {"a05"},
       both(moved(5, 0, 0, 2), moved(6, 0, 0, -2))},
      {"positions_of_acr_nema",
       "acr_nema",
       warn,
       "ACR-NEMA",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int) {
           image.text(0x00200030, "DS", image.elements[0x00200032].second);
           image.text(0x00200035, "DS", image.elements[0x00200037].second);
           image.elements.erase(0x00200032);
           image.elements.erase(0x00200037);
           image.has_preamble = false;
           image.implicit = true;
         });
       }},
  };
}

std::vector<SpoiledKind> of_files() {
  const auto cut = [](const auto& keep) { return [=](Images& images) { images[6].damage = keep; }; };
  return {
      {"stored_twice", "duplicates", warn, "stored twice", {"x"}, added(4, [](SpoiledImage&) {})},
      {"same_slice_under_a_new_identifier",
       "duplicates",
       warn,
       "under a new identifier",
       {"x"},
       added(4, [](SpoiledImage& image) { image.text(0x00080018, "UI", "1.2.3.77"); })},
      {"another_image_at_one_place",
       "duplicates",
       fail,
       "different images",
       {"x"},
       added(4,
             [](SpoiledImage& image) {
               image.text(0x00080018, "UI", "1.2.3.77");
               image.text(0x7fe00010, "OW", pixels_of(9));
             })},
      {"slice_cut_short", "damaged_files", fail, "cut short", {"a06"}, cut([](std::string bytes) {
         return bytes.substr(0, bytes.size() - 100);
       })},
      {"slice_cut_in_its_header",
       "damaged_files",
       fail,
       "cut short or damaged",
       {"a06"},
       cut([](const std::string& bytes) { return bytes.substr(0, 250); })},
      {"length_spoiled", "damaged_files", fail, "a06", {"a06"}, cut([](std::string bytes) {
         const std::size_t at = bytes.find(DicomBytes::tag(0x00100020));
         bytes.replace(at + 6, 2, "\xff\xff");
         return bytes;
       })},
      {"all_cut_short",
       "refused",
       fail,
       "cut short",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int) {
           image.damage = [](std::string bytes) { return bytes.substr(0, bytes.size() - 300); };
         });
       }},
      {"notes_and_an_empty_file",
       "stray_files",
       warn,
       "2 files",
       {"READ.ME", "empty"},
       [](Images&) {},
       {{"READ.ME", "no scan"}, {"empty", ""}}},
      {"a_report_among_the_slices",
       "stray_files",
       warn,
       "without an image",
       {"report"},
       [](Images&) {},
       {{"report", DicomBytes::file("1.2.840.10008.1.2.1", DicomBytes::element(0x00080060, "CS", "SR"))}}},
      {"slice_without_position",
       "unusable_images",
       fail,
       "ImagePositionPatient",
       {"a02"},
       without({0x00200032}, 2, 2)},
      {"slice_without_orientation",
       "unusable_images",
       fail,
       "ImageOrientationPatient",
       {"a02"},
       without({0x00200037}, 2, 2)},
      {"slice_without_spacing",
       "unusable_images",
       fail,
       "PixelSpacing",
       {"a02"},
       without({0x00280030}, 2, 2)},
      {"slice_without_pixels",
       "unusable_images",
       fail,
       "without pixels",
       {"a02"},
       without({0x7fe00010}, 2, 2)},
      {"pixels_of_odd_bits", "unusable_images", fail, "24 bits", {"a02"}, number(0x00280100, 24, 2, 2)},
      {"nothing_but_notes",
       "refused",
       fail,
       "no DICOM slice",
       {},
       [](Images& images) { images.clear(); },
       {{"READ.ME", "no scan"}}},
  };
}

/// Statements that contradict each other, and attributes that others have to replace.
std::vector<SpoiledKind> of_replacements() {
  const auto location = [](Images& images) {
    each(images,
         [](SpoiledImage& image, int i) { image.text(0x00201041, "DS", std::to_string(30 + 2 * i)); });
  };
  const auto other_series = [](const char* patient) {
    return [=](Images& images) {
      Images second = sound_series(5, "b");
      for (SpoiledImage& image : second) {
        image.text(0x0020000e, "UI", "1.2.4");
        image.text(0x00100020, "LO", patient);
      }
      images.insert(images.end(), second.begin(), second.end());
    };
  };
  return {
      {"location_for_the_position",
       "frame_positions",
       warn,
       "SliceLocation along the normal",
       {},
       both(location, without({0x00200032}))},
      {"no_position_and_no_location", "refused", warn, "--raw with --spacing", {}, without({0x00200032})},
      {"no_spacing_at_all", "refused", warn, "--raw with --spacing", {}, without({0x00280030})},
      {"spacing_of_a_scanned_film",
       "pixel_spacing",
       warn,
       "NominalScannedPixelSpacing",
       {},
       both(without({0x00280030}), text(0x00182010, "DS", "0.5\\0.5"))},
      {"bits_stored_absent", "coding", warn, "16 bits, as BitsStored is absent", names("a", 0, 11),
       without({0x00280101})},
      {"bits_that_do_not_fit",
       "refused",
       warn,
       "12 are stored and bit 5 is the highest",
       {},
       both(number(0x00280101, 12), number(0x00280102, 5))},
      {"directions_too_short",
       "orientation_length",
       warn,
       "0.98 and 0.98 long",
       {},
       text(0x00200037, "DS", "0.98\\0\\0\\0\\0.98\\0")},
      {"directions_far_too_short",
       "refused",
       warn,
       "0.7 and 0.7 long",
       {},
       text(0x00200037, "DS", "0.7\\0\\0\\0\\0.7\\0")},
      {"letters_against_the_directions", "patient_orientation", warn, "'R\\A' contradicts", names("a", 0, 11),
       text(0x00200020, "CS", "R\\A")},
      {"letters_as_the_directions", "uniform", pass, "", {}, text(0x00200020, "CS", "L\\P")},
      {"pixels_of_floating_point",
       "refused",
       warn,
       "pixels of floating point",
       {},
       text(0x7fe00008, "OW", "12345678")},
      {"explicit_called_implicit", "coding", warn, "contradict the transfer syntax", names("a", 0, 11),
       [](Images& images) {
         each(images, [](SpoiledImage& image, int) { image.syntax = "1.2.840.10008.1.2"; });
       }},
      {"implicit_called_explicit", "coding", warn, "contradict the transfer syntax", names("a", 0, 11),
       [](Images& images) { each(images, [](SpoiledImage& image, int) { image.implicit = true; }); }},
      {"a_projection", "image_kind", warn, "ImageType or FrameType MIP", names("a", 0, 11),
       text(0x00080008, "CS", "DERIVED\\SECONDARY\\MIP")},
      {"letters_in_the_pixels",
       "image_kind",
       warn,
       "BurnedInAnnotation YES",
       {"a03"},
       text(0x00280301, "CS", "YES", 3, 3)},
      {"an_animal", "image_kind", warn, "QUADRUPED", names("a", 0, 11), text(0x00102210, "CS", "QUADRUPED")},
      {"name_in_an_unknown_set", "image_kind", warn, "cannot represent the patient's name", names("a", 0, 11),
       both(text(0x00080005, "CS", "FOO_BAR 1"), text(0x00100010, "PN",
                                                      "Sch\xe4"
                                                      "del^J"))},
      {"a_series_of_another_patient",
       "series",
       warn,
       "(CT, 5 slices) of another patient",
       {},
       other_series("B")},
  };
}

std::vector<SpoiledKind> that_are_read() {
  return {
      {"twelve_bits_packed",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.number(0x00280100, 12);
           image.number(0x00280101, 12);
           image.number(0x00280102, 11);
           image.text(0x7fe00010, "OW", packed(pixels_of(i)));
         });
       }},
      {"twelve_bits_packed_big_endian",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.syntax = "1.2.840.10008.1.2.2";
           image.big_endian = true;
           image.number(0x00280100, 12);
           image.number(0x00280101, 12);
           image.number(0x00280102, 11);
           image.text(0x7fe00010, "OW", packed(pixels_of(i)));
         });
       }},
      {"big_endian",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int) {
           image.syntax = "1.2.840.10008.1.2.2";
           image.big_endian = true;
         });
       }},
      {"big_endian_with_open_pixels",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int) {
           image.syntax = "1.2.840.10008.1.2.2";
           image.big_endian = true;
           image.pixels_end = "open";
         });
       }},
      {"little_endian_with_open_pixels",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) { each(images, [](SpoiledImage& image, int) { image.pixels_end = "open"; }); }},
      {"without_value_representations",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int) {
           image.syntax = "1.2.840.10008.1.2";
           image.implicit = true;
         });
       }},
      {"without_preamble",
       "uniform",
       pass,
       "",
       {},
       [](Images& images) { each(images, [](SpoiledImage& image, int) { image.has_preamble = false; }); }},
  };
}

/// Tags whose values are noisy, rounded, spelled otherwise, or contradict each other and the pixels.
std::vector<SpoiledKind> of_statements() {
  const auto rounded_to = [](double step_mm, double gap_mm) {
    return [=](Images& images) {
      each(images, [=](SpoiledImage& image, int i) {
        image.place(-6, -5, step_mm * std::round((30 + gap_mm * i) / step_mm));
        image.text(0x00180050, "DS", decimal(gap_mm));
      });
    };
  };
  const auto swapped_columns = [](const std::string& pixels) {
    std::string turned_bytes;
    for (int y = 0; y < rows; ++y)
      for (int x = columns - 1; x >= 0; --x)
        turned_bytes += pixels.substr(2 * static_cast<std::size_t>(y * columns + x), 2);
    return turned_bytes;
  };
  return {
      {"positions_to_whole_millimetres", "slice_spacing", warn, "rounded to 1 mm", names("a", 0, 11),
       rounded_to(1.0, 1.25)},
      {"positions_that_scatter",
       "sideways",
       warn,
       "put in line",
       {"a00", "a02", "a04", "a06", "a08", "a10"},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.place(-6 + 0.1 * ((i * 3) % 4 == 0 ? 1 : (i * 3) % 4 == 2 ? -1 : 0), -5, 30 + 2 * i);
         });
       }},
      {"comma_in_the_spacing", "decimal_commas", warn, "PixelSpacing", names("a", 0, 11),
       text(0x00280030, "DS", "0,5\\0,5")},
      {"comma_in_the_intercept",
       "decimal_commas",
       warn,
       "RescaleIntercept",
       {"a03"},
       text(0x00281052, "DS", "-1024,0", 3, 3)},
      {"intercept_that_is_no_number",
       "unusable_images",
       fail,
       "RescaleIntercept '-1024;0' is not a number",
       {"a03"},
       text(0x00281052, "DS", "-1024;0", 3, 3)},
      {"aspect_against_the_spacing", "pixel_aspect", warn, "0.5 times as high", names("a", 0, 11),
       text(0x00280034, "IS", "1\\2")},
      {"values_beyond_the_stored_bits", "stored_bits", fail, "beyond the 10", names("a", 1, 10),
       both(number(0x00280101, 10), number(0x00280102, 9))},
      {"fewer_than_stated", "image_count", warn, "states 14 images", {}, text(0x00201002, "IS", "14")},
      {"two_of_three_parts",
       "concatenation",
       fail,
       "missing: 3",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.text(0x00209161, "UI", "1.2.77");
           image.number(0x00209162, static_cast<std::uint16_t>(i / 6 + 1));
           image.number(0x00209163, 3);
         });
       }},
      {"pixels_of_two_images",
       "pixel_data",
       fail,
       "pixels of 2 images",
       {"a04"},
       [](Images& images) { images[4].elements[0x7fe00010].second += pixels_of(5); }},
      {"some_bytes_more",
       "pixel_data",
       warn,
       "6 more bytes",
       {"a04"},
       [](Images& images) { images[4].elements[0x7fe00010].second += "sixsix"; }},
      {"one_mirrored",
       "mirrored_slices",
       fail,
       "1 mirrored along its rows",
       {"a04"},
       [=](Images& images) {
         each(images, [=](SpoiledImage& image, int i) {
           // A shape that no mirror leaves as it is.
           std::string pixels;
           for (int y = 0; y < rows; ++y)
             for (int x = 0; x < columns; ++x)
               pixels += DicomBytes::number(std::hypot(x - 7, y - 8, i - 5) < 6.5 ? 1424U : 24U, 2);
           image.text(0x7fe00010, "OW", i == 4 ? swapped_columns(pixels) : pixels);
         });
       }},
      {"one_of_noise",
       "unlike_slices",
       fail,
       "1 slice unlike",
       {"a04"},
       [](Images& images) {
         std::string pixels;
         for (std::uint32_t i = 0, value = 1; i < rows * columns; ++i) {
           value = value * 1664525U + 1013904223U;
           pixels += DicomBytes::number(value >> 21, 2);
         }
         images[4].text(0x7fe00010, "OW", pixels);
       }},
      {"rows_and_columns_exchanged",
       "rows_columns",
       fail,
       "Rows (24) and Columns (20)",
       {},
       both(number(0x00280010, columns), number(0x00280011, rows))},
      {"spacing_of_a_tenth",
       "plausible_size",
       warn,
       "smaller than any organ",
       {},
       text(0x00280030, "DS", "0.05\\0.05")},
      {"spacing_in_micrometres",
       "plausible_size",
       warn,
       "instead of 500 mm",
       {},
       text(0x00280030, "DS", "500\\500")},
      {"a_series_for_each_image",
       "series",
       fail,
       "--join reads all as one series",
       {},
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.text(0x0020000e, "UI", "1.2.3.4." + std::to_string(i));
         });
       }},
      {"a_frame_of_reference_for_each_image", "frame_of_reference", fail, "--join keeps all images",
       names("a", 1, 11),
       [](Images& images) {
         each(images, [](SpoiledImage& image, int i) {
           image.text(0x00200052, "UI", "1.7." + std::to_string(i + 10));
         });
       }},
      {"two_times_at_each_place", "stacks", fail, "time 2 of 2", names("b", 0, 10),
       doubled(0x00080032, "TM", "120000", "120500")},
      {"syntax_that_is_not_known",
       "unusable_images",
       fail,
       "transfer syntax 1.2.840.113619.5.2",
       {"a04"},
       [](Images& images) { images[4].syntax = "1.2.840.113619.5.2"; }},
      {"real_world_values", "real_world_values", warn, "is not applied. It would produce a table of values",
       names("a", 0, 11),
       text(0x00409096, "SQ", DicomBytes::item(DicomBytes::element(0x00409210, "SH", "PD")))},
  };
}

}  // namespace

void SpoiledImage::number(std::uint32_t tag, std::uint16_t value) {
  elements[tag] = {"US", DicomBytes::number(value, 2)};
}

void SpoiledImage::place(double x_mm, double y_mm, double z_mm) {
  text(0x00200032, "DS", decimal(x_mm) + "\\" + decimal(y_mm) + "\\" + decimal(z_mm));
}

std::string SpoiledImage::bytes() const {
  const auto wide = [&](std::uint32_t value, int count) {
    return big_endian ? big(value, count) : DicomBytes::number(value, count);
  };
  const auto tag_of = [&](std::uint32_t tag) { return wide(tag >> 16, 2) + wide(tag & 0xffff, 2); };
  std::string rest;
  for (const auto& [tag, element] : elements) {
    auto [vr, value] = element;
    if (value.size() % 2 != 0) value += vr == "UI" ? '\0' : ' ';
    if (big_endian && (vr == "US" || vr == "SS" || vr == "OW")) value = swapped(value);
    const auto length = static_cast<std::uint32_t>(value.size());
    if (tag == 0x00180050 && !open_unknown.empty())
      rest += tag_of(0x00110010) + "UN" + wide(0, 2) + wide(0xffffffff, 4) + open_unknown;
    rest += tag_of(tag);
    if (tag == 0x7fe00010 && !pixels_end.empty()) {
      // Pixels without a length, in two items after an empty offset table.
      const std::size_t half = value.size() / 4 * 2;
      rest += "OW" + wide(0, 2) + wide(0xffffffff, 4);
      for (const std::string& part : {std::string(), value.substr(0, half), value.substr(half)})
        rest += tag_of(0xfffee000) + wide(static_cast<std::uint32_t>(part.size()), 4) + part;
      rest += tag_of(0xfffee0dd) + wide(0, 4);
    } else if (implicit) {
      rest += wide(length, 4) + value;
    } else {
      const bool is_wide = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN";
      rest += vr + (is_wide ? wide(0, 2) + wide(length, 4) : wide(length, 2)) + value;
    }
  }
  const std::string whole = has_preamble ? DicomBytes::file(syntax, rest) : rest;
  return damage ? damage(whole) : whole;
}

std::vector<SpoiledImage> sound_series(int count, const std::string& prefix) {
  Images images;
  for (int k = 0; k < count; ++k) {
    SpoiledImage image;
    image.name = prefix + (k < 10 ? "0" : "") + std::to_string(k);
    const auto us = [](std::uint16_t value) {
      return std::pair{std::string("US"), DicomBytes::number(value, 2)};
    };
    image.elements = {{0x00080008, {"CS", "ORIGINAL\\PRIMARY\\AXIAL"}},
                      {0x00080016, {"UI", "1.2.840.10008.5.1.4.1.1.2"}},
                      {0x00080018, {"UI", "1.2.3." + prefix.substr(0, 0) + std::to_string(k + 1)}},
                      {0x00080060, {"CS", "CT"}},
                      {0x0008103e, {"LO", "Head"}},
                      {0x00081090, {"LO", "Scanner"}},
                      {0x00100010, {"PN", "Doe^Jane"}},
                      {0x00100020, {"LO", "A"}},
                      {0x00180050, {"DS", "2"}},
                      {0x00180060, {"DS", "120"}},
                      {0x00181210, {"SH", "H30s"}},
                      {0x00185100, {"CS", "HFS"}},
                      {0x0020000d, {"UI", "1.2"}},
                      {0x0020000e, {"UI", "1.2.3"}},
                      {0x00200013, {"IS", std::to_string(k + 1)}},
                      {0x00200037, {"DS", "1\\0\\0\\0\\1\\0"}},
                      {0x00200052, {"UI", "1.7"}},
                      {0x00280002, us(1)},
                      {0x00280004, {"CS", "MONOCHROME2"}},
                      {0x00280010, us(rows)},
                      {0x00280011, us(columns)},
                      {0x00280030, {"DS", "0.5\\0.5"}},
                      {0x00280100, us(16)},
                      {0x00280101, us(16)},
                      {0x00280102, us(15)},
                      {0x00280103, us(0)},
                      {0x00281052, {"DS", "-1024"}},
                      {0x00281053, {"DS", "1"}},
                      {0x00281054, {"LO", "HU"}},
                      {0x7fe00010, {"OW", pixels_of(k)}}};
    image.place(-6, -5, 30 + 2 * k);
    images.push_back(image);
  }
  return images;
}

void SpoiledKind::write(const std::filesystem::path& folder) const {
  std::filesystem::create_directories(folder);
  Images images = sound_series();
  spoil(images);
  const auto put = [&](const std::string& file, const std::string& bytes) {
    std::ofstream(folder / file, std::ios::binary) << bytes;
  };
  for (const SpoiledImage& image : images) put(image.name, image.bytes());
  for (const auto& [file, bytes] : others) put(file, bytes);
}

const std::vector<SpoiledKind>& spoiled_kinds() {
  static const std::vector<SpoiledKind> kinds = [] {
    std::vector<SpoiledKind> all;
    for (const auto& group : {of_identity(), of_stacks(), of_values(), of_places(), of_files(),
                              of_statements(), of_replacements(), that_are_read()})
      all.insert(all.end(), group.begin(), group.end());
    return all;
  }();
  return kinds;
}

}  // namespace octotomy::tests
