#include "io/message.h"

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

TEST(Message, AMissingArrayIsNamed) {
  const Message there = example();
  EXPECT_THROW(static_cast<void>(there.numbers("tets")), InvalidInput);
  EXPECT_THROW(static_cast<void>(there.cells("points")), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
