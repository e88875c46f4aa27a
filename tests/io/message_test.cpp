#include "io/bytes/message.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace chladni::io {
namespace {

Message example() {
  Message message;
  message.head = JsonObject{{"kind", "contact_sheet"}, {"count", 9}};
  message.doubles["points"] =
      Message::Doubles::NullaryExpr(5, 3, [](Eigen::Index i, Eigen::Index j) {
        return 0.1 * static_cast<double>(i) - 1e-9 * static_cast<double>(j);
      });
  message.integers["tets"] = Cells::Constant(2, 4, -7);
  message.doubles["empty"] = Message::Doubles(0, 3);
  return message;
}

TEST(Message, ReadsBackWhatWasWritten) {
  const Message there = example(), back = message(bytes(there));
  EXPECT_EQ(text(back.head), text(there.head));
  EXPECT_EQ(back.numbers("points"), there.numbers("points"));
  EXPECT_EQ(back.cells("tets"), there.cells("tets"));
  EXPECT_EQ(back.numbers("empty").rows(), 0);
}

TEST(Message, EveryShorterOneIsRefused) {
  const std::string whole = bytes(example());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(static_cast<void>(message(whole.substr(0, length))), InvalidInput) << length;
  }
  EXPECT_THROW(static_cast<void>(message(whole + "x")), InvalidInput);
}

TEST(Message, ALyingSizeAllocatesNothing) {
  std::string lie = bytes(example());
  const std::size_t at = lie.find("\"rows\": 5");
  ASSERT_NE(at, std::string::npos);
  const std::string head = lie.substr(lie.find('\n') + 1);
  std::string claims = head;
  claims.replace(claims.find("\"rows\": 5"), 9, "\"rows\": 4000000000");
  const std::size_t json = claims.rfind("}\n") + 2;
  lie = "chladni-message " + std::to_string(json) + "\n" + claims;
  EXPECT_THROW(static_cast<void>(message(lie)), InvalidInput);
}

// The message of `head` with arrays, each as its JSON says, and so many bytes behind.
std::string reply(const std::string& arrays, std::size_t bytes, const std::string& head = "{}") {
  const std::string json = R"({"head": )" + head + R"(, "arrays": [)" + arrays + "]}";
  return "chladni-message " + std::to_string(json.size()) + "\n" + json + std::string(bytes, '\0');
}

std::string array_of(const std::string& rows, const std::string& columns,
                     const std::string& type = "f64", const std::string& name = "a") {
  return R"({"name": ")" + name + R"(", "type": ")" + type + R"(", "rows": )" + rows +
         R"(, "columns": )" + columns + "}";
}

TEST(Message, SizesAreWholeNumbersThatAgreeWithTheBytes) {
  EXPECT_EQ(message(reply(array_of("2", "3"), 48)).numbers("a").rows(), 2);
  EXPECT_EQ(message(reply(array_of("0", "3"), 0)).numbers("a").cols(), 3);
  const char* lies[][2] = {{"1.999", "200000"},  // 1 row allocated, 1.999 copied
                           {"1.5", "2"},
                           {"-1", "-6"},
                           {"-1", "0"},
                           {"0", "1e18"},
                           {"1e300", "0"},
                           {"1e300", "1e300"},
                           {"4294967296", "4294967296"},  // a product of 2⁶⁴ is not 0
                           {"2147483648", "0"},
                           {"3", "2147483647"},
                           {"\"6\"", "1"},
                           {"null", "1"},
                           {"[6]", "1"},
                           {"true", "6"},
                           {"7", "1"}};
  for (const auto& lie : lies) {
    for (const char* type : {"f64", "i32"}) {
      const std::size_t six = std::string(type) == "f64" ? 48 : 24;
      EXPECT_THROW((void)message(reply(array_of(lie[0], lie[1], type), six)), InvalidInput)
          << lie[0] << " x " << lie[1];
      EXPECT_THROW((void)message(reply(array_of(lie[1], lie[0], type), six)), InvalidInput)
          << lie[1] << " x " << lie[0];
    }
  }
  const auto large = reply(array_of("1.999", "200000"), 8 * 399'800);
  EXPECT_THROW((void)message(large), InvalidInput);  // with the bytes that it speaks of
}

TEST(Message, HeadsThatLieAreRefused) {
  for (const char* words :
       {"", "{", "{}", "NaN", "[]", R"({"head": {}})", R"({"head": {}, "arrays": {}})",
        R"({"head": {}, "arrays": [1]})", R"({"head": {}, "arrays": [{"name": "a"}]})"}) {
    const std::string json = words;
    EXPECT_THROW((void)message("chladni-message " + std::to_string(json.size()) + "\n" + json),
                 InvalidInput)
        << words;
  }
  for (const char* length : {"", "-1", "1e1", "99999999999999999999999", "x", "4294967297"}) {
    EXPECT_THROW((void)message(std::string("chladni-message ") + length + "\n{}"), InvalidInput)
        << length;
  }
  EXPECT_THROW((void)message(reply(array_of("1", "1", "f32"), 8)), InvalidInput);
  EXPECT_THROW((void)message(reply(array_of("1", "1") + "," + array_of("1", "1"), 16)),
               InvalidInput);
}

TEST(Message, EveryByteMayBeAnother) {
  const std::string whole = bytes(example());
  int taken = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char other : {'\0', '9', '-', '.', '"', '\xff'}) {
      std::string lie = whole;
      lie[at] = other;
      try {
        (void)message(lie);
        ++taken;
      } catch (const InvalidInput&) {
      }
    }
  }
  EXPECT_GT(taken, 0);  // the numbers themselves
}

TEST(Message, AMissingArrayIsNamed) {
  const Message there = example();
  EXPECT_THROW(static_cast<void>(there.numbers("tets")), InvalidInput);
  EXPECT_THROW(static_cast<void>(there.cells("points")), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
