// chladni new: what it writes is a study that chladni check accepts.
#include "host/shell_word.h"
#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class New : public CommandLine {
 protected:
  std::string text(const std::string& file) const { return whole(folder_ / file); }
  Ended checked(const std::string& file) const { return run({"check", file, "-o", "out"}); }

  // A slab with a step: 60 x 40 mm, 8 mm high and 14 mm at x above 40 mm, as a text STL.
  void write_stl() const {
    const double z[2] = {8.0, 14.0};
    std::ostringstream out;
    out << "solid part\n";
    const auto quad = [&](const std::array<std::array<double, 3>, 4>& p) {
      for (const auto& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        out << "facet normal 0 0 0\nouter loop\n";
        for (const int i : t) {
          const auto& v = p[static_cast<std::size_t>(i)];
          out << "vertex " << v[0] << " " << v[1] << " " << v[2] << "\n";
        }
        out << "endloop\nendfacet\n";
      }
    };
    const double x[3] = {0.0, 40.0, 60.0};
    for (int part = 0; part < 2; ++part) {
      const double a = x[part];
      const double b = x[part + 1];
      const double h = z[part];
      quad({{{a, 0, h}, {b, 0, h}, {b, 40, h}, {a, 40, h}}});
      quad({{{a, 0, 0}, {a, 40, 0}, {b, 40, 0}, {b, 0, 0}}});
      quad({{{a, 0, 0}, {b, 0, 0}, {b, 0, std::min(h, 8.0)}, {a, 0, std::min(h, 8.0)}}});
      quad({{{a, 40, 0}, {a, 40, std::min(h, 8.0)}, {b, 40, std::min(h, 8.0)}, {b, 40, 0}}});
    }
    quad({{{40, 0, 8}, {60, 0, 8}, {60, 0, 14}, {40, 0, 14}}});
    quad({{{40, 40, 8}, {40, 40, 14}, {60, 40, 14}, {60, 40, 8}}});
    quad({{{0, 0, 0}, {0, 0, 8}, {0, 40, 8}, {0, 40, 0}}});
    quad({{{60, 0, 0}, {60, 40, 0}, {60, 40, 8}, {60, 0, 8}}});
    quad({{{60, 0, 8}, {60, 40, 8}, {60, 40, 14}, {60, 0, 14}}});
    quad({{{40, 0, 8}, {40, 0, 14}, {40, 40, 14}, {40, 40, 8}}});
    out << "endsolid part\n";
    write("part.stl", out.str());
  }
};

// The command of a name with a blank was two words.
TEST_F(New, NamesACommandThatAShellTakes) {
  EXPECT_EQ(shell_word("a/b-1.toml"), "a/b-1.toml");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
  const auto done = run({"new", "beam", "-o", "my beam.toml"});
  EXPECT_TRUE(says(done.out, "chladni check 'my beam.toml'")) << done.out << done.err;
  EXPECT_TRUE(says(text("my beam.toml"), "chladni modes 'my beam.toml'"));
}

TEST_F(New, WritesEachBodySoThatCheckAcceptsIt) {
  for (const std::string kind : {"beam", "plate", "disc", "wafer_table"}) {
    const auto done = run({"new", kind});
    ASSERT_EQ(done.status, 0) << done.err;
    EXPECT_TRUE(says(done.out, "chladni check " + kind + ".toml"));
    const auto check = checked(kind + ".toml");
    EXPECT_EQ(check.status, 0) << check.err;
    EXPECT_FALSE(says(check.err, "warning")) << check.err;
    const auto study = io::parse_json(text("out/study.json"));
    EXPECT_GE(study.at("sensors").array().size(), 3U);
    EXPECT_GE(study.at("actuators").array().size(), 3U);
    EXPECT_TRUE(says(text(kind + ".toml"), "aluminium 6061"));
  }
}

TEST_F(New, PutsSensorsOntoAPartAndTellsOfIt) {
  write_stl();
  const auto done = run({"new", "stage.toml", "--from", "part.stl", "--unit", "mm"});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto study = text("stage.toml");
  EXPECT_TRUE(says(study, "file = \"part.stl\", unit = \"mm\""));
  EXPECT_TRUE(says(study, "x 0 to 60, y 0 to 40, z 0 to 14 mm"));
  EXPECT_TRUE(says(study, "looks along"));
  EXPECT_TRUE(says(study, "#   bottom"));
  const auto check = checked("stage.toml");
  EXPECT_EQ(check.status, 0) << check.err;
  const auto json = io::parse_json(text("out/study.json"));
  EXPECT_EQ(json.at("sensors").array().size(), 4U);
}

TEST_F(New, APartMayHaveAnyName) {
  write_stl();
  const std::string name = "a \"good\" part\\one.stl";
  fs::rename(folder_ / "part.stl", folder_ / name);
  const auto done = run({"new", "stage.toml", "--from", name, "--unit", "mm"});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto check = checked("stage.toml");
  EXPECT_EQ(check.status, 0) << check.err;
  const auto json = io::parse_json(text("out/study.json"));
  EXPECT_EQ(json.at("study").at("title").string(), "a \"good\" part\\one");
}

TEST_F(New, AsksForAUnitWhereTheFileStatesNone) {
  write_stl();
  const auto done = run({"new", "stage.toml", "--from", "part.stl"});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "expected --unit, such as --unit mm"));
  EXPECT_FALSE(fs::exists(folder_ / "stage.toml"));
}

TEST_F(New, OverwritesNothing) {
  write("plate.toml", "mine");
  const auto done = run({"new", "plate"});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "is there already and stays"));
  EXPECT_EQ(text("plate.toml"), "mine");
  EXPECT_EQ(run({"new", "plate", "-o", "other.toml"}).status, 0);
}

TEST_F(New, RefusesWhatItCannotMean) {
  const auto refused = [&](const std::vector<std::string>& words, const std::string& what) {
    const auto done = run(words);
    EXPECT_EQ(done.status, 3) << what;
    EXPECT_TRUE(says(done.err, what));
  };
  refused({"new", "stage.toml"}, "of what body? expected --from part.step, or one of");
  refused({"new", "stage.toml", "--from", "none.step"}, "there is no such file");
  refused({"new", "plate", "-o", "plate.txt"}, "does not end in .toml");
  write("part.stl", "solid nothing\nendsolid nothing\n");
  refused({"new", "stage.toml", "--from", "part.stl", "--unit", "mm"}, "part.stl");
  fs::create_directories(folder_ / "sub");
  write_stl();
  refused({"new", "sub/stage.toml", "--from", "part.stl", "--unit", "mm"},
          "is not below the folder");
  EXPECT_EQ(left("sub").size(), 0U);
}

// ---- what all verbs say

TEST_F(New, ErrorsOfAStudyShowTheirLine) {
  const auto file = write("study.toml", "title = \"a\"\nmodes = { cuont = 3 }\n").string();
  const auto done = run({"check", file});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "\n  2 | modes = { cuont = 3 }\n    |           ^")) << done.err;
  const auto json = io::parse_json(run({"check", file, "--json"}).out);
  EXPECT_EQ(json.at("error").at("exit").number(), 3.0);
  EXPECT_FALSE(says(run({"check", file, "--quiet"}).err, "  2 | "));
}

}  // namespace
}  // namespace chladni::app
