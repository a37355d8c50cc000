// Tests the reader of NumPy files, and of boxes in them.

#include "sim_cuda/import/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/box_file.h"
#include "tests/npy_file.h"
#include "tests/test_files.h"

namespace collidoscope {
namespace {

class Npy : public testing::Test {
 protected:
  std::string file_of(const std::string& bytes) { return write_npy(folder_ / "a.npy", bytes); }
  /// Numbers as double, in the order of the file.
  std::vector<double> numbers_of(const std::string& bytes) {
    const NpyArray array = read_npy(file_of(bytes));
    return array.visit([&](const auto* numbers) {
      std::vector<double> all;
      for (std::size_t k = 0; k < array.count(); ++k) all.push_back(static_cast<double>(numbers[k]));
      return all;
    });
  }
  /// The message without the path.
  template <class Read>
  std::string refusal(const std::string& bytes, const Read& read) {
    const std::string file = file_of(bytes);
    try {
      read(file);
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_THAT(text, testing::StartsWith(file + ":"));
      return text.substr(file.size() + 1);
    }
    return "";
  }
  std::string refusal(const std::string& bytes) {
    return refusal(bytes, [](const std::string& file) { return read_npy(file); });
  }

  TemporaryFolder folder_;
};

std::string header(const std::string& type, const std::string& shape, const std::string& order = "False") {
  return "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
}

TEST_F(Npy, HasNumbersOfAllTypes) {
  const std::vector<double> expected{1, 2, 127};
  const auto expect = [&]<class Number>(const std::string& type, Number) {
    EXPECT_EQ(numbers_of(npy_bytes(header(type, "(3,)"), data_of<Number>({1, 2, 127}))), expected) << type;
  };
  expect("<f4", float{});
  expect("<f8", double{});
  expect("|i1", std::int8_t{});
  expect("<i2", std::int16_t{});
  expect("<i4", std::int32_t{});
  expect("<i8", std::int64_t{});
  expect("|u1", std::uint8_t{});
  expect("<u2", std::uint16_t{});
  expect("=u4", std::uint32_t{});
  expect("<u8", std::uint64_t{});
  // The float 2 in big-endian order.
  EXPECT_EQ(numbers_of(npy_bytes(header(">f4", "(1,)"), std::string("\x40\0\0\0", 4))),
            std::vector<double>{2});
  EXPECT_EQ(numbers_of(npy_bytes(header(">i2", "(2,)"), std::string("\1\0\0\1", 4))),
            (std::vector<double>{256, 1}));
}

TEST_F(Npy, HasAnyFormatAndLayoutOfItsHeader) {
  const std::string data = data_of<float>({1, 2});
  for (const int version : {1, 2, 3})
    EXPECT_EQ(numbers_of(npy_bytes(header("<f4", "(1, 2)"), data, version)).size(), 2u) << version;
  for (const char* text : {R"({"shape":(2,1),"fortran_order":True,"descr":"<f4"})",
                           "{ 'fortran_order' : False , 'descr':'<f4' , 'shape' : ( 2 , ) }",
                           "{'descr': '<f4',\n 'fortran_order': False,\n 'shape': (2,)}"})
    EXPECT_EQ(numbers_of(npy_bytes(text, data)).size(), 2u) << text;
  const NpyArray one = read_npy(file_of(npy_bytes(header("<f8", "()"), data_of<double>({7}))));
  EXPECT_EQ(one.count(), 1u);
  EXPECT_TRUE(one.shape.empty());
  EXPECT_EQ(read_npy(file_of(npy_bytes(header("<f8", "(0, 6)"), ""))).count(), 0u);
}

TEST_F(Npy, IsRefusedWithThePlaceOfItsFault) {
  EXPECT_EQ(refusal("PK\3\4 is a zip file"), " byte 0: no NumPy file, expected the bytes \\x93NUMPY");
  EXPECT_EQ(
      refusal(npy_bytes(header("|O", "(1,)"), std::string(8, '\0'))),
      " byte 20: an array of objects, which can contain code, expected floating-point numbers or integers, "
      "such as '<f4' or '<f8'");
  EXPECT_THAT(
      refusal(npy_bytes("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (1,), }", "1234")),
      testing::StartsWith(" byte 20: an array of records, expected "));
  EXPECT_THAT(refusal(npy_bytes(header("<c8", "(1,)"), std::string(8, '\0'))),
              testing::StartsWith(" byte 20: an unknown type of numbers, expected "));
  EXPECT_EQ(refusal(npy_bytes(header("<f4", "(3,)"), "12345678")),
            " byte 128: 8 bytes of numbers, expected 12 for an array of shape (3,)");
  EXPECT_THAT(refusal(npy_bytes(header("<f4", "(3,)"), std::string(16, ' '))),
              testing::HasSubstr("16 bytes"));
  // Products beyond 64 bits take no memory.
  EXPECT_THAT(refusal(npy_bytes(header("<f8", "(999999999999, 999999999999)"), "12345678")),
              testing::HasSubstr("expected those of an array of shape (999999999999, 999999999999)"));
  EXPECT_THAT(refusal(npy_bytes(header("<f8", "(999999999999999999,)"), "")),
              testing::HasSubstr("too large"));
  EXPECT_THAT(refusal(npy_bytes(header("<f8", "(-1,)"), "")), testing::HasSubstr("expected a whole number"));
  EXPECT_THAT(refusal(npy_bytes(header("<f4", "(1,)", "0"), "1234")),
              testing::HasSubstr("expected True or False"));
  EXPECT_THAT(refusal(npy_bytes("{'descr': '<f4', 'shape': (1,), }", "1234")),
              testing::HasSubstr("expected the key fortran_order"));
  EXPECT_THAT(refusal(npy_bytes(header("<f4", "(1,)") + "x", "1234")),
              testing::HasSubstr("expected the end of the header"));
  EXPECT_THAT(refusal(npy_bytes("{'descr': '<f4', 'code': 1}", "1234")), testing::HasSubstr("unknown key"));
  std::string bytes = npy_bytes(header("<f4", "(1,)"), "1234");
  bytes[6] = 9;
  EXPECT_EQ(refusal(bytes), " byte 6: format 9, expected format 1, 2 or 3");
  // All beginnings of a file.
  bytes = npy_bytes(header("<f4", "(1,)"), "1234");
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_NE(refusal(bytes.substr(0, length)), "") << length;
  EXPECT_THROW(read_npy("/no/such/file.npy"), InputError);
  EXPECT_THROW(read_npy(folder_.path().string()), InputError);
  EXPECT_THROW(read_npy("/dev/zero"), InputError);
}

std::vector<std::array<float, 6>> boxes_in(const std::string& file) {
  std::vector<std::array<float, 6>> all;
  for (const Aabb& box : read_boxes(file))
    all.push_back({box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()});
  return all;
}

TEST_F(Npy, BoxesHaveTheSameValuesInEveryLayout) {
  const std::vector<std::array<float, 6>> expected{{0, 1, 2, 3, 4, 5}, {-1, -2, -3, 6, 7, 8}};
  const std::string by_row = data_of<float>({0, 1, 2, 3, 4, 5, -1, -2, -3, 6, 7, 8});
  EXPECT_EQ(boxes_in(file_of(npy_bytes(header("<f4", "(2, 6)"), by_row))), expected);
  EXPECT_EQ(boxes_in(file_of(npy_bytes(header("<f4", "(2, 2, 3)"), by_row))), expected);
  EXPECT_EQ(boxes_in(file_of(npy_bytes(header("<f4", "(2, 6)", "True"),
                                       data_of<float>({0, -1, 1, -2, 2, -3, 3, 6, 4, 7, 5, 8})))),
            expected);
  // Index [box][end][axis], the first fastest.
  EXPECT_EQ(boxes_in(file_of(npy_bytes(header("<f4", "(2, 2, 3)", "True"),
                                       data_of<float>({0, -1, 3, 6, 1, -2, 4, 7, 2, -3, 5, 8})))),
            expected);
  EXPECT_EQ(boxes_in(file_of(npy_bytes(header("<i2", "(2, 6)"),
                                       data_of<std::int16_t>({0, 1, 2, 3, 4, 5, -1, -2, -3, 6, 7, 8})))),
            expected);
}

TEST_F(Npy, BoxesAreRoundedOutwards) {
  const double third = 1.0 / 3;
  const auto box = boxes_in(file_of(npy_bytes(
      header("<f8", "(1, 6)"), data_of<double>({third, -third, 16777217, 2 * third, third, 16777217}))))[0];
  for (int k = 0; k < 3; ++k)
    EXPECT_LE(box[static_cast<std::size_t>(k)], box[static_cast<std::size_t>(k) + 3]);
  EXPECT_LE(static_cast<double>(box[0]), third);
  EXPECT_GT(static_cast<double>(std::nextafter(box[0], 1.0f)), third);
  EXPECT_LE(static_cast<double>(box[1]), -third);
  EXPECT_GE(static_cast<double>(box[4]), third);
  EXPECT_EQ(box[2], 16777216);
  EXPECT_EQ(box[5], 16777218);
}

TEST_F(Npy, FaultyBoxesAreListed) {
  const auto refused = [&](const std::string& bytes) { return refusal(bytes, read_boxes); };
  const float infinite = std::numeric_limits<float>::infinity();
  EXPECT_EQ(refused(npy_bytes(header("<f4", "(3, 6)"),
                              data_of<float>({0, 0, 0, 1, 1, 1, 0, 2, 0, 1, 1, 1, 0, 0, 0, 1, 1, infinite}))),
            " row 1: y from 2 to 1 has min above max\n" + (folder_ / "a.npy").string() +
                ": row 2: z from 0 to inf is not finite in single precision");
  EXPECT_THAT(refused(npy_bytes(header("<f8", "(1, 6)"), data_of<double>({0, 0, 0, 1, 1, 1e300}))),
              testing::HasSubstr("not finite in single precision"));
  EXPECT_EQ(refused(npy_bytes(header("<f4", "(2, 4)"), data_of<float>({1, 2, 3, 4, 5, 6, 7, 8}))),
            " an array of shape (2, 4), expected (n, 6) or (n, 2, 3): min and max of each box");
  EXPECT_THAT(refused(npy_bytes(header("<f4", "(0, 6)"), "")), testing::HasSubstr("0 boxes, expected 1 to "));
}

}  // namespace
}  // namespace collidoscope
