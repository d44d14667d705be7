// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/read_archived.h"

#include <array>
#include <string_view>

#include "voxel/dicom/dicom_file.h"
#include "voxel/scan/dicom_derived.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

struct Known {
  std::string_view class_uid;
  const char* kind;
};
constexpr std::string_view capture_class = "1.2.840.10008.5.1.4.1.1.7";
constexpr std::array<Known, 5> known_classes{{{"1.2.840.10008.5.1.4.1.1.104.1", "encapsulated PDF"},
                                              {"1.2.840.10008.5.1.4.1.1.104.2", "encapsulated CDA"},
                                              {"1.2.840.10008.5.1.4.1.1.104.3", "encapsulated STL"},
                                              {"1.2.840.10008.5.1.4.1.1.104.4", "encapsulated OBJ"},
                                              {capture_class, "secondary capture"}}};
constexpr DicomTag document_tag = 0x00420011, document_length_tag = 0x00420015;

std::string document_of(const DicomFile& file) {
  std::string bytes(file.value(document_tag));
  const std::size_t padded = bytes.size();
  if (padded == 0) throw Error(ErrorCode::Input, "holds no document");
  if (const auto stated = file.unsigned_long(document_length_tag)) {
    if (*stated > padded || padded - *stated > 1)
      throw Error(ErrorCode::Input, "states a document of " + std::to_string(*stated) + " bytes and holds " +
                                        std::to_string(padded));
    bytes.resize(*stated);
  }
  return bytes;
}

std::optional<ColourPixels> picture_of(const DicomFile& file) {
  if (file.unsigned_short(0x00280002) != 3) return std::nullopt;
  const auto rows = file.unsigned_short(0x00280010), columns = file.unsigned_short(0x00280011);
  const auto pixels = file.raw_pixels();
  if (!pixels || file.text(0x00280004) != "RGB" || file.unsigned_short(0x00280100) != 8 ||
      file.unsigned_short(0x00280006).value_or(0) != 0)
    throw Error(ErrorCode::Input, "its pixels are not uncompressed RGB of 8 bits");
  if (!rows || !columns || *rows == 0 || *columns == 0)
    throw Error(ErrorCode::Input, "does not state its rows and columns");
  const std::size_t count = std::size_t{3} * *rows * *columns;
  if (pixels->length < count || pixels->length - count > 1)
    throw Error(ErrorCode::Input, "holds " + std::to_string(pixels->length) + " bytes of pixels instead of " +
                                      std::to_string(count));
  const std::string_view bytes = file.at(*pixels);
  return ColourPixels{{*columns, *rows}, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)}};
}

}  // namespace

std::optional<ArchivedObject> read_archived(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) return std::nullopt;
  {
    std::ifstream in = opened(path);
    std::string head(132, '\0');
    if (!in.read(head.data(), 132) || !head.ends_with("DICM")) return std::nullopt;
  }
  try {
    const std::string bytes = whole_dicom(file_bytes(path));
    const DicomFile file(bytes, bytes.size(), true);
    ArchivedObject made;
    made.class_uid = file.text(0x00080016);
    for (const Known& each : known_classes)
      if (each.class_uid == made.class_uid) made.kind = each.kind;
    if (made.kind.empty()) return std::nullopt;
    made.patient_name = file.readable_text(0x00100010);
    made.patient_id = file.readable_text(0x00100020);
    made.study_uid = file.readable_text(0x0020000d);
    made.series_uid = file.readable_text(0x0020000e);
    made.is_identity_removed = file.text(identity_removed_tag) == "YES";
    if (made.class_uid == capture_class) {
      made.picture = picture_of(file);
      made.title = file.readable_text(0x00204000);
      if (!made.picture) return std::nullopt;  // a grey picture is an image of a scan
      return made;
    }
    made.media_type = file.readable_text(0x00420012);
    made.title = file.readable_text(0x00420010);
    // The media type is stored behind the document, so a file that is cut short lacks it.
    if (made.media_type.empty())
      throw Error(ErrorCode::Input, "does not state its document's media type: the file may be cut short");
    made.document = document_of(file);
    return made;
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "ends within its attributes: the file is cut short");
  } catch (const Error& error) {
    refuse(path, error.what(), error.code());
  }
}

}  // namespace octotomy::voxel
