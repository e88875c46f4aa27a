#include "io/json.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <string>
#include <type_traits>

#include "base/error.h"

namespace chladni::io {
namespace {

// A string of nullptr would end the program, and other pointers would be true.
static_assert(!std::is_constructible_v<Json, std::nullptr_t>);
static_assert(!std::is_constructible_v<Json, const int*>);
static_assert(!std::is_constructible_v<Json, std::string*>);
static_assert(std::is_constructible_v<Json, const char*>);
static_assert(std::is_constructible_v<Json, char*>);
static_assert(std::is_constructible_v<Json, decltype("text")>);

std::string failure(const std::string& json) {
  try {
    static_cast<void>(parse_json(json));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(Json, EveryFiniteDoubleReadsBackBitByBit) {
  std::mt19937_64 bits(7);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t pattern = bits();
    double value = 0.0;
    std::memcpy(&value, &pattern, sizeof(value));
    if (!std::isfinite(value)) continue;
    const double back = parse_json(text(Json(value))).number();
    ASSERT_EQ(std::memcmp(&back, &value, sizeof(value)), 0) << value;
  }
}

TEST(Json, WritesTheShortestDigits) {
  EXPECT_EQ(text(Json(0.1)), "0.1\n");
  EXPECT_EQ(text(Json(19.44)), "19.44\n");
  EXPECT_EQ(text(Json(2.0)), "2.0\n");
  EXPECT_EQ(text(Json(1e300)), "1e+300\n");
  EXPECT_EQ(text(Json(2)), "2\n");
}

TEST(Json, WhatIsNoNumberIsNull) {
  EXPECT_EQ(text(Json(std::nan(""))), "null\n");
  EXPECT_EQ(text(Json(-std::numeric_limits<double>::infinity())), "null\n");
}

TEST(Json, KeepsTheOrderOfKeysAndNumbersOnOneLine) {
  const Json json(JsonObject{{"z", 1}, {"a", Json(Eigen::Vector3d(1.5, 0.0, -2.0))}, {"m", true}});
  EXPECT_EQ(text(json), "{\n  \"z\": 1,\n  \"a\": [1.5, 0.0, -2.0],\n  \"m\": true\n}\n");
  EXPECT_EQ(text(parse_json(text(json))), text(json));
}

TEST(Json, AMatrixIsAnArrayOfItsRows) {
  Eigen::MatrixXd matrix(2, 3);
  matrix << 1, 2, 3, 4, 5, 6;
  EXPECT_EQ(text(Json::rows(matrix)), "[\n  [1.0, 2.0, 3.0],\n  [4.0, 5.0, 6.0]\n]\n");
}

TEST(Json, EmptyContainersReadBack) {
  const Json json(JsonObject{{"array", JsonArray{}}, {"object", JsonObject{}}, {"null", Json()}});
  EXPECT_EQ(text(parse_json(text(json))), text(json));
  EXPECT_EQ(parse_json(text(json)).at("array").array().size(), 0U);
}

TEST(Json, AnyNameIsValidAndReadsBack) {
  for (const std::string name : {"a\"b\\c\n\t", "\x01\x7f", "schräg µ \xF0\x9F\x98\x80"}) {
    EXPECT_EQ(parse_json(text(Json(name))).string(), name);
  }
}

TEST(Json, BytesThatAreNotUtf8AreReplaced) {
  for (const std::string bad : {"\xFF", "\xC3", "\xED\xA0\x80", "\xC0\xAF", "\xF4\x90\x80\x80"}) {
    const std::string back = parse_json(text(Json("<" + bad + ">"))).string();
    EXPECT_NE(back.find("\xEF\xBF\xBD"), std::string::npos);
    EXPECT_EQ(back.front(), '<');
    EXPECT_EQ(back.back(), '>');
  }
}

TEST(Json, ADecimalCommaInTheLocaleChangesNothing) {
  for (const char* name : {"de_DE.UTF-8", "nl_NL.UTF-8", "fr_FR.UTF-8"}) {
    std::setlocale(LC_ALL, name);
    EXPECT_EQ(text(Json(1.5)), "1.5\n");
    EXPECT_EQ(parse_json("1.5").number(), 1.5);
  }
  std::setlocale(LC_ALL, "C");
}

TEST(Json, WholeNumbersBeyondSixtyFourBitsAreDoubles) {
  EXPECT_EQ(parse_json("18446744073709551615").number(), 18446744073709551615.0);
  EXPECT_EQ(text(parse_json("-9223372036854775808")), "-9223372036854775808\n");
}

TEST(Json, WhatIsNotJsonIsRefusedWithItsPlace) {
  EXPECT_NE(failure("{\"a\": 1,, }").find("byte 9"), std::string::npos) << failure("{\"a\": 1,, }");
  for (const std::string bad :
       {"", "{", "[1, 2", "{\"a\"}", "nul", "1 2", "[1,]", "\"\\x\"", "NaN"}) {
    EXPECT_NE(failure(bad).find("not JSON"), std::string::npos) << bad << ": " << failure(bad);
  }
}

TEST(Json, AKeyThatIsThereTwiceIsRefused) {
  EXPECT_EQ(failure("{\"a\": 1, \"a\": 2}"), "JSON: key \"a\" is there twice");
}

TEST(Json, DeepNestingIsRefusedBeforeTheStackEnds) {
  EXPECT_NE(failure(std::string(1000000, '[')).find("nested deeper"), std::string::npos);
  EXPECT_EQ(failure(std::string(200, '[') + std::string(200, ']')), "");
}

TEST(Json, AMissingKeyListsThoseThereAre) {
  const Json json = parse_json("{\"mass_kg\": 19.44, \"seed\": 1}");
  EXPECT_EQ(json.at("mass_kg").number(), 19.44);
  try {
    static_cast<void>(json.at("mass"));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(), "JSON: no key \"mass\"; there are: mass_kg, seed");
  }
}

TEST(Json, AValueOfAnotherKindIsRefused) {
  EXPECT_THROW(static_cast<void>(Json("a").number()), InvalidInput);
  EXPECT_THROW(static_cast<void>(Json(1).string()), InvalidInput);
  EXPECT_THROW(static_cast<void>(Json(1).array()), InvalidInput);
  EXPECT_THROW(static_cast<void>(Json(1).at("a")), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
