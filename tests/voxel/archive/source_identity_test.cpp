// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/source_identity.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "voxel/scan/dicom_derived.h"

namespace octotomy::voxel {
namespace {

DicomSource source() {
  DicomSource made;
  made.attributes = {{character_set_tag, {"CS", "ISO_IR 100"}},
                     {0x00080020, {"DA", "20240203"}},
                     {0x00081030, {"LO", "Jane before her wedding"}},
                     {0x00100010, {"PN", "Doe^Jane"}},
                     {0x00180015, {"CS", "HEAD"}},
                     {0x00180020, {"CS", "SE\\JANE"}},
                     {0x00180080, {"DS", "500 \\ 1.5"}},
                     {0x00180081, {"DS", "Jane"}},
                     {0x0020000d, {"UI", "1.2.3"}},
                     {0x00200052, {"UI", "1.2.4"}},
                     {0x00201040, {"LO", "Jane's nose"}}};
  made.identity.patient_name = "Doe^Jane";
  made.series_uid = "1.2.5";
  made.modality = "CT";
  made.images = {{"1.2.840", "1.2.6#1", 0.0}, {"1.2.840", "1.2.6#2", 1.0}, {"1.2.840", "1.2.7", 2.0}};
  return made;
}

TEST(SourceIdentity, KeepChangesNothing) {
  const DecidedIdentity kept = decide_identity(source(), IdentityChoice::Keep);
  EXPECT_TRUE(kept.changes.empty());
  EXPECT_EQ(kept.source->attributes.size(), source().attributes.size());
  EXPECT_EQ(kept.source->attributes.at(0x00100010).value, "Doe^Jane");
  EXPECT_FALSE(decide_identity(std::nullopt, IdentityChoice::Remove).source);
}

TEST(SourceIdentity, RemoveFollowsTheProfileAndListsWhatItChanged) {
  const DecidedIdentity made = decide_identity(source(), IdentityChoice::Remove);
  const auto& left = made.source->attributes;
  EXPECT_EQ(left.at(0x00100010).value, "");
  EXPECT_EQ(left.at(0x00080020).value, "");
  EXPECT_FALSE(left.contains(0x00081030));
  EXPECT_FALSE(left.contains(0x00201040)) << "free text, although the profile keeps it";
  EXPECT_EQ(left.at(0x00180015).value, "HEAD");
  EXPECT_FALSE(left.contains(0x00180020)) << "one of its words is not the standard's";
  EXPECT_EQ(left.at(0x00180080).value, "500 \\ 1.5");
  EXPECT_EQ(left.at(0x00180081).value, "");
  EXPECT_EQ(left.at(identity_removed_tag).value, "YES");
  EXPECT_EQ(made.source->identity.patient_name, "");
  EXPECT_NE(std::find(made.changes.begin(), made.changes.end(), "Patient's Name (0010,0010): emptied"),
            made.changes.end());
  for (const std::string& change : made.changes) EXPECT_EQ(change.find("Jane"), std::string::npos) << change;
}

TEST(SourceIdentity, EqualIdentifiersBecomeEqualOnesAndOtherChoicesOthers) {
  const DicomSource removed = *decide_identity(source(), IdentityChoice::Remove).source;
  const DicomSource again = *decide_identity(source(), IdentityChoice::Remove).source;
  const DicomSource other = *decide_identity(source(), IdentityChoice::New).source;
  for (const DicomTag tag : {0x0020000du, 0x00200052u}) {
    EXPECT_EQ(removed.attributes.at(tag).value, again.attributes.at(tag).value);
    EXPECT_NE(removed.attributes.at(tag).value, source().attributes.at(tag).value);
    EXPECT_NE(removed.attributes.at(tag).value, other.attributes.at(tag).value);
  }
  // Frames of one file stay frames of one file.
  const auto file = [](const DicomSource::Image& image) {
    return image.instance_uid.substr(0, image.instance_uid.find('#'));
  };
  EXPECT_EQ(file(removed.images[0]), file(removed.images[1]));
  EXPECT_NE(file(removed.images[0]), file(removed.images[2]));
  EXPECT_TRUE(removed.images[1].instance_uid.ends_with("#2"));
  EXPECT_EQ(removed.images[1].height_mm, 1.0);
}

TEST(SourceIdentity, ANewPatientIsNoPatientWithoutAnIdentity) {
  const DicomSource made = *decide_identity(source(), IdentityChoice::New).source;
  EXPECT_EQ(made.attributes.at(0x00100010).value, "Anonymous");
  EXPECT_FALSE(made.attributes.contains(identity_removed_tag));
}

TEST(SourceIdentity, WordsNameTheChoices) {
  for (const IdentityChoice choice : {IdentityChoice::Keep, IdentityChoice::Remove, IdentityChoice::New})
    EXPECT_EQ(identity_choice(word_of(choice)), choice);
  EXPECT_FALSE(identity_choice("none"));
  EXPECT_EQ(defined_modality("MR"), "MR");
  EXPECT_EQ(defined_modality("JANE"), "");
}

}  // namespace
}  // namespace octotomy::voxel
