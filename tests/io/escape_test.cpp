#include "io/bytes/escape.h"

#include <gtest/gtest.h>

#include <random>

#include "io/json.h"

namespace chladni::io {
namespace {

TEST(Escape, NothingOpensOrClosesAnElementOrAnAttribute) {
  EXPECT_EQ(escaped("</script><img src=x onerror='a' b=\"c\">&`"),
            "&lt;/script&gt;&lt;img src=x onerror=&#39;a&#39; b=&quot;c&quot;&gt;&amp;&#96;");
}

TEST(Escape, RandomBytesComeOutAsValidUtf8WithoutMarkup) {
  std::mt19937 random(11);
  for (int round = 0; round < 2000; ++round) {
    std::string bytes(1 + random() % 40, ' ');
    for (char& c : bytes) c = static_cast<char>(random() % 256);
    const std::string text = escaped(bytes);
    EXPECT_EQ(valid_utf8(text), text);
    EXPECT_EQ(text.find_first_of("<>\"'`"), std::string::npos);
    EXPECT_EQ(text.find('\0'), std::string::npos);
  }
}

TEST(Escape, KeepsWhatIsUtf8) {
  const std::string text = "Prüfstand µm 平台 \xF0\x9F\x98\x80";
  EXPECT_EQ(escaped(text), text);
}

TEST(Escape, ScriptSafeJsonMeansTheSame) {
  const std::string name = "</script><!--&\xE2\x80\xA8\xE2\x80\xA9";
  const std::string safe = script_safe(text(Json(name)));
  EXPECT_EQ(safe.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(safe.find("\xE2\x80"), std::string::npos);
  EXPECT_EQ(parse_json(safe).string(), name);
}

TEST(Escape, Base64AgreesWithTheStandardsTestVectors) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string_view("\0\xFF\x80", 3)), "AP+A");
}

}  // namespace
}  // namespace chladni::io
