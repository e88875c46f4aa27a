// Letters beyond ASCII in the text of a study.
#include <gtest/gtest.h>

#include <string>

#include "study/toml/toml_tree.h"
#include "tests/refusal.h"

namespace chladni::study {
namespace {

std::string refused(const std::string& text) {
  return refusal_of([&] { return parse_toml(text, "s.toml"); });
}

// toml++ 3.3 is undefined for these where it expects a blank.
TEST(Letters, OutsideOfTextsAndCommentsAreRefusedWithTheirPlace) {
  EXPECT_NE(refused("ü = 1\n").find("s.toml:1:1: 'ü' stands outside of a text"), std::string::npos);
  EXPECT_NE(refused("a = 1\nb = 2 é\n").find("s.toml:2:7: 'é'"), std::string::npos);
  EXPECT_NE(refused("a = \"ä\" ö\n").find("s.toml:1:9: 'ö'"), std::string::npos);
  EXPECT_NE(refused("mass\uFEBB = 1\n").find("s.toml:1:5: '\uFEBB'"), std::string::npos);
  EXPECT_NE(refused("a = \"x\\\\\" ü\n").find("s.toml:1:11: 'ü'"), std::string::npos);
}

TEST(Letters, InTextsAndCommentsAreRead) {
  const std::string text =
      "\uFEFF# Größe\na = \"µm \\\" ü\" # é\nb = 'ä \\'\n\"ö\" = 1\nc = \"\"\"one\n\" ü \"\" "
      "é\"\"\"\n"
      "d = '''ü\n'' é'''\n[t.'ß']\n";
  const auto tree = parse_toml(text, "s.toml");
  ASSERT_EQ(tree.members.size(), 6U);
  EXPECT_EQ(tree.members[0].value.text, "µm \" ü");
  EXPECT_EQ(tree.members[1].value.text, "ä \\");
  EXPECT_EQ(tree.members[2].key, "ö");
  EXPECT_EQ(tree.members[3].value.text, "one\n\" ü \"\" é");
  EXPECT_EQ(tree.members[4].value.text, "ü\n'' é");
}

// What does not end is refused by the parser, as before.
TEST(Letters, InATextThatDoesNotEndAreNotTheFault) {
  for (const auto* text :
       {"a = \"ü", "a = \"ü\nb = 1\n", "a = '''ü", "a = \"\"\"ü\\", "w=+:::[\"\"\"-\":ƛ"}) {
    const auto said = refused(text);
    EXPECT_FALSE(said.empty()) << text;
    EXPECT_EQ(said.find("stands outside"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace chladni::study
