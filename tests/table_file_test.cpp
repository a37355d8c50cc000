// Tests the readers of tables of bodies: layouts, and the place of each fault.

#include "sim_cuda/import/table_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sim_cuda/core/error.h"
#include "tests/npy_file.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Tables : public testing::Test {
 protected:
  std::string written(const std::string& text) {
    std::ofstream(folder_ / "file", std::ios::binary) << text;
    return folder_ / "file";
  }
  BodyTable read(const std::string& text, const std::string& columns = "", double scale = 1,
                 std::int64_t frame = 0) {
    const std::string file = written(text);
    return read_body_table(file, format_of(file), {parse_column_map(columns, "--columns"), scale, frame});
  }
  /// The message without the path.
  std::string refusal(const std::string& text, const std::string& columns = "", std::int64_t frame = 0) {
    try {
      read(text, columns, 1, frame);
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string path = folder_ / "file";
      if (message.starts_with(path)) message.erase(0, path.size());
      return message;
    }
    return "";
  }
  /// x, y, z of each row.
  static std::vector<std::vector<double>> positions(const BodyTable& table) {
    std::vector<std::vector<double>> all;
    for (const Vector3d& x : table.position) all.push_back({x.x(), x.y(), x.z()});
    return all;
  }

  TemporaryFolder folder_;
};
using Rows = std::vector<std::vector<double>>;

TEST_F(Tables, OfTextHaveAnySeparatorAndNamesOrNone) {
  const Rows expected{{1, 2, 3}, {4, 5, 6}};
  for (const char* text :
       {"x,y,z\n1,2,3\n4,5,6\n", "x;y;z\r\n1;2;3\r\n4;5;6\r\n", "x\ty\tz\n1\t2\t3\n4\t5\t6", "1 2 3\n4 5 6\n",
        "# x y z\n1 2 3\n4 5 6\n", "\xef\xbb\xbfX,Y,Z\n1,2,3\n4,5,6\n", "\n\n1,2,3\n# a comment\n\n4,5,6\n",
        "z,y,x\n3,2,1\n6,5,4\n", "\"x\", \"y\", \"z\"\n\"1\", +2, 3.0\n 4 ,5e0,0.6e1\n",
        "name,Pos_X [m],pos_y (m),POSZ\n\"a,b\",1,2,3\n,4,5,6\n", "x,y,z,\n1,2,3,\n4,5,6,\n"})
    EXPECT_EQ(positions(read(text)), expected) << text;
  EXPECT_EQ(positions(read("x,y\n1,2\n")), (Rows{{1, 2, 0}})) << "without z";
  EXPECT_EQ(positions(read("a,b,c\n1,2,3\n", "x=c,y=2,z=a")), (Rows{{3, 2, 1}}));
  EXPECT_EQ(positions(read("x,y,z\n1,2,3\n", "x=z,z=x")), (Rows{{3, 2, 1}}));
  EXPECT_EQ(positions(read("x,y,z\n1,2,3\n", "z=none")), (Rows{{1, 2, 0}}));
}

TEST_F(Tables, HaveAllQuantitiesInTheirUnits) {
  const BodyTable table = read(
      "x,y,z,diameter,mass,vx,vy,vz,omega_x,omega_y,omega_z,qw,qx,qy,qz,colour\n"
      "1,2,3,4,5,6,7,8,9,10,11,0,0,2,0,1e-300\n",
      "", 0.5);
  EXPECT_EQ(positions(table), (Rows{{0.5, 1, 1.5}}));
  EXPECT_THAT(table.radius, ElementsAre(1));
  EXPECT_THAT(table.mass, ElementsAre(5));
  EXPECT_EQ(table.velocity[0], Vector3d(3, 3.5, 4));
  EXPECT_EQ(table.angular_velocity[0], Vector3d(9, 10, 11));
  EXPECT_EQ(table.orientation[0].coeffs(), Quaterniond(0, 0, 1, 0).coeffs());
  EXPECT_THAT(table.notes, ElementsAre("columns not used: colour"));
  EXPECT_EQ(read("x,y,z,vx\n1,2,3,4\n").velocity[0], Vector3d(4, 0, 0));
  EXPECT_THAT(read("1 2 3\n").radius, IsEmpty());
  EXPECT_EQ(read("x,y,z\n1e-300,0,-1e-310\n").position[0], Vector3d(0, 0, 0)) << "below the normal floats";
}

TEST_F(Tables, AreOrderedById) {
  EXPECT_EQ(positions(read("id,x,y,z,r\n7,1,1,1,1\n-3,2,2,2,2\n5,3,3,3,3\n")),
            (Rows{{2, 2, 2}, {3, 3, 3}, {1, 1, 1}}));
  EXPECT_THAT(read("id,x,y,z,r\n7,1,1,1,1\n-3,2,2,2,2\n5,3,3,3,3\n").radius, ElementsAre(2, 3, 1));
  EXPECT_EQ(refusal("id,x,y,z\n1,0,0,0\n2,0,0,0\n1,0,0,0\n"),
            ": rows 1 and 3 have the same id 1, expected different ids");
}

TEST_F(Tables, ReadLargeTextByManyThreads) {
  std::string text = "id,x,y,z\n";
  const int count = 200'000;  // several parts
  for (int k = 0; k < count; ++k) {
    text += std::to_string(k) + "," + std::to_string(k) + ".5,0.25,-1\n";
    if (k % 1000 == 0) text += "# a comment\n\n";
  }
  const BodyTable table = read(text);
  ASSERT_EQ(table.size(), static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    ASSERT_EQ(table.position[static_cast<std::size_t>(k)], Vector3d(k + 0.5, 0.25, -1)) << k;
  text += "200000,1,2\n";
  EXPECT_EQ(refusal(text), ":200402:11: 3 columns, expected 4");
}

TEST_F(Tables, NameThePlaceOfEachFault) {
  EXPECT_EQ(refusal("x,y,z\n1,2,3\n4,five,6\n"), ":3:3: five is not a number, expected y");
  EXPECT_EQ(refusal("# made by hand\nx,y,z\n\n1,2\n"), ":4:4: 2 columns, expected 3");
  EXPECT_EQ(refusal("x y z\n1 2 3 4\n"), ":2:7: more than 3 columns");
  EXPECT_EQ(refusal("x,y,z\n1,,3\n"), ":2:3: '' is not a number, expected y");
  EXPECT_EQ(refusal("x,y,z\n1,nan,3\n"), ":2:3: nan is no valid y, expected -1e+09 to 1e+09 m");
  EXPECT_EQ(refusal("x,y,z,radius\n1,2,3,-4\n"), ":2:7: -4 is no valid radius, expected 1e-09 to 1e+09 m");
  EXPECT_EQ(refusal("x;y;z\n1;2,5;3\n"), ":2:3: 2,5 is not a number, expected y");
  EXPECT_EQ(refusal("x,y,z\n1,2,3x\n"), ":2:5: 3x is not a number, expected z");
  EXPECT_EQ(refusal("x,y,z\n"), ": no bodies, expected at least one row");
  EXPECT_EQ(refusal("a,b,c\n1,2,3\n"),
            ": no column x; there are the columns a, b, c; name it with --columns x=NAME");
  EXPECT_EQ(refusal("x,px,y\n1,2,3\n"), ": columns 1 and 2 can both be x; choose one with --columns x=N");
  EXPECT_EQ(refusal("1,2,3,4,5\n"),
            ": 5 columns without names; give their meaning, such as --columns x=1,y=2,z=3,radius=4");
  EXPECT_EQ(refusal("x,y,z\n1,2,3\n", "x=4"), ": no column 4 for x; there are the columns x, y, z");
  EXPECT_EQ(refusal("x,y,z,qw,qx,qy,qz\n1,2,3,0,0,0,0\n"),
            ": row 1: the orientation is 0, expected a quaternion");
  EXPECT_EQ(refusal("1,2,3\n", "", 1), ": no frame 1; it has 1, counted from 0");
}

TEST_F(Tables, ListTheFirst20Faults) {
  std::string text = "x,y,z\n";
  for (int k = 0; k < 100'000; ++k) text += "1,2,bad\n";
  const std::string faults = refusal(text);
  EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 19);
  EXPECT_THAT(faults, testing::StartsWith(":2:5: bad is not"));
  EXPECT_THAT(faults, HasSubstr("file:21:5: bad is not"));
}

TEST(ColumnMaps, AreChecked) {
  const auto refused = [](const std::string& text) -> std::string {
    try {
      parse_column_map(text, "--columns");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused("x=1,y=2"), "");
  EXPECT_EQ(refused("x"), "--columns: x is not QUANTITY=COLUMN, such as radius=4 or x=pos_x");
  EXPECT_THAT(refused("speed=1"),
              HasSubstr("--columns: unknown quantity speed, expected id, x, y, z, radius"));
  EXPECT_EQ(refused("x=1,x=2"), "--columns: x is given twice, expected once");
}

std::string lammps(const std::string& box, const std::string& atoms) {
  return "ITEM: TIMESTEP\n5\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS " + box + "\nITEM: ATOMS " + atoms;
}

TEST_F(Tables, OfLammpsHaveScaledCoordinatesAndTiltedBoxes) {
  const std::string straight = "pp pp pp\n10 20\n0 4\n-1 1";
  EXPECT_EQ(positions(read(lammps(straight, "id xs ys zs\n2 0.5 0.25 0\n1 0 0 1\n"))),
            (Rows{{10, 0, 1}, {15, 1, -1}}));
  EXPECT_EQ(positions(read(lammps(straight, "id xu yu zu\n2 0.5 0.25 0\n1 0 0 1\n"))),
            (Rows{{0, 0, 1}, {0.5, 0.25, 0}}));
  EXPECT_EQ(positions(read(lammps(straight, "id xs ys zs\n2 0.5 0.25 0\n1 0 0 1\n"), "", 2)),
            (Rows{{20, 0, 2}, {30, 2, -2}}))
      << "in units of 2 m";
  // A box of 10 x 4 x 2 whose second edge is tilted by xy = 3, xz = -1, yz = 2: bounds as LAMMPS documents
  // them.
  const std::string tilted = "xy xz yz pp pp pp\n-1 13 3\n0 6 -1\n-1 1 2";
  EXPECT_EQ(positions(read(lammps(tilted, "id xs ys zs\n1 0 0 0\n2 1 1 1\n"))),
            (Rows{{0, 0, -1}, {12, 6, 1}}));
  const std::string general = "abc origin pp pp pp\n10 0 0 1\n3 4 0 2\n-1 2 2 3";
  EXPECT_EQ(positions(read(lammps(general, "id xs ys zs\n1 0 0 0\n2 1 1 1\n"))),
            (Rows{{1, 2, 3}, {13, 8, 5}}));
}

TEST_F(Tables, OfLammpsHaveFrames) {
  const std::string box = "pp pp pp\n0 1\n0 1\n0 1", first = lammps(box, "id x y z\n1 1 1 1\n2 2 2 2\n"),
                    second = "ITEM: UNITS\nlj\n" + lammps(box, "id type x y z\n1 1 5 5 5\n2 1 6 6 6\n");
  EXPECT_EQ(read(first + second).frames, 2);
  EXPECT_EQ(positions(read(first + second, "", 1, 1)), (Rows{{5, 5, 5}, {6, 6, 6}}));
  EXPECT_EQ(refusal(first + second, "", 2), ": no frame 2; it has 2, counted from 0");
  const BodyTable incomplete = read(first + second.substr(0, second.size() - 11));
  EXPECT_EQ(incomplete.frames, 1);
  EXPECT_THAT(incomplete.notes, ElementsAre("the last frame is incomplete"));
  EXPECT_EQ(refusal(first.substr(0, first.size() - 8)),
            ":10:1: the file ends after 1 of 2 atoms, expected all");
  EXPECT_EQ(refusal("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\nmany\n"),
            ":4:1: no number of atoms, expected a whole number up to 134217728");
  EXPECT_EQ(refusal("ITEM: TIMESTEP\n0\nnothing\n"),
            ":3:1: unknown line, expected a line that begins with ITEM:");
}

TEST_F(Tables, OfXyzHaveFramesAndProperties) {
  EXPECT_EQ(positions(read("2\nwater\nO 1 2 3\nH 4 5 6\n")), (Rows{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(positions(read("1\na\nO 1 2 3\n1\nb\nO 4 5 6\n", "", 1, 1)), (Rows{{4, 5, 6}}));
  const BodyTable table =
      read("1\nProperties=radius:R:1:pos:R:3:velo:R:3:move_mask:L:1\n0.5 1 2 3 4 5 6 T\n");
  EXPECT_EQ(positions(table), (Rows{{1, 2, 3}}));
  EXPECT_THAT(table.radius, ElementsAre(0.5));
  EXPECT_EQ(table.velocity[0], Vector3d(4, 5, 6));
  EXPECT_THAT(read("1\n\nO 1 2 3 7\n", "radius=5").radius, ElementsAre(7));
  EXPECT_EQ(refusal("3\na\nO 1 2 3\nO 1 2 3\n"), ":4:1: the file ends after 2 of 3 atoms, expected all");
}

TEST_F(Tables, OfPlyArePoints) {
  const std::string begin = "ply\nformat ascii 1.0\n",
                    points =
                        "element vertex 2\nproperty float x\nproperty float y\n"
                        "property float z\n";
  EXPECT_EQ(positions(read(begin + points + "end_header\n1 2 3\n4 5 6\n")), (Rows{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(refusal(begin + points +
                    "element face 1\nproperty list uchar int i\nend_header\n1 2 3\n4 5 6\n3 0 1 1\n"),
            ": a mesh of 1 faces, expected points without faces");
  EXPECT_EQ(refusal(begin + points + "end_header\n1 2 3\n4 5\n"), ":9:4: 2 columns, expected 3");
  EXPECT_EQ(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n1\n"),
            ":4:1: damaged property, expected `property float x` or `property list uchar int name`");
  EXPECT_THAT(refusal("ply\nformat binary_little_endian 1.0\n" + points + "end_header\n1234"),
              HasSubstr(": the file ends, expected 2 vertices of 12 bytes"));
  EXPECT_EQ(refusal("ply\n" + points + "end_header\n"),
            ":6:1: no format, expected a line `format ascii 1.0` before the end of the header");
}

TEST_F(Tables, OfNumPyNameTheRowOfAFault) {
  EXPECT_EQ(refusal(npy_bytes("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 4), }",
                              data_of<float>({1, 2, 3, 4, 5, 6, 7, 0}))),
            ": row 2, column 4: 0 is no valid radius, expected 1e-09 to 1e+09 m");
  EXPECT_EQ(refusal(npy_bytes("{'descr': '<f4', 'fortran_order': False, 'shape': (3,), }",
                              data_of<float>({1, 2, 3}))),
            ": an array of shape (3,), expected (n, 3) or (n, 4): x, y, z, radius of each body");
}

TEST(FileFormats, AreDetectedByContent) {
  const auto of = [](const std::string& text) { return format_of_start(text, text.size()); };
  EXPECT_EQ(of("{\"format\": 1}"), FileFormat::scene);
  EXPECT_EQ(of("  // a comment\n{}"), FileFormat::scene);
  EXPECT_EQ(of("collidoscope-snapshot\n"), FileFormat::snapshot);
  EXPECT_EQ(of("collidoscope-recording\n"), FileFormat::recording);
  EXPECT_EQ(of("\x93NUMPY\1"), FileFormat::npy);
  EXPECT_EQ(of("PK\3\4"), FileFormat::npz);
  EXPECT_EQ(of("ply\nformat ascii 1.0\n"), FileFormat::ply);
  EXPECT_EQ(of("ITEM: TIMESTEP\n"), FileFormat::lammps);
  EXPECT_EQ(of("3\na comment\nH 0 0 0\n"), FileFormat::xyz);
  EXPECT_EQ(of("3\n1 2 3\n"), FileFormat::unknown);
  EXPECT_EQ(of("# Blender\no Cube\nv 1 2 3\n"), FileFormat::obj);
  EXPECT_EQ(of("solid a\n facet normal 0 0 1\n"), FileFormat::stl);
  EXPECT_EQ(of(std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, '\0')), FileFormat::stl);
  EXPECT_EQ(of("<?xml version=\"1.0\"?>\n<robot name=\"a\">"), FileFormat::urdf);
  EXPECT_EQ(of("<mujoco/>"), FileFormat::mjcf);
  EXPECT_EQ(of("x,y,z\n1,2,3\n"), FileFormat::csv);
  EXPECT_EQ(of("1 2 3\n"), FileFormat::csv);
  EXPECT_EQ(of(""), FileFormat::unknown);
  EXPECT_EQ(of("word\n"), FileFormat::unknown);
  EXPECT_EQ(of(std::string("1,2\0", 4)), FileFormat::unknown);
}

}  // namespace
}  // namespace collidoscope
