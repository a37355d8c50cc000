// Tests the OBJ mesh reader and its mass properties against closed forms, and one message per fault with its
// line.
#include "sim_cuda/scene/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

const std::string tetrahedron = "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 7\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

Mesh parse(const std::string& text) { return parse_mesh(text, "m.obj", "m"); }

std::vector<std::string> faults_of(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.lines();
  }
  return {};
}

TEST(Mesh, IsMovedToItsCentreAndPrincipalAxes) {
  const Mesh mesh = parse(tetrahedron);
  EXPECT_NEAR(mesh.volume, 7, 1e-14);
  EXPECT_TRUE(mesh.center.isApprox(Vector3d(0.5, 0.75, 1.75), 1e-14));
  const Vector3d corners[] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 7}};
  double farthest = 0;
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE((mesh.axes * mesh.vertices[i] + mesh.center).isApprox(corners[i], 1e-14) || i == 0);
    farthest = std::max(farthest, (corners[i] - mesh.center).norm());
  }
  EXPECT_NEAR((mesh.axes * mesh.vertices[0] + mesh.center).norm(), 0, 1e-14);
  EXPECT_NEAR(mesh.bounding_radius, farthest, 1e-14);
  EXPECT_LE(mesh.inertia_per_density[0], mesh.inertia_per_density[1]);
  EXPECT_LE(mesh.inertia_per_density[1], mesh.inertia_per_density[2]);
  EXPECT_NEAR(mesh.inertia_per_density.sum(), 7.0 * 6 * (4 + 9 + 49) / 80, 1e-12);  // the trace is invariant
}

TEST(Mesh, AllFormsOfFacesMeanTheSame) {
  const Mesh plain = parse(tetrahedron);
  const std::string forms =
      "# comment\r\nmtllib a.mtl\no thing\nv 0 0 0 1\nv +2 0 0\nv 0 3. 0 0.5 0.5 0.5\nv\t0 0 7e0 # top\nvt 0 "
      "0\n"
      "vn 0 0 1\ng x\ns off\nusemtl red\n\n  f 1/1 3/1 2/1\nf 1//1 2//1 4//1\nf 1/1/1 4/1/1 3/1/1\nf -3 -2 "
      "-1";
  const Mesh other = parse(forms);
  ASSERT_EQ(other.faces, plain.faces);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(other.vertices[i], plain.vertices[i]);
  EXPECT_EQ(other.volume, plain.volume);
}

/// The tetrahedron's faces, as corners.
std::vector<std::array<Vector3d, 3>> facets() {
  const Vector3d o(0, 0, 0), a(2, 0, 0), b(0, 3, 0), c(0, 0, 7);
  return {{o, b, a}, {o, a, c}, {o, c, b}, {a, b, c}};
}
void expect_tetrahedron(const std::string& text) {
  const Mesh mesh = parse(text), plain = parse(tetrahedron);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.faces.size(), 4u);
  EXPECT_NEAR(mesh.volume, plain.volume, 1e-14);
  EXPECT_TRUE(mesh.center.isApprox(plain.center, 1e-14));
  EXPECT_TRUE(mesh.inertia_per_density.isApprox(plain.inertia_per_density, 1e-13));
}
template <class Number>
std::string bytes_of(Number number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}
std::string binary_stl() {
  std::string text(80, ' ');
  text += bytes_of(std::uint32_t{4});
  for (const auto& facet : facets()) {
    text += std::string(12, '\0');
    for (const Vector3d& corner : facet)
      for (int k = 0; k < 3; ++k) text += bytes_of(static_cast<float>(corner[k]));
    text += std::string(2, '\0');
  }
  return text;
}
std::string text_stl() {
  std::string text = "solid a name\n";
  for (const auto& facet : facets()) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const Vector3d& corner : facet)
      text += "   vertex " + std::to_string(corner.x()) + " " + std::to_string(corner.y()) + " " +
              std::to_string(corner.z()) + "\n";
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid a name\n";
}

TEST(Mesh, OfStlIsTheSame) {
  expect_tetrahedron(binary_stl());
  expect_tetrahedron(text_stl());
}

TEST(Mesh, OfPlyIsTheSame) {
  const std::string header =
      "element vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 4\n"
      "property list uchar int vertex_indices\nproperty uchar flag\nend_header\n";
  expect_tetrahedron("ply\nformat ascii 1.0\n" + header +
                     "0 0 0\n2 0 0\n0 3 0\n0 0 7\n3 0 2 1 9\n3 0 1 3 9\n3 0 3 2 9\n3 1 2 3 9\n");
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
  for (const double x : {0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 7}) binary += bytes_of(x);
  for (const auto& face : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    binary += '\3';
    for (const int index : face) binary += bytes_of(index);
    binary += '\0';
  }
  expect_tetrahedron(binary);
}

TEST(Mesh, FaultsOfStlAndPlyNameTheFacet) {
  std::string open = binary_stl();
  open.resize(open.size() - 50);
  open[80] = 3;
  EXPECT_THAT(faults_of(open)[0],
              testing::HasSubstr("m.obj: facet 1: the edge from vertex 2 to 3 belongs only to this face"));
  const std::string text = text_stl();
  EXPECT_EQ(faults_of(text.substr(0, text.find("endloop", 200)))[0],
            "m.obj:7:1: the edge from vertex 1 to 2 belongs only to this face, so the surface is open; close "
            "it (vertices "
            "at the same position must be merged)");
  std::string bad = text;
  bad.replace(bad.find("vertex 0"), 8, "vertex a");
  EXPECT_EQ(faults_of(bad)[0],
            "m.obj:4:1: damaged vertex, expected three lines `vertex x y z` between outer loop and endloop");
  EXPECT_EQ(faults_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 1\n"
                      "property list uchar int vertex_indices\nend_header\n1\n3 0 0 0\n")[0],
            "m.obj: byte 129: a face with the same vertex twice, expected each vertex once");
  EXPECT_THAT(faults_of("ply\nformat ascii 1.0\nelement vertex 9999\nproperty float x\nend_header\n1\n")[0],
              testing::HasSubstr("9999 elements vertex, expected a longer file"));
}

TEST(Mesh, PolygonsAreFanned) {
  const Mesh block = read_mesh(project_file("assets/scenes/meshes/l_block.obj").string(), "l");
  EXPECT_EQ(block.faces.size(), 20u);
  EXPECT_NEAR(block.volume, 4, 1e-14);
  // A bar of 3 x 1 x 1 about (1.5, 0.5, 0.5) and a cube about (0.5, 0.5, 1.5), by the parallel axis theorem.
  EXPECT_TRUE(block.center.isApprox(Vector3d(1.25, 0.5, 0.75), 1e-14));
  const double along_y = 3 * (10.0 / 12 + 0.25 * 0.25 + 0.25 * 0.25) + (2.0 / 12 + 0.75 * 0.75 + 0.75 * 0.75);
  EXPECT_NEAR(block.inertia_per_density[2], along_y, 1e-13);
}

TEST(Mesh, IcosahedronIsRegular) {
  const Mesh mesh = read_mesh(project_file("assets/scenes/meshes/icosahedron.obj").string(), "i");
  const double edge = 1.5 / 0.9510565162951535;  // circumradius over sin(2 pi / 5)
  EXPECT_NEAR(mesh.volume, 2.1816949906249123 * edge * edge * edge, 1e-7);
  // I = m edge^2 phi^2 / 10 for the solid
  const double phi = 1.618033988749895;
  EXPECT_NEAR(mesh.inertia_per_density[0], mesh.volume * edge * edge * phi * phi / 10, 1e-7);
  EXPECT_NEAR(mesh.bounding_radius, 1.5, 1e-8);
}

struct MeshFault {
  const char* text;
  const char* line;
};

class BadMesh : public testing::TestWithParam<MeshFault> {};

TEST_P(BadMesh, IsRefusedWithItsPosition) {
  const std::vector<std::string> faults = faults_of(GetParam().text);
  ASSERT_FALSE(faults.empty());
  EXPECT_THAT(faults[0], testing::StartsWith(GetParam().line));
}

#define CORNERS "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 7\n"
INSTANTIATE_TEST_SUITE_P(
    Table, BadMesh,
    testing::Values(
        MeshFault{"", "m.obj: there are no faces"},
        MeshFault{"v 0 0\n", "m.obj:1:1: 2 numbers; expected `v x y z`"},
        MeshFault{"v 0 0 x\n", "m.obj:1:7: \"x\" is not a number"},
        MeshFault{"v 0 nan 0\n", "m.obj:1:5: \"nan\" is not a number"},
        MeshFault{"v 0 1e999 0\n", "m.obj:1:5: \"1e999\" is not a number"},
        MeshFault{"v 0 0 2e9\n", "m.obj:1:7: 2000000000 is out of range"},
        MeshFault{"v 0 0 0 2\n", "m.obj:1:1: a vertex with a weight other than 1"},
        MeshFault{"v 0 0 0 1 1 1 1 1\n", "m.obj:1:17: a vertex has at most 7 numbers"},
        MeshFault{"# fine\n  q 1 2\n", "m.obj:2:3: unsupported keyword \"q\""},
        MeshFault{CORNERS "f 1 2\n", "m.obj:5:1: a face with 2 corners"},
        MeshFault{CORNERS "f 1 2 0\n", "m.obj:5:7: \"0\" is not a vertex index"},
        MeshFault{CORNERS "f 1 2 -5\n", "m.obj:5:7: \"-5\" is not a vertex index"},
        MeshFault{CORNERS "f 1 2 3/x\n", "m.obj:5:7: \"3/x\" is not a vertex index"},
        MeshFault{CORNERS "f 1 2 3/1/\n", "m.obj:5:7: \"3/1/\" is not a vertex index"},
        MeshFault{CORNERS "f 1 2 3/1/1/1\n", "m.obj:5:7: \"3/1/1/1\" is not a vertex index"},
        MeshFault{CORNERS "f 1 2 99999999999999999999\n",
                  "m.obj:5:7: \"99999999999999999999\" is not a vertex index"},
        MeshFault{CORNERS "f 1 2 9\n", "m.obj:5:1: the face uses vertex 9, but the number of vertices is 4"},
        MeshFault{CORNERS "f 1 2 2\n", "m.obj:5:7: vertex 2 appears twice in one face"},
        MeshFault{CORNERS "f 1 3 2\nf 1 2 4\nf 1 4 3\n",
                  "m.obj:5:1: the edge from vertex 3 to 2 belongs only to this face, so the surface is open"},
        MeshFault{CORNERS "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 4 3\n",
                  "m.obj:5:1: the edge from vertex 3 to 2 has the same direction in the face of line 8"},
        MeshFault{CORNERS "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 3\n",
                  "m.obj:5:1: the edge from vertex 2 to 1 belongs to 3 faces"},
        MeshFault{CORNERS "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n",
                  "m.obj: the faces are clockwise seen from outside"},
        MeshFault{CORNERS "f 1 2 3\nf 3 2 1\n", "m.obj: the surface encloses no volume"},
        MeshFault{
            "v 5 0 0\nv 3 0 0\nv 3 0 1\nv 1 0 1\nv 1 0 6\nv 0 0 2\nv 0 1 0\nv 3 1 0\nv 3 1 1\nv 1 1 1\nv 1 1 "
            "2\n"
            "v 0 1 2\nf 1 2 3 4\nf 1 4 5 6\nf 10 9 8 7\nf 12 11 10 7\nf 2 1 7 8\nf 3 2 8 9\nf 4 3 9 10\nf 5 "
            "4 10 11\n"
            "f 6 5 11 12\nf 1 6 12 7\n",
            "m.obj: the surface intersects itself"},
        MeshFault{"v 0 0 0\nv 2e-12 0 0\nv 0 3e-12 0\nv 0 0 7e-12\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
                  "m.obj: the mesh's bounding sphere has a radius of"}));

TEST(Mesh, AllFaultsAreListed) {
  EXPECT_EQ(faults_of("v a 0 0\nv 0 b 0\nz\n").size(), 3u);
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "z\n";
  EXPECT_EQ(faults_of(many).size(), 100u);  // the limit of listed faults
}

TEST(Mesh, MissingFileAndFolder) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_mesh((folder / "none.obj").string(), "n"), InputError);
  try {
    read_mesh(folder.path().string(), "n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("is a folder; give the path of a closed mesh (OBJ, STL or PLY)"));
  }
}

}  // namespace
}  // namespace collidoscope
