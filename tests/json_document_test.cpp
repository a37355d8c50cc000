// Tests the JSON parser: exact numbers, positions of tokens, limits of size and nesting, and one line per
// fault. Damaged text must never crash it.
#include "sim_cuda/scene/json_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/json_syntax.h"

namespace collidoscope {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

/// The start of a node's token, as "line:column".
std::string position(const JsonDocument& document, std::uint32_t offset) {
  const std::string line = document.lines({{offset, "x"}}).at(0);
  return line.substr(2, line.size() - 5);
}

std::string fault_of(std::string text) {
  try {
    const JsonDocument document(std::move(text), "f");
    if (!document.faults().empty()) return document.lines(document.faults()).front();
  } catch (const InputError& error) {
    return error.lines().front();
  }
  return "none";
}

TEST(JsonDocument, NodesKnowWhereTheirTokensStart) {
  const JsonDocument document(
      "\xEF\xBB\xBF// a comment\n{ /* and, : [ { \" another */ \"a\": [1, -2.5e3,true],\n\t\"b\\n\" :\n  "
      "null , "
      "\"\xC3\xA9\xC3\xA9\": {},\"s\":\"t\"}\n",
      "f");
  const JsonNode& root = document.root();
  ASSERT_EQ(root.kind, JsonKind::object);
  ASSERT_EQ(root.child_count, 4u);
  EXPECT_EQ(position(document, root.begin), "2:1");

  const JsonNode& a = document.children(root)[0];
  EXPECT_EQ(document.key(a), "a");
  EXPECT_EQ(position(document, a.key_begin), "2:30");
  EXPECT_EQ(position(document, a.begin), "2:35");
  ASSERT_EQ(a.child_count, 3u);
  EXPECT_EQ(position(document, document.children(a)[0].begin), "2:36");
  EXPECT_EQ(position(document, document.children(a)[1].begin), "2:39");
  EXPECT_EQ(document.token(document.children(a)[1]), "-2.5e3");
  EXPECT_EQ(document.number(document.children(a)[1]), -2500.0);
  EXPECT_EQ(document.token(document.children(a)[2]), "true");

  const JsonNode& b = document.children(root)[1];
  EXPECT_EQ(document.key(b), "b\n");
  EXPECT_EQ(position(document, b.key_begin), "3:2");
  EXPECT_EQ(position(document, b.begin), "4:3");
  const JsonNode& s = document.children(root)[3];
  EXPECT_EQ(position(document, s.begin), "4:23");  // a two-byte character is one column
  EXPECT_EQ(document.text(s), "t");
  EXPECT_EQ(document.find(root, "s"), &s);
  EXPECT_EQ(document.find(root, "t"), nullptr);
}

TEST(JsonDocument, NumbersAreExact) {
  const JsonDocument document("[0.1, -0, 1e-320, 1e-999, 18446744073709551615, 1.7976931348623157e308]", "f");
  const auto values = document.children(document.root());
  EXPECT_EQ(document.number(values[0]), 0.1);
  EXPECT_TRUE(std::signbit(*document.number(values[1])));
  EXPECT_EQ(document.number(values[2]), 1e-320);
  EXPECT_EQ(document.number(values[3]), std::nullopt);
  EXPECT_EQ(document.token(values[4]), "18446744073709551615");
  EXPECT_EQ(document.number(values[5]), 1.7976931348623157e308);
}

TEST(JsonDocument, EscapesAreDecoded) {
  const JsonDocument document(R"(["\u00e9\ud83d\ude00\"\\\/\t", "plain"])", "f");
  EXPECT_EQ(document.text(document.children(document.root())[0]), "\xC3\xA9\xF0\x9F\x98\x80\"\\/\t");
  EXPECT_EQ(document.text(document.children(document.root())[1]), "plain");
}

TEST(JsonDocument, DuplicateKeysWait) {
  const JsonDocument document("{\"a\": 1,\n \"b\": {\"c\": 1, \"c\": 2},\n \"\\u0061\": 3}", "f");
  EXPECT_THAT(document.lines(document.faults()),
              ElementsAre("f:2:16: duplicate key \"c\" in this object; keep one of them",
                          "f:3:2: duplicate key \"a\" in this object; keep one of them"));
}

TEST(JsonDocument, WordsThatAreNoValuesWait) {
  const JsonDocument document("{\"a\": NaN, \"b\": [1, 1e999,\n 0x1], \"c\": 2, \"t\": \"NaN\" /* inf */}",
                              "f");
  EXPECT_THAT(document.lines(document.faults()),
              ElementsAre(StartsWith("f:1:7: NaN is not a finite number"),
                          StartsWith("f:1:21: 1e999 is out of range"),
                          StartsWith("f:2:2: \"0x1\" is not a JSON number")));
  const JsonNode& root = document.root();
  ASSERT_EQ(root.child_count, 4u);
  EXPECT_EQ(document.find(root, "a")->kind, JsonKind::invalid);
  EXPECT_EQ(document.token(*document.find(root, "a")), "NaN");
  const auto list = document.children(*document.find(root, "b"));
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(document.number(list[0]), 1.0);
  EXPECT_EQ(list[1].kind, JsonKind::invalid);
  EXPECT_EQ(document.token(list[2]), "0x1");
  EXPECT_EQ(document.number(*document.find(root, "c")), 2.0);
  EXPECT_EQ(document.text(*document.find(root, "t")), "NaN");
}

TEST(JsonDocument, EachOccurrenceOfAKeyIsRead) {
  JsonDocument document("{\"a\": 1, \"a\": 2, \"a\": 3, \"b\": 4}", "f");
  std::vector<std::string_view> seen;
  try {
    document.read_all([&](bool first) {
      EXPECT_EQ(first, seen.empty());
      seen.push_back(document.token(*document.find(document.root(), "a")));
      EXPECT_EQ(document.token(*document.find(document.root(), "b")), "4");
      return document.faults();
    });
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 2u);
  }
  EXPECT_THAT(seen, ElementsAre("1", "2", "3"));
}

TEST(JsonDocument, NestingIsBounded) {
  const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_EQ(fault_of(nested(64)), "none");
  EXPECT_THAT(fault_of(nested(65)), StartsWith("f:1:65: more than 64 nested arrays and objects"));
  EXPECT_THAT(fault_of(std::string(100'000, '[')), StartsWith("f:1:65: more than 64"));
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_THAT(fault_of(objects), StartsWith("f:1:321: more than 64"));
}

TEST(JsonDocument, SizeIsBounded) {
  EXPECT_THAT(fault_of(std::string(JsonDocument::max_bytes + 1, ' ')), StartsWith("f: larger than 64 MiB"));
  std::string values = "[0";
  for (std::size_t i = 1; i < JsonDocument::max_nodes; ++i) values += ",0";
  EXPECT_THAT(fault_of(values + "]"), StartsWith("f:1:16777216: more than 8388608 values"));
}

TEST(JsonDocument, FaultsAreListedInTheOrderOfTheText) {
  const JsonDocument document("[1,\n 2]", "f");
  EXPECT_THAT(document.lines({{5, "b"}, {1, "a"}, {99, "end"}}),
              ElementsAre("f:1:2: a", "f:2:2: b", "f:2:4: end"));
  const std::vector<std::string> many = document.lines(std::vector<JsonFault>(20'000, JsonFault{1, "a"}));
  EXPECT_EQ(many.size(), 10'001u);
  EXPECT_EQ(many.back(), "f: more than 10000 faults; the others are not listed");
}

struct DocumentFault {
  std::string text, line;
};
class BadJson : public testing::TestWithParam<DocumentFault> {};
TEST_P(BadJson, IsExplained) { EXPECT_THAT(fault_of(GetParam().text), StartsWith(GetParam().line)); }

INSTANTIATE_TEST_SUITE_P(
    Table, BadJson,
    testing::Values(
        DocumentFault{"", "f:1:1: the document is empty"},
        DocumentFault{" \n // x\n", "f:3:1: the document is empty"},
        DocumentFault{
            "{",
            "f:1:2: unexpected end of the document inside the object opened on line 1; close it with \"}\""},
        DocumentFault{"{\n\"a\": [1, 2",
                      "f:2:11: unexpected end of the document inside the array opened on line 2"},
        DocumentFault{"{\"a\"", "f:1:5: unexpected end of the document inside the object"},
        DocumentFault{"{\"a\":", "f:1:6: unexpected end of the document inside the object"},
        DocumentFault{"{\"a\":1,", "f:1:8: unexpected end of the document inside the object"},
        DocumentFault{"{\"a\": \"b", "f:1:7: this string has no closing quote; end it with \""},
        DocumentFault{"{\"a", "f:1:2: this string has no closing quote"},
        DocumentFault{"{\"a\": \"b\n\"}", "f:1:7: this string has no closing quote on its line"},
        DocumentFault{"{\"a\" 1}", "f:1:6: a \":\" is missing between the key and its value"},
        DocumentFault{"{\"a\": 1 \"b\": 2}", "f:1:9: a \",\" or \"}\" is missing before this"},
        DocumentFault{"[1 2]", "f:1:4: a \",\" or \"]\" is missing before this"},
        DocumentFault{"[1,\n 2}", "f:2:3: \"}\" cannot close the array of line 1; expected \"]\""},
        DocumentFault{"{\"a\": 1]", "f:1:8: \"]\" cannot close the object of line 1; expected \"}\""},
        DocumentFault{"[1,]",
                      "f:1:4: another value must follow after a \",\"; remove the comma before \"]\""},
        DocumentFault{"{\"a\": 1,}",
                      "f:1:9: another key must follow after a \",\"; remove the comma before \"}\""},
        DocumentFault{"{,}", "f:1:2: a key is missing before this \",\""},
        DocumentFault{"[,]", "f:1:2: a value is missing before this \",\""},
        DocumentFault{"{\"a\":}", "f:1:6: a value is missing before this \"}\""},
        DocumentFault{"{a: 1}", "f:1:2: expected a key in double quotes: \"name\": value; found a"},
        DocumentFault{"{'a': 1}", "f:1:2: expected a key in double quotes"},
        DocumentFault{"['a']", "f:1:2: strings need double quotes"},
        DocumentFault{"[yes]", "f:1:2: yes is not a JSON value"},
        DocumentFault{"[True]", "f:1:2: True is not a JSON value"},
        DocumentFault{"[nul]", "f:1:2: nul is not a JSON value"},
        DocumentFault{"[1, NaN]", "f:1:5: NaN is not a finite number; write a finite number"},
        DocumentFault{"[-Infinity]", "f:1:2: -Infinity is not a finite number"},
        DocumentFault{"[nan]", "f:1:2: nan is not a finite number"},
        DocumentFault{"[1e999]", "f:1:2: 1e999 is out of range of a double"},
        DocumentFault{"[0, // c\n -1e999]", "f:2:2: -1e999 is out of range of a double"},
        DocumentFault{"[01]", "f:1:2: \"01\" is not a JSON number"},
        DocumentFault{"[+1]", "f:1:2: \"+1\" is not a JSON number"},
        DocumentFault{"[.5]", "f:1:2: \".5\" is not a JSON number"},
        DocumentFault{"[1.]", "f:1:2: \"1.\" is not a JSON number"},
        DocumentFault{"[1e]", "f:1:2: \"1e\" is not a JSON number"},
        DocumentFault{"[-]", "f:1:2: \"-\" is not a JSON number"},
        DocumentFault{"[0x10]", "f:1:2: \"0x10\" is not a JSON number"},
        DocumentFault{"[5m]", "f:1:2: \"5m\" is not a JSON number"},
        DocumentFault{"[\"\\x\"]", "f:1:3: unknown escape sequence"},
        DocumentFault{"[\"\\u12g4\"]", "f:1:3: \\u needs four hexadecimal digits"},
        DocumentFault{"[\"\\ud800\"]", "f:1:3: half of a surrogate pair"},
        DocumentFault{"[\"\\udc00\"]", "f:1:3: half of a surrogate pair"},
        DocumentFault{"[\"a\tb\"]", "f:1:4: a control character (byte 9) in a string; write it as \\u0009"},
        DocumentFault{"[\"a\xFF\"]", "f:1:4: this byte is not UTF-8"},
        DocumentFault{"[\"\xC3\"]", "f:1:3: this byte is not UTF-8"},
        DocumentFault{"[\"\xED\xA0\x80\"]", "f:1:3: this byte is not UTF-8"},
        DocumentFault{"{\"\xC0\x80\": 1}", "f:1:3: this byte is not UTF-8"},
        DocumentFault{"[1] /* open", "f:1:5: this comment is not closed"},
        DocumentFault{"[1, /* open", "f:1:5: this comment is not closed"},
        DocumentFault{"[1] # x", "f:1:5: comments start with //"},
        DocumentFault{"[1, / 2]", "f:1:5: comments start with //"},
        DocumentFault{"[1] 2", "f:1:5: unexpected text after the end of the document"},
        DocumentFault{"{} {}", "f:1:4: unexpected text"}, DocumentFault{"[],", "f:1:3: unexpected text"},
        DocumentFault{std::string("[1]\0[2]", 7), "f:1:4: a zero byte"},
        DocumentFault{std::string("[1,\0 2]", 7), "f:1:4: a zero byte"},
        DocumentFault{std::string("[\"a\0\"]", 6), "f:1:4: a control character (byte 0)"},
        DocumentFault{"]", "f:1:1: a value is missing before this \"]\""}));

TEST(JsonSyntax, Utf8) {
  EXPECT_TRUE(is_utf8("a\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80"));
  for (const char* bad : {"\x80", "\xC1\x81", "\xE0\x9F\x80", "\xED\xA0\x80", "\xF0\x8F\x80\x80",
                          "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x82"}) {
    std::size_t at = 99;
    EXPECT_FALSE(is_utf8(std::string("ab") + bad, &at));
    EXPECT_EQ(at, 2u);
  }
}

// Any truncated or damaged text gives a tree or one line that starts with a position. It never crashes.
TEST(JsonSyntax, EverySpoiltTextIsExplained) {
  const std::string good =
      "// c\n{\"a\\u00e9\": [1, -2.5e+3, \"x\xC3\xA9\"], /* d */ \"b\": {\"c\": null, \"d\": false}}\n";
  EXPECT_EQ(fault_of(good), "none");
  for (std::size_t at = 0; at < good.size(); ++at) {
    const std::string cut = fault_of(good.substr(0, at));
    if (at + 1 < good.size()) {
      EXPECT_THAT(cut, StartsWith("f:")) << at;
    }
    for (int byte = 0; byte < 256; ++byte) {
      std::string spoilt = good;
      spoilt[at] = static_cast<char>(byte);
      const std::string line = fault_of(spoilt);
      EXPECT_TRUE(line == "none" || line.starts_with("f:")) << line;
      EXPECT_EQ(line.find("json.exception"), std::string::npos);
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace collidoscope
