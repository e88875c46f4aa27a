// The program with readers that do harm in the place of its own.
#include <csignal>
#include <cstdlib>

#include "host/confinement.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class ConfinedReader : public CommandLine {
 protected:
  void SetUp() override {
    const auto support = confinement_support();
    if (support.landlock == 0 || !support.has_filter) GTEST_SKIP() << support.text();
    CommandLine::SetUp();
    fs::create_directories(folder_ / "readers");
    for (const char* name : {"chladni-mat", "chladni-vtu", "chladni-step", "chladni-tetgen"}) {
      fs::create_symlink(CHLADNI_PROBE_PROGRAM, folder_ / "readers" / name);
    }
    write("a.mat", "MATLAB 5.0");
    write("a.vtu", "<VTKFile>");
    write("a.step", "ISO-10303-21;");
    write("secret", "secret");
  }

  Ended with(const char* deed, const std::vector<std::string>& arguments) const {
    return ended(started(arguments, "", [&] {
      setenv("CHLADNI_LIBEXEC", (folder_ / "readers").c_str(), 1);
      setenv("CHLADNI_PROBE", deed, 1);
      setenv("CHLADNI_PROBE_FILE", (folder_ / "secret").c_str(), 1);
    }));
  }
};

TEST_F(ConfinedReader, IsStoppedWithASentenceAndASix) {
  const std::string study = R"(
geometry = { file = "a.step", unit = "mm" }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
)";
  write("study.toml", study);
  for (const char* deed : {"socket", "fork", "shell", "signal"}) {
    for (const auto& arguments :
         std::vector<std::vector<std::string>>{{"check", "a.mat"},
                                               {"convert", "a.vtu", "b.stl", "--unit", "mm"},
                                               {"check", "study.toml"}}) {
      const bool is_step = arguments.back() == "study.toml";
      if (is_step && !fs::exists(CHLADNI_BINARY_DIR "/bin/chladni-step")) continue;  // optional
      const auto end = with(deed, arguments);
      EXPECT_EQ(end.status, 6) << deed << ": " << end.err;
      EXPECT_TRUE(says(end.err, "was stopped: it tried what no reader of a file may do"));
    }
  }
  EXPECT_TRUE(says(with("socket", {"check", "a.mat"}).err, "a.mat: chladni-mat was stopped"));
}

TEST_F(ConfinedReader, ReadsNoOtherFile) {
  for (const char* deed : {"read", "write", "remove"}) {
    const auto end = with(deed, {"check", "a.mat"});
    EXPECT_EQ(end.status, 3) << end.err;
    EXPECT_TRUE(says(end.err, "refused: Permission denied")) << deed;
  }
  EXPECT_EQ(whole(folder_ / "secret"), "secret");
}

}  // namespace
}  // namespace chladni::app
