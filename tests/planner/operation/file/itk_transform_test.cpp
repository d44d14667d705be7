// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/itk_transform.h"

#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

const std::string transform_head = "#Insight Transform File V1.0\n#Transform 0\n";

class ItkTransform : public testing::Test {
 protected:
  glm::dmat4 read(const std::string& text) const {
    std::ofstream(folder_ / "a.tfm", std::ios::binary) << text;
    return read_itk_transform(folder_ / "a.tfm").moved_from_still;
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  tests::ScratchFolder folder_;
};

/// The file's map: from after the motion to before.
void expect_brings(const glm::dmat4& moved_from_still, const glm::dvec3& after_mm,
                   const glm::dvec3& before_mm) {
  const glm::dvec3 found(moved_from_still * glm::dvec4(before_mm, 1.0));
  EXPECT_LT(glm::distance(found, after_mm), 1e-12) << found.x << " " << found.y << " " << found.z;
}

TEST_F(ItkTransform, AMotionComesBackFromItsText) {
  for (int i = 0; i < 50; ++i) {
    glm::dmat4 motion = glm::rotate(glm::dmat4(1.0), 0.37 * i, glm::normalize(glm::dvec3(1, 0.1 * i, -2)));
    motion[3] = glm::dvec4(3.125 * i, -100.0 / 3.0, 0.1 * i * i, 1.0);
    const glm::dmat4 back = read(itk_transform_text(motion));
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row)
        EXPECT_NEAR(back[column][row], motion[column][row], 1e-12) << "motion " << i;
  }
  const glm::dmat4 shift = glm::translate(glm::dmat4(1.0), glm::dvec3(0.1, -6, 1.0 / 3.0));
  EXPECT_EQ(read(itk_transform_text(shift)), shift) << "a translation keeps its bits";
}

TEST_F(ItkTransform, AMotionComesBackFromItsHdf5AsFromItsText) {
  glm::dmat4 motion = glm::rotate(glm::dmat4(1.0), 0.37, glm::normalize(glm::dvec3(1, 0.1, -2)));
  motion[3] = glm::dvec4(3.125, -100.0 / 3.0, 0.1, 1.0);
  const std::string bytes = itk_transform_hdf5(motion);
  std::ofstream(folder_ / "a.h5", std::ios::binary) << bytes;
  EXPECT_EQ(read_itk_transform(folder_ / "a.h5").moved_from_still, read(itk_transform_text(motion)));
  // The bytes decide, not the name.
  EXPECT_EQ(read(bytes), read(itk_transform_text(motion)));
  const auto said = [&](const std::string& spoiled) { return refusal(spoiled); };
  EXPECT_NE(said(bytes.substr(0, bytes.size() / 2)).find("a.tfm: "), std::string::npos);
  std::string other = bytes;
  other.replace(other.find("TransformGroup"), 14, "TransformGrOup");
  EXPECT_NE(said(other).find("not a file of ITK's transforms"), std::string::npos);
  other = bytes;
  other.replace(other.find("AffineTransform_double_3_3"), 26, "BSplineTransf._double_3_3 ");
  EXPECT_NE(said(other).find("cannot be read, because it is not linear: save a linear transform"),
            std::string::npos)
      << said(other);
  EXPECT_NE(said(bytes + std::string(1 << 20, 'x')).find("larger than any file of a linear transform"),
            std::string::npos);
}

TEST_F(ItkTransform, EachKindMapsAsItkDoes) {
  // x -> turn (x - centre) + centre + shift: a quarter turn about z takes x to y.
  const std::string affine = transform_head +
                             "Transform: AffineTransform_double_3_3\nParameters: 0 -1 0 1 0 0 0 0 1 1 2 3\n"
                             "FixedParameters: 10 20 30\n";
  expect_brings(read(affine), {15, 20, 30}, {11, 27, 33});
  const std::string quarter = "1.5707963267948966";
  expect_brings(read(transform_head + "Transform: Euler3DTransform_double_3_3\nParameters: 0 0 " + quarter +
                     " 1 2 3\nFixedParameters: 10 20 30 0\n"),
                {15, 20, 30}, {11, 27, 33});
  // The turns about x and y in either order: RotZ RotX RotY, and with a fourth fixed number RotZ RotY RotX.
  const std::string both = transform_head + "Transform: Euler3DTransform_double_3_3\nParameters: " + quarter +
                           " " + quarter + " 0 0 0 0\n";
  expect_brings(read(both + "FixedParameters: 0 0 0 0\n"), {1, 0, 0}, {0, 1, 0});
  expect_brings(read(both + "FixedParameters: 0 0 0 1\n"), {1, 0, 0}, {0, 0, -1});
  expect_brings(
      read(transform_head +
           "Transform: VersorRigid3DTransform_double_3_3\nParameters: 0 0 0.7071067811865476 1 2 3\n"
           "FixedParameters: 10 20 30\n"),
      {15, 20, 30}, {11, 27, 33});
  expect_brings(
      read(transform_head +
           "Transform: TranslationTransform_double_3_3\r\nParameters: 1 2 3\r\nFixedParameters:\r\n"),
      {0, 0, 0}, {1, 2, 3});
  EXPECT_EQ(read(transform_head + "Transform: IdentityTransform_double_3_3\nParameters:\nFixedParameters:\n"),
            glm::dmat4(1.0));
}

TEST_F(ItkTransform, TheLastOfACompositeIsAppliedFirst) {
  expect_brings(read(transform_head +
                     "Transform: CompositeTransform_double_3_3\n#Transform 1\nTransform: "
                     "TranslationTransform_double_3_3\nParameters: 10 0 0\nFixedParameters:\n#Transform 2\n"
                     "Transform: MatrixOffsetTransformBase_float_3_3\nParameters: 0 -1 0 1 0 0 0 0 1 0 0 5\n"
                     "FixedParameters: 0 0 0\n"),
                {1, 0, 0}, {10, 1, 5});
}

TEST_F(ItkTransform, RefusalsNameTheLineAndTheCause) {
  EXPECT_NE(refusal("1 0 0 0").find("a.tfm: is not a transform of ITK"), std::string::npos);
  EXPECT_NE(refusal("").find("holds no transform"), std::string::npos);
  EXPECT_NE(refusal(transform_head + "Parameters: 1\n").find("line 3: 'Parameters' is none of"),
            std::string::npos);
  EXPECT_NE(refusal(transform_head + "Transform: BSplineTransform_double_3_3\nParameters: 1\n")
                .find("line 3: 'BSplineTransform' cannot be read"),
            std::string::npos);
  EXPECT_NE(refusal(transform_head + "Transform: AffineTransform_double_2_2\n")
                .find("name must end in _double_3_3"),
            std::string::npos);
  EXPECT_NE(refusal(transform_head + "Transform: AffineTransform_double_3_3\nParameters: 1 0 x\n")
                .find("line 4: 'x' is not a finite"),
            std::string::npos);
  EXPECT_NE(refusal(transform_head + "Transform: AffineTransform_double_3_3\nParameters: 1 0\n")
                .find("has 2 parameters: it takes 12"),
            std::string::npos);
  EXPECT_NE(
      refusal(transform_head + "Transform: VersorRigid3DTransform_double_3_3\nParameters: 1 1 0 0 0 0\n")
          .find("longer than 1"),
      std::string::npos);
  EXPECT_NE(refusal(transform_head + "Transform: CompositeTransform_double_3_3\n")
                .find("composite transform without parts"),
            std::string::npos);
  EXPECT_THROW(read_itk_transform(folder_ / "none.tfm"), std::runtime_error);
  EXPECT_THROW(read_itk_transform(folder_.path()), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
