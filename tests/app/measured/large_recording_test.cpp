// Recordings that are larger than a stated memory, read in pieces by the program.
#include <sys/resource.h>
#include <sys/wait.h>

#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

/// What reading may take is half of it, and a quarter of that is less than any file here.
constexpr const char* kMemory = "0.004";  // GB

class LargeRecording : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    write("small.toml", study("small.csv"));
    write("large.toml", study("large.csv"));
    ASSERT_EQ(run({"simulate", "small.toml", "-o", "small", "--no-pictures"}).status, 0);
    recorded_ = whole(folder_ / "small" / "time_data.csv");
    fs::rename(folder_ / "small" / "time_data.csv", folder_ / "small.csv");
  }

  static std::string study(const std::string& file) {
    auto text = whole(fs::path(CHLADNI_SOURCE_DIR) / "models/recordings/open_loop.toml");
    const std::string time = "open_loop/time_data.csv";
    return text.replace(text.rfind(time), time.size(), file);
  }

  // The four realisations so many times, as further ones.
  void write_large(int times) const {
    std::ofstream out(folder_ / "large.csv");
    const auto head = recorded_.find('\n') + 1;
    out << recorded_.substr(0, head);
    for (int first = 0; first < 4 * times; first += 4) {
      for (std::size_t at = head; at < recorded_.size();) {
        const auto time = recorded_.find(',', at);
        const auto experiment = recorded_.find(',', time + 1);
        const auto realisation = recorded_.find(',', experiment + 1);
        const auto end = recorded_.find('\n', realisation) + 1;
        out << std::string_view(recorded_).substr(at, experiment + 1 - at)
            << first + std::stoi(recorded_.substr(experiment + 1, realisation - experiment - 1))
            << std::string_view(recorded_).substr(realisation, end - realisation);
        at = end;
      }
    }
  }

  static std::vector<std::string> in_pieces(const std::string& study, const std::string& out) {
    return {"identify",       study,  "-o", out, "--no-pictures", "--reproducible",
            "--memory-limit", kMemory};
  }

  // The largest resident memory of a run [bytes].
  [[nodiscard]] std::uintmax_t peak_of(const std::vector<std::string>& arguments) const {
    const pid_t child = started(arguments, "", [] { setenv("OPENBLAS_NUM_THREADS", "1", 1); });
    int status = 0;
    rusage used{};
    EXPECT_EQ(wait4(child, &status, 0, &used), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << whole(folder_ / "stderr");
    return static_cast<std::uintmax_t>(used.ru_maxrss) * 1024;
  }

  [[nodiscard]] io::Json identified(const std::string& out) const {
    return io::parse_json(whole(folder_ / out / "identified.json"));
  }

  std::string recorded_;
};

TEST_F(LargeRecording, HasTheBitsOfTheWhole) {
  ASSERT_EQ(
      run({"identify", "small.toml", "-o", "whole", "--no-pictures", "--reproducible"}).status, 0);
  const auto pieces = run(in_pieces("small.toml", "pieces"));
  ASSERT_EQ(pieces.status, 0) << pieces.err;
  EXPECT_TRUE(says(pieces.err, "small.csv: it is read in pieces"));
  EXPECT_TRUE(says(pieces.err, "no part of it is left out in turn"));
  for (const char* part : {"modes", "data_quality"}) {
    EXPECT_EQ(text(identified("pieces").at(part)), text(identified("whole").at(part)));
  }
}

TEST_F(LargeRecording, NeedsNoMoreMemoryForMoreRealisations) {
  const auto small = peak_of(in_pieces("small.toml", "small"));
  write_large(8);
  const auto more = fs::file_size(folder_ / "large.csv") - recorded_.size();
  const auto large = peak_of(in_pieces("large.toml", "large"));
  EXPECT_LT(large, small + more / 4) << "a file that is larger by " << more << " bytes";
}

// What is wrong far inside is told with its line, and nothing is written.
TEST_F(LargeRecording, IsRefusedWithTheLineOfWhatIsWrong) {
  write_large(1);
  std::ofstream(folder_ / "large.csv", std::ios::app) << "0,0,9999,0,1,2,word\n";
  const auto refused = run(in_pieces("large.toml", "large"));
  EXPECT_EQ(refused.status, 3) << refused.err;
  EXPECT_TRUE(says(refused.err, "large.csv: line "));
  EXPECT_TRUE(says(refused.err, "found 'word', expected a number"));
  EXPECT_FALSE(fs::exists(folder_ / "large" / "identified.json"));
}

TEST_F(LargeRecording, NeedsAFolderForItsScratchFile) {
  const auto refused = ended(
      started(in_pieces("small.toml", "small"), "", [] { setenv("TMPDIR", "/there/is/none", 1); }));
  EXPECT_EQ(refused.status, 5) << refused.err;
  EXPECT_TRUE(says(refused.err, "a scratch file in /there/is/none cannot be made"));
  EXPECT_TRUE(says(refused.err, "set TMPDIR"));
}

}  // namespace
}  // namespace chladni::app
