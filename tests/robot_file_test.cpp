// Tests the readers of URDF and MJCF: poses, and what is replaced or left out.

#include "sim_cuda/import/robot_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RobotShapes urdf(const std::string& inside) {
  return parse_robot("<robot name=\"r\">" + inside + "</robot>", "r.urdf", FileFormat::urdf);
}
RobotShapes mjcf(const std::string& inside) {
  return parse_robot("<mujoco model=\"m\">" + inside + "</mujoco>", "m.xml", FileFormat::mjcf);
}
std::string refusal(const std::string& text, FileFormat format) {
  try {
    parse_robot(text, "file", format);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
void expect_near(const Vector3d& actual, const Vector3d& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-12) << actual.transpose() << " is not " << expected.transpose();
}

TEST(Urdf, PlacesLinksAlongTheirJoints) {
  const std::string sphere =
      "<collision><origin xyz=\"0 0 1\"/><geometry><sphere radius=\"0.5\"/></geometry></collision>";
  // The second joint comes first, and turns its child by 90 degrees about x: its z points to -y.
  const RobotShapes robot = urdf(
      "<joint type=\"fixed\"><parent link=\"b\"/><child link=\"c\"/><origin xyz=\"0 0 2\" "
      "rpy=\"1.5707963267948966 0 0\"/></joint>"
      "<joint type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><origin xyz=\"1 0 0\"/></joint>"
      "<link name=\"a\">" +
      sphere + "</link><link name=\"b\">" + sphere + "</link><link name=\"c\">" + sphere + "</link>");
  ASSERT_EQ(robot.shapes.size(), 3u);
  expect_near(robot.shapes[0].position, {0, 0, 1});
  expect_near(robot.shapes[1].position, {1, 0, 1});
  expect_near(robot.shapes[2].position, {1, -1, 2});
  EXPECT_EQ(robot.shapes[0].radius, 0.5);
  EXPECT_THAT(robot.notes, ElementsAre("1 joints, shown at their initial pose"));
  EXPECT_EQ(robot.name, "r");
}

TEST(Urdf, ReplacesShapesByTheSpheresAroundThem) {
  const RobotShapes robot = urdf(
      "<link name=\"a\"><collision><geometry><box size=\"2 3 6\"/></geometry></collision>"
      "<collision><geometry><cylinder radius=\"3\" length=\"8\"/></geometry></collision>"
      "<collision><geometry><mesh filename=\"../../etc/passwd\"/></geometry></collision></link>");
  ASSERT_EQ(robot.shapes.size(), 2u);
  EXPECT_EQ(robot.shapes[0].radius, 3.5);
  EXPECT_EQ(robot.shapes[1].radius, 5);
  EXPECT_THAT(robot.notes, ElementsAre("1 boxes as the spheres around them",
                                       "1 cylinders as the spheres around them", "1 meshes not taken"));
}

TEST(Mjcf, AppliesDefaultsAndPosesOfBodies) {
  const RobotShapes model = mjcf(
      "<default><geom size=\"0.25\"/><default class=\"big\"><geom size=\"0.5\"/></default></default>"
      "<worldbody><geom type=\"plane\" size=\"1 1 1\" pos=\"0 0 -1\"/><geom type=\"box\" size=\"1 2 3\" "
      "pos=\"0 0 5\"/>"
      "<body pos=\"1 0 0\" euler=\"0 0 90\"><freejoint/><geom pos=\"1 0 0\"/><geom class=\"big\"/>"
      "<body pos=\"2 0 0\" childclass=\"big\"><joint/><geom/></body></body></worldbody>");
  ASSERT_EQ(model.shapes.size(), 5u);
  EXPECT_EQ(model.shapes[0].kind, RobotShape::Kind::plane);
  expect_near(model.shapes[0].position, {0, 0, -1});
  EXPECT_EQ(model.shapes[1].kind, RobotShape::Kind::box);
  expect_near(model.shapes[1].size, {2, 4, 6});
  EXPECT_TRUE(model.shapes[1].fixed);
  expect_near(model.shapes[2].position, {1, 1, 0});
  EXPECT_EQ(model.shapes[2].radius, 0.25);
  EXPECT_FALSE(model.shapes[2].fixed);
  EXPECT_EQ(model.shapes[3].radius, 0.5);
  expect_near(model.shapes[4].position, {1, 2, 0});
  EXPECT_EQ(model.shapes[4].radius, 0.5);
  EXPECT_THAT(model.notes, ElementsAre("1 joints, shown at their initial pose"));
}

TEST(Mjcf, ReadsEveryFormOfOrientation) {
  const auto x_axis = [&](const std::string& orientation, const std::string& before = "") {
    const RobotShapes model = mjcf(before + "<worldbody><body " + orientation +
                                   "><geom size=\"1\" pos=\"1 0 0\"/></body></worldbody>");
    return model.shapes.at(0).position;
  };
  const std::string radian = "<compiler angle=\"radian\"/>";
  expect_near(x_axis("quat=\"1 0 0 1\""), {0, 1, 0});
  expect_near(x_axis("axisangle=\"0 0 2 90\""), {0, 1, 0});
  expect_near(x_axis("axisangle=\"0 0 2 1.5707963267948966\"", radian), {0, 1, 0});
  expect_near(x_axis("euler=\"90 0 90\""), {0, 0, 1});  // about x, then about the new z
  expect_near(x_axis("euler=\"90 0 90\"", "<compiler eulerseq=\"XYZ\"/>"), {0, 1, 0});  // about fixed axes
  expect_near(x_axis("xyaxes=\"0 1 0 -1 0 0\""), {0, 1, 0});
  expect_near(x_axis("zaxis=\"1 0 0\""), {0, 0, -1});
  expect_near(x_axis("zaxis=\"0 0 3\""), {1, 0, 0});
}

TEST(Mjcf, CountsWhatItReplacesOrLeavesOut) {
  const RobotShapes model = mjcf(
      "<include file=\"/etc/passwd\"/><worldbody><body><geom type=\"capsule\" fromto=\"0 0 0 0 0 2\" "
      "size=\"0.5\"/>"
      "<geom type=\"cylinder\" size=\"3 4\"/><geom type=\"ellipsoid\" size=\"1 3 2\"/><geom type=\"mesh\" "
      "mesh=\"m\"/>"
      "<geom mesh=\"m\"/><geom type=\"hfield\" hfield=\"h\"/></body></worldbody>");
  ASSERT_EQ(model.shapes.size(), 3u);
  expect_near(model.shapes[0].position, {0, 0, 1});
  EXPECT_EQ(model.shapes[0].radius, 1.5);
  EXPECT_EQ(model.shapes[1].radius, 5);
  EXPECT_EQ(model.shapes[2].radius, 3);
  EXPECT_THAT(model.notes,
              ElementsAre("1 capsules as the spheres around them", "1 cylinders as the spheres around them",
                          "1 ellipsoids as the spheres around them", "1 height fields not taken",
                          "1 included files", "2 meshes not taken"));
}

TEST(RobotFiles, NameThePlaceOfAFault) {
  const FileFormat urdf_format = FileFormat::urdf, mjcf_format = FileFormat::mjcf;
  EXPECT_THAT(refusal("<robot>\n<link name=\"a\">", urdf_format), HasSubstr("file:2:"));
  EXPECT_EQ(refusal("<robot>\n <joint><parent link=\"a\"/><child link=\"b\"/></joint></robot>", urdf_format),
            "file:2:3: a joint of an unknown link, expected the names of two links");
  EXPECT_THAT(
      refusal(
          "<robot><link name=\"a\"/><link name=\"b\"/><joint><parent link=\"a\"/><child link=\"b\"/></joint>"
          "<joint><parent link=\"b\"/><child link=\"a\"/></joint></robot>",
          urdf_format),
      HasSubstr("a loop of joints, expected a tree of links"));
  EXPECT_EQ(refusal("<mujoco>\n<worldbody>\n  <geom size=\"-1\"/></worldbody></mujoco>", mjcf_format),
            "file:3:4: radius = -1, expected 1e-09 to 1e+09 m");
  EXPECT_EQ(refusal("<mujoco><worldbody><geom size=\"1 b\"/></worldbody></mujoco>", mjcf_format),
            "file:1:21: damaged size, expected 1 to 3 numbers");
  EXPECT_EQ(refusal("<mujoco/>", mjcf_format),
            "file: no spheres, boxes, cylinders or capsules, expected one");
  std::string deep = "<mujoco><worldbody>";
  for (int k = 0; k < 2000; ++k) deep += "<body>";
  for (int k = 0; k < 2000; ++k) deep += "</body>";
  EXPECT_THAT(refusal(deep + "</worldbody></mujoco>", mjcf_format),
              HasSubstr("elements are nested too deeply"));
}

}  // namespace
}  // namespace collidoscope
