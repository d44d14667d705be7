// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_file.h"

// Values, identifiers, attributes and file headers for the writers of DICOM files.

namespace octotomy::voxel {

/// A number as DICOM's decimal string (VR DS), with all digits that fit into its 16 characters.
std::string dicom_decimal(double number);
std::string dicom_decimals(const glm::dvec3& p);

/// Throws std::invalid_argument with the option's name `name` if the text is longer than the 64 characters of
/// DICOM's LO or contains a backslash, which separates values.
void check_dicom_text(const std::string& text, const char* name);

/// A 128-bit digest of content: two FNV-1a hash sums with different start values. Equal content produces
/// equal unique identifiers. Not cryptographically secure.
class DicomDigest {
 public:
  void add(const void* bytes, std::size_t count);
  void add(const std::string& text) { add(text.data(), text.size() + 1); }

  /// An identifier of the form 2.25.<UUID as an integer>, a UUID of version 8 (RFC 9562).
  std::string uid() const;
  /// The identifier of the content followed by a further text.
  std::string uid(const std::string& text) const;

 private:
  std::uint64_t high_ = 0xcbf29ce484222325;
  std::uint64_t low_ = 0x84222325cbf29ce4;
};

/// A data set whose attributes are written in ascending order, little-endian, with explicit or implicit VR;
/// sequences and items with their lengths (DICOM PS3.5, 7.1 and 7.5). Texts of more than 64 KB require
/// implicit VR.
class DicomAttributes {
 public:
  enum class Coding { ExplicitVr, ImplicitVr };
  explicit DicomAttributes(Coding coding = Coding::ExplicitVr) : coding_(coding) {}
  Coding coding() const { return coding_; }

  /// Replaces an attribute's value. Pads an odd length with a space, or with zero for UI and OB.
  /// Precondition: the value has at most 2^32 - 2 bytes; with explicit VR at most 65534 for VRs other than
  /// OB, OW and SQ.
  void put(DicomTag tag, const char* vr, std::string value);
  void put_short(DicomTag tag, std::uint16_t number);                ///< US
  void put_longs(DicomTag tag, std::vector<std::uint32_t> numbers);  ///< UL
  void put_tag(DicomTag tag, DicomTag named);                        ///< AT
  /// Precondition: the items have the coding of these attributes.
  void put_sequence(DicomTag tag, const std::vector<DicomAttributes>& items);
  void remove(DicomTag tag) { values_.erase(tag); }

  /// The value as stored, with its padding. Precondition: the attribute exists.
  const std::string& value(DicomTag tag) const { return values_.at(tag).bytes; }
  void write(std::ostream& out) const;

 private:
  struct Value {
    std::string vr;
    std::string bytes;
  };
  std::map<DicomTag, Value> values_;
  Coding coding_;
};

/// One item of a code sequence, such as SNOMED's 85756007 "Tissue" (PS3.3, 8.8).
DicomAttributes dicom_code(const char* value, const char* scheme, const char* meaning);

/// Writes a DICOM file with one object (PS3.10, 7.1). Precondition: the attributes contain its class
/// (0008,0016) and identifier (0008,0018). Their coding determines the file's transfer syntax. Error messages
/// refer to the file as `name`. Throws Error (Resource).
void write_dicom_file(const std::filesystem::path& path, const std::filesystem::path& name,
                      const DicomAttributes& attributes);

}  // namespace octotomy::voxel
