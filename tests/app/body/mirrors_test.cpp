// modes.mirrors of a study: everything after the modes is as without.
#include <cmath>

#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class MirrorsOfAStudy : public CommandLine {
 protected:
  static std::string plate(const std::string& modes, const std::string& more = "") {
    auto text = std::string(kPlate);
    text.replace(text.find("count = 4"), 9, modes);
    return text + more;
  }

  Ended ended_modes(const std::string& modes, const std::string& out, const std::string& more = "",
                    const std::string& verb = "modes") {
    const auto study = write(out + ".toml", plate(modes, more)).string();
    return run({verb, study, "-o", out, "--no-pictures", "--no-cache"});
  }

  io::Json left_in(const std::string& out, const std::string& file) {
    return io::parse_json(whole(folder_ / out / file));
  }
};

TEST_F(MirrorsOfAStudy, GiveTheSameModesAndFiles) {
  ASSERT_EQ(ended_modes("count = 9", "whole").status, 0);
  const auto ended = ended_modes("count = 9, mirrors = [\"x\", \"y\"]", "parts");
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(says(ended.out, "in 4 classes of symmetry)"));
  EXPECT_EQ(left("whole"), left("parts"));
  const auto whole_modes = left_in("whole", "modes.json");
  const auto parts = left_in("parts", "modes.json");
  const auto& hz = parts.at("frequency_hz").array();
  ASSERT_EQ(hz.size(), whole_modes.at("frequency_hz").array().size());
  for (std::size_t i = 6; i < hz.size(); ++i) {
    EXPECT_NEAR(hz[i].number() / whole_modes.at("frequency_hz").array()[i].number(), 1.0, 1e-9);
    EXPECT_NEAR(parts.at("sensors").at("s1").array()[i].number(),
                whole_modes.at("sensors").at("s1").array()[i].number(), 1e-6);
    EXPECT_NEAR(parts.at("frequency_error_hz").array()[i].number() /
                    whole_modes.at("frequency_error_hz").array()[i].number(),
                1.0, 1e-6);
  }
}

TEST_F(MirrorsOfAStudy, GiveTheSamePlacement) {
  const std::string placement = "[placement]\nmodes = [1, 2, 3]\n";
  ASSERT_EQ(ended_modes("count = 4", "whole", placement, "place").status, 0);
  const auto ended = ended_modes("count = 4, mirrors = [\"y\"]", "parts", placement, "place");
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(left("whole"), left("parts"));
}

TEST_F(MirrorsOfAStudy, GiveTheModesUpToAFrequency) {
  ASSERT_EQ(ended_modes("up_to = \"12 kHz\"", "whole").status, 0);
  ASSERT_EQ(ended_modes("up_to = \"12 kHz\", mirrors = [\"x\", \"y\"]", "parts").status, 0);
  EXPECT_EQ(left_in("parts", "modes.json").at("frequency_hz").array().size(),
            left_in("whole", "modes.json").at("frequency_hz").array().size());
}

TEST_F(MirrorsOfAStudy, ThatAreNoneAreRefused) {
  const std::string mass =
      "[[attachment]]\nname = \"lump\"\nkind = \"mass\"\nat = [\"-40 mm\", \"0 mm\"]\n"
      "mass = \"20 g\"\n";
  const auto lopsided = ended_modes("count = 4, mirrors = [\"x\"]", "out", mass);
  EXPECT_EQ(lopsided.status, 3);
  EXPECT_TRUE(says(lopsided.err, "modes.mirrors has \"x\", but the body is not its own mirror "));
  EXPECT_TRUE(says(lopsided.err, "\"lump\""));
  EXPECT_EQ(ended_modes("count = 4, mirrors = [\"y\"]", "out", mass).status, 0);
}

TEST_F(MirrorsOfAStudy, AreNamesOfAxesOnceAndWithoutRanks) {
  const auto refusal = [&](const std::string& modes) {
    const auto ended = run({"check", write("study.toml", plate(modes)).string(), "-o", "out"});
    EXPECT_EQ(ended.status, 3) << modes;
    return ended.err;
  };
  EXPECT_TRUE(says(refusal("count = 4, mirrors = [\"w\"]"), "modes.mirrors names \"w\""));
  EXPECT_TRUE(says(refusal("count = 4, mirrors = [\"x\", \"x\"]"), "names an axis twice"));
  EXPECT_TRUE(says(refusal("count = 4, mirrors = [\"x\"], engine = \"mpiexec -n 2\""),
                   "the ranks take the whole body"));
  const auto study = write("study.toml", plate("count = 4, mirrors = [\"x\"]")).string();
  const auto ended = run({"modes", study, "-o", "out", "--engine", "mpiexec -n 2"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(says(ended.err, "leave out modes.mirrors or the engine"));
}

}  // namespace
}  // namespace chladni::app
