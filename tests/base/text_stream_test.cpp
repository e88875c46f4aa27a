#include "base/text_stream.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/failing_new.h"

namespace chladni {
namespace {

// Longer than what a string holds without an allocation.
const std::string kLine = "a line that is longer than the room within a string";

std::vector<std::string> lines_of(const std::string& text) {
  TextReader reader(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(reader, line);) lines.push_back(line);
  return lines;
}

TEST(TextReader, ReadsAllLinesOrLacksMemory) {
  const std::string text = kLine + "\n" + kLine + kLine + "\n" + kLine + kLine + kLine;
  const auto failures = without_memory(1000, 1, [&] { EXPECT_EQ(lines_of(text).size(), 3U); });
  EXPECT_GT(failures, 3);
}

TEST(TextReader, ReadsAllNumbersOrLacksMemory) {
  const auto failures = without_memory(1000, 1, [] {
    TextReader reader("0.002 12.25 0.00000000000000000000000000000000000000001 7");
    int count = 0;
    for (double number = 0.0; reader >> number;) ++count;
    EXPECT_EQ(count, 4);
  });
  EXPECT_GT(failures, 0);
}

TEST(TextWriter, HoldsAllTextOrLacksMemory) {
  const auto failures = without_memory(1000, 1, [] {
    TextWriter writer;
    for (int i = 0; i < 100; ++i) writer << kLine;
    EXPECT_EQ(writer.str().size(), 100 * kLine.size());
  });
  EXPECT_GT(failures, 3);
}

}  // namespace
}  // namespace chladni
