// However the program ends: it says why, and leaves nothing running.
#include <pty.h>
#include <sys/resource.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <thread>

#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

using namespace std::chrono_literals;

// --- Whatever is thrown ends in a sentence.

class Thrown : public CommandLine {
 protected:
  void ends_in_a_sentence(const std::vector<std::string>& arguments,
                          const std::string& part) const {
    const auto ended = run(arguments);
    EXPECT_EQ(ended.status, 3) << ended.err;
    EXPECT_TRUE(says(ended.err, "error: "));
    EXPECT_TRUE(says(ended.err, part));
    EXPECT_FALSE(says(ended.err, "terminate called"));
  }
  [[nodiscard]] std::string measured_in(const std::string& file) const {
    return write("study.toml", std::string(kPlate) + "[measurement]\nfrf = \"" + file + "\"\n")
        .string();
  }
};

TEST_F(Thrown, ByANameThatIsTooLong) {
  const std::string name(300, 'n');
  ends_in_a_sentence({"check", measured_in(name + ".csv")}, "measurement.frf");
  ends_in_a_sentence({"check", name + ".toml"}, "File name too long");
  ends_in_a_sentence({"check", name + ".csv"}, "File name too long");
  ends_in_a_sentence({"convert", name + ".mat", "out.csv"}, "File name too long");
  ends_in_a_sentence({"check", write("good.toml", kPlate).string(), "-o", name},
                     "File name too long");
}

TEST_F(Thrown, ByALoopOfLinks) {
  fs::create_symlink("b", folder_ / "a");
  fs::create_symlink("a", folder_ / "b");
  ends_in_a_sentence({"check", measured_in("a")}, "Too many levels of symbolic links");
  ends_in_a_sentence({"check", "a"}, "Too many levels of symbolic links");
  ends_in_a_sentence({"modes", measured_in("a/b.csv")}, "measurement.frf");
  fs::create_symlink("d.vtu", folder_ / "c.vtu");
  fs::create_symlink("c.vtu", folder_ / "d.vtu");
  ends_in_a_sentence({"convert", "c.vtu", "out.stl"}, "c.vtu");
  ends_in_a_sentence({"check", write("good.toml", kPlate).string(), "-o", "a"}, "a");
}

// --- A worker that is not what it should be is six, and is named.

class FalseWorker : public CommandLine {
 protected:
  Ended run_with(const std::string& worker, const std::string& script,
                 const std::vector<std::string>& arguments) const {
    fs::create_directories(folder_ / "false");
    std::ofstream(folder_ / "false" / worker) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(folder_ / "false" / worker, fs::perms::owner_all);
    return ended(started(arguments, "", [&] {
      setenv("CHLADNI_LIBEXEC", (folder_ / "false").c_str(), 1);
      const rlimit memory = {std::size_t{2} << 30U, std::size_t{2} << 30U};
      if (kAddressesMayBeLimited) setrlimit(RLIMIT_AS, &memory);
    }));
  }
  [[nodiscard]] std::string by_tetgen() const {
    std::string text = kPlate;
    text.replace(text.find("order = 2"), 9, "order = 2, mesher = \"tetgen\"");
    return write("study.toml", text).string();
  }
};

TEST_F(FalseWorker, ThatBabblesIsSix) {
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer needs all addresses";
  write("some.mat", "content");
  write("some.vtu", "content");
  write("some.step", "ISO-10303-21;");
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"chladni-tetgen", {"mesh", by_tetgen()}},
      {"chladni-mat", {"check", "some.mat"}},
      {"chladni-vtu", {"convert", "some.vtu", "out.stl"}},
      {"chladni-step", {"convert", "some.step", "out.stl", "--unit", "mm"}}};
  for (const auto& [worker, arguments] : cases) {
    if (!fs::exists(fs::path(CHLADNI_BINARY_DIR "/bin") / worker)) continue;  // STEP is optional
    for (const auto* script : {"exec yes", "echo nonsense", "exit 0"}) {
      const auto ended = run_with(worker, script, arguments);
      EXPECT_EQ(ended.status, 6) << worker << ", " << script << "\n" << ended.err;
      const bool mesher = worker == "chladni-tetgen" && std::string(script) != "exec yes";
      EXPECT_TRUE(says(ended.err, mesher ? "the mesher's answer" : worker));
      EXPECT_FALSE(says(ended.err, "choose a longer mesh.edge_length"));
    }
  }
}

TEST_F(FalseWorker, ThatPaintsNothingIsAWarning) {
  for (const auto* script : {"exec yes", "echo nonsense", "exit 0", "kill -SEGV $$"}) {
    const auto ended = run_with("chladni-painter", script,
                                {"study", write("study.toml", kPlate).string(), "-o", "out"});
    EXPECT_EQ(ended.status, 0) << script << "\n" << ended.err;
    EXPECT_TRUE(says(ended.err, "modes.png is not painted: chladni-painter"));
    EXPECT_TRUE(says(ended.err, "--no-pictures"));
    EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));
    EXPECT_FALSE(fs::exists(folder_ / "out/modes.png"));
  }
}

// A sweep of hours ended in an error, without its result, when the painter failed.
TEST_F(FalseWorker, ThatPaintsNoSweepIsAWarning) {
  write("base.toml", kPlate);
  const auto plan =
      write("plan.toml",
            "base = \"base.toml\"\n[[axis]]\nkey = \"geometry.plate.thickness\"\n"
            "values = [\"5 mm\", \"6 mm\"]\n"
            "[[result]]\nname = \"first\"\nfile = \"modes.json\"\nat = \"frequency_hz.6\"\n");
  for (const auto* verb : {"sweep", "gather"}) {
    const auto ended =
        run_with("chladni-painter", "exit 0", {verb, plan.string(), "-o", "out", "--json"});
    EXPECT_EQ(ended.status, 0) << verb << "\n" << ended.err;
    EXPECT_TRUE(says(ended.err, "warning: sweep.png is not painted: chladni-painter"));
    EXPECT_EQ(io::parse_json(ended.out).at("done").number(), 2.0);
    EXPECT_FALSE(fs::exists(folder_ / "out/sweep.png"));
  }
}

// --- What a parent leaves behind.

TEST_F(CommandLine, ClosedStreamsAreNoHindranceToWorkers) {
  for (const int closed : {STDIN_FILENO, STDERR_FILENO}) {
    const auto doctor = ended(started({"doctor"}, "", [&] { close(closed); }));
    EXPECT_EQ(doctor.status, run({"doctor"}).status) << doctor.out;
    EXPECT_FALSE(says(doctor.out, "will not work")) << closed;
  }
}

TEST_F(CommandLine, AClosedOutputIsSaidAndNoFileGetsWhatIsPrinted) {
  const auto study = write("study.toml", kPlate).string();
  const auto modes = ended(
      started({"modes", study, "-o", "out", "--no-pictures"}, "", [] { close(STDOUT_FILENO); }));
  EXPECT_EQ(modes.status, 5) << modes.err;
  EXPECT_TRUE(says(modes.err, "error: cannot write to the standard output"));
  EXPECT_LT(whole(folder_ / "out/.chladni.lock").size(), 20U);  // a number of a process
}

TEST_F(CommandLine, AParentThatIgnoresSigchldHidesNoEnd) {
  const auto doctor = ended(started({"doctor"}, "", [] { std::signal(SIGCHLD, SIG_IGN); }));
  EXPECT_EQ(doctor.status, run({"doctor"}).status) << doctor.out;
  EXPECT_FALSE(says(doctor.out, "will not work"));
}

// --- A terminal.

// What a program writes to a terminal of its own.
std::string on_a_terminal(const std::vector<std::string>& arguments, const fs::path& folder) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(99);
    std::string program = CHLADNI_BINARY_DIR "/bin/chladni";
    std::vector<std::string> words = arguments;
    std::vector<char*> argv = {program.data()};
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(98);
  }
  std::string said;
  std::array<char, 4096> block{};
  for (ssize_t count = 0; (count = read(terminal, block.data(), block.size())) > 0;) {
    said.append(block.data(), static_cast<std::size_t>(count));
  }
  close(terminal);
  waitpid(child, nullptr, 0);
  return said;
}

// What stands on the last line once it was overwritten.
std::string last_line_seen(const std::string& said) {
  std::string line = said.substr(said.find_last_of('\n') + 1);
  const std::string cleared = "\r\033[K";
  if (const auto at = line.rfind(cleared); at != line.npos) line = line.substr(at + cleared.size());
  return line;
}

TEST_F(CommandLine, OnATerminalTheProgressLineIsGoneAtTheEnd) {
  const auto study = write("study.toml", kPlate).string();
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"modes", study, "-o", "out"},
        {"study", study, "-o", "out"},
        {"modes", study, "-o", "out", "--json"},
        {"identify", study, "-o", "out"}}) {
    const std::string said = on_a_terminal(arguments, folder_);
    if (arguments.front() != "identify") EXPECT_TRUE(says(said, "\r\033[K")) << "no progress drawn";
    EXPECT_EQ(last_line_seen(said), "") << arguments.front();
  }
}

// The reader of its output is slow, so that the program still waits for it when Ctrl-C comes.
TEST_F(CommandLine, ALateCtrlCIsNoSuccess) {
  const auto study = write("study.toml", kPlate);
  int pipe[2] = {};
  ASSERT_EQ(::pipe(pipe), 0);
  const int room = fcntl(pipe[1], F_SETPIPE_SZ, 4096);
  ASSERT_EQ(::write(pipe[1], std::string(static_cast<std::size_t>(room), ' ').data(),
                    static_cast<std::size_t>(room)),
            room);
  const pid_t child = started({"modes", study.string(), "-o", "out", "--no-pictures", "--json"}, "",
                              [&] { dup2(pipe[1], STDOUT_FILENO); });
  for (int i = 0; i < 3000 && !fs::exists(folder_ / "out/modes.json"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  kill(child, SIGINT);
  close(pipe[1]);
  std::string read(4096, ' ');
  while (::read(pipe[0], read.data(), read.size()) > 0) {
  }
  close(pipe[0]);
  const auto modes = ended(child);
  EXPECT_EQ(modes.status, 130) << modes.err;
  EXPECT_TRUE(says(modes.err, "stopped by Ctrl-C"));
}

// --- Nothing is left running.

// Processes that have inherited `mark`, by number, with their names.
std::map<pid_t, std::string> marked(const std::string& mark) {
  std::map<pid_t, std::string> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string number = entry.path().filename().string();
    if (number.find_first_not_of("0123456789") != number.npos) continue;
    if (whole(entry.path() / "environ").find(mark) == std::string::npos) continue;
    std::string name = whole(entry.path() / "comm");
    if (name.ends_with('\n')) name.pop_back();
    found[static_cast<pid_t>(std::stol(number))] = name;
  }
  return found;
}

bool includes(const std::map<pid_t, std::string>& processes, const std::string& name) {
  return std::any_of(processes.begin(), processes.end(),
                     [&](const auto& one) { return one.second == name; });
}

template <class Condition>
bool comes_true(Condition condition, std::chrono::seconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

class Killed : public CommandLine, public testing::WithParamInterface<int> {};

TEST_P(Killed, WhilePaintingLeavesNoDisplayAndNoFolder) {
  if (std::system("command -v Xvfb >/dev/null") != 0) GTEST_SKIP() << "there is no Xvfb here";
  const auto study = write("study.toml", kPlate).string();
  fs::create_directories(folder_ / "tmp");
  const std::string mark = "CHLADNI_TEST_MARK=" + folder_.string() + "_";
  const pid_t child = started({"modes", study, "-o", "out"}, "", [&] {
    setsid();
    putenv(const_cast<char*>(mark.c_str()));
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
  });
  ASSERT_TRUE(comes_true([&] { return includes(marked(mark), "Xvfb"); }, 60s));
  const auto display = marked(mark);
  kill(child, GetParam());
  const auto over = ended(child);
  EXPECT_EQ(over.status, GetParam() == SIGKILL ? 128 + SIGKILL : 130) << over.err;
  EXPECT_TRUE(comes_true([&] { return marked(mark).empty(); }, 20s));
  for (const auto& [process, name] : marked(mark)) ADD_FAILURE() << name << " is still there";
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp"));
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/tmp", ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(".X") || !name.ends_with("-lock")) continue;
    const auto holder = std::strtol(whole(entry.path()).c_str(), nullptr, 10);
    EXPECT_FALSE(display.contains(static_cast<pid_t>(holder))) << entry.path();
  }
}

INSTANTIATE_TEST_SUITE_P(By, Killed, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGKILL),
                         [](const auto& one) { return std::string(sigabbrev_np(one.param)); });

TEST_F(CommandLine, ATemporaryFolderThatIsNotThereIsNoFault) {
  if (std::system("command -v Xvfb >/dev/null") != 0) GTEST_SKIP() << "there is no Xvfb here";
  const auto study = write("study.toml", kPlate).string();
  const auto modes =
      ended(started({"modes", study, "-o", "out"}, "", [] { setenv("TMPDIR", "/nowhere", 1); }));
  EXPECT_EQ(modes.status, 0) << modes.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/modes.png")) << modes.err;
}

// Nothing was counted, which is not "none was found": a reader would take 0 of 0 for certified.
TEST_F(CommandLine, WithoutACountTheCertificateIsNotKnown) {
  const auto study = write("study.toml", kPlate);
  ASSERT_EQ(run({"modes", study.string(), "-o", "out", "--no-pictures", "--no-certificate"}).status,
            0);
  const auto certificate = io::parse_json(whole(folder_ / "out/modes.json")).at("certificate");
  for (const auto* key : {"below_hz", "found", "counted"}) {
    EXPECT_TRUE(std::holds_alternative<std::monostate>(certificate.at(key).value())) << key;
  }
}

// There is nothing to paint below the first flexible mode, and nothing is wrong.
TEST_F(CommandLine, WithoutAFlexibleModeThereIsNoPicture) {
  std::string text = kPlate;
  text.replace(text.find("modes = { count = 4 }"), 21, "modes = { up_to = \"1 Hz\" }");
  const auto study = write("study.toml", text);
  const auto modes = run({"modes", study.string(), "-o", "out"});
  EXPECT_EQ(modes.status, 0) << modes.err;
  EXPECT_TRUE(says(modes.err, "modes.png is not painted: no flexible mode was found"));
  EXPECT_FALSE(fs::exists(folder_ / "out/modes.png"));
  EXPECT_TRUE(fs::exists(folder_ / "out/modes.vtu"));
}

TEST_F(CommandLine, WithoutADisplayEverythingElseIsThere) {
  const std::string text = std::string(kPlate) + "[placement]\nmodes = 2\n";
  const auto study = write("study.toml", text).string();
  ASSERT_EQ(run({"study", study, "-o", "out"}).status, 0);
  const auto with = left("out");
  const auto over = ended(started({"study", study, "-o", "out"}, "", [] {
    setenv("PATH", "/nowhere", 1);
    unsetenv("DISPLAY");
  }));
  EXPECT_EQ(over.status, 0) << over.err;
  EXPECT_TRUE(says(over.err, "modes.png is not painted: the painter has no display"));
  EXPECT_TRUE(says(over.err, "heat_map.png is not painted either"));
  std::vector<std::string> expected;
  std::copy_if(with.begin(), with.end(), std::back_inserter(expected),
               [](const auto& name) { return !name.ends_with(".png"); });
  EXPECT_EQ(left("out"), expected) << "an older picture would not be of these results";
  EXPECT_FALSE(says(whole(folder_ / "out/report.html"), "data:image/png"));
}

}  // namespace
}  // namespace chladni::app
