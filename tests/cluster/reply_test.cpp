#include "cluster/reply.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>
#include <vector>

#include "tests/cluster/exchange_folder.h"
#include "tests/refusal.h"

namespace chladni::cluster {
namespace {

const std::string kGood =
    "chladni-slepc 1\nrows 3\nbound 50\ncounted 2\nseconds 0.5\nranks 2\n1000\n2000\n"
    "shifts 2\n-1 0\n50 2\nmodes 2\n40.5\n4\nend\n";

class Replies : public ExchangeFolder {
 protected:
  void write(const std::string& text, std::size_t numbers = 6) const {
    std::ofstream(folder_ / "reply.txt") << text;
    // 1, -2, 3, -4, ... by their bytes
    std::string bytes;
    for (std::size_t i = 0; i < numbers; ++i) {
      static const std::vector<std::string> words = {
          {"\x3f\xf0\0\0\0\0\0\0", 8}, {"\xc0\0\0\0\0\0\0\0", 8},   {"\x40\x08\0\0\0\0\0\0", 8},
          {"\xc0\x10\0\0\0\0\0\0", 8}, {"\x40\x14\0\0\0\0\0\0", 8}, {"\xc0\x18\0\0\0\0\0\0", 8}};
      bytes += words.at(i % words.size());
    }
    for (const auto* name : {"shapes.petsc", "corrections.petsc"}) {
      std::ofstream(folder_ / name, std::ios::binary) << bytes;
    }
  }
  std::string refused(const std::string& text, std::size_t numbers = 6) const {
    write(text, numbers);
    return refusal_of([&] { return read_reply(folder_, 3); });
  }
  static std::string with(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }
};

TEST_F(Replies, AreReadAndSorted) {
  write(kGood);
  const auto reply = read_reply(folder_, 3);
  EXPECT_EQ(reply.given.lambda, Eigen::Vector2d(4.0, 40.5));
  EXPECT_EQ(reply.given.shapes, (Eigen::MatrixXd(3, 2) << -4, 1, 5, -2, -6, 3).finished());
  EXPECT_EQ(reply.given.corrections, reply.given.shapes);
  EXPECT_EQ(reply.given.bound, 50.0);
  EXPECT_EQ(reply.given.counted, 2);
  EXPECT_EQ(reply.peak_bytes, (std::vector<double>{1000.0, 2000.0}));
  EXPECT_EQ(reply.shifts, 2);
  EXPECT_EQ(reply.seconds, 0.5);
}

TEST_F(Replies, ThatAreNotOursAreRefused) {
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"chladni-slepc 1", "chladni-slepc 2"},
                                                        {"rows 3", "rows 4"},
                                                        {"rows 3", "rows"},
                                                        {"bound 50", "bound fifty"},
                                                        {"modes 2", "modes 3"},
                                                        {"modes 2", "modes 1"},
                                                        {"modes 2", "modes -2"},
                                                        {"modes 2", "modes 4000000000000"},
                                                        {"ranks 2", "ranks 99999999999999999999"},
                                                        {"shifts 2", "shifts 1"},
                                                        {"40.5", "nan"},
                                                        {"40.5", "inf"},
                                                        {"end\n", ""}}) {
    EXPECT_NE(refused(with(kGood, from, to)), "") << from << " -> " << to;
  }
  EXPECT_EQ(refused(kGood), "");
}

TEST_F(Replies, OfTheWrongSizeAreRefused) {
  for (const std::size_t numbers : {0U, 5U, 7U}) {
    EXPECT_NE(refused(kGood, numbers).find("bytes"), std::string::npos) << numbers;
  }
  write(kGood);
  fs::remove(folder_ / "corrections.petsc");
  EXPECT_NE(refusal_of([&] { return read_reply(folder_, 3); }), "");
  write(kGood);
  fs::remove(folder_ / "reply.txt");
  EXPECT_NE(refusal_of([&] { return read_reply(folder_, 3); }), "");
}

// Whatever becomes of the text, it is read or refused.
TEST_F(Replies, OfAnyTextAreReadOrRefused) {
  std::mt19937 draw(7);
  int refusals = 0;
  for (int i = 0; i < 500; ++i) {
    std::string text = kGood;
    for (int change = 0; change < 3; ++change) {
      const auto at = draw() % text.size();
      if (draw() % 2 == 0) {
        text[at] = static_cast<char>(' ' + draw() % 90);
      } else {
        text.erase(at, 1 + draw() % 20);
      }
    }
    refusals += refused(text).empty() ? 0 : 1;
  }
  EXPECT_GT(refusals, 300);
}

}  // namespace
}  // namespace chladni::cluster
