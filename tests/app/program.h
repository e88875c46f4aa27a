// The program as a process, in a folder of its own.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/sanitizer.h"

namespace chladni::app {

namespace fs = std::filesystem;

struct Ended {
  int status = -1;
  std::string out, err;
};

inline std::string whole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::ranges::replace(name, '/', '_');  // of a case
    folder_ = fs::temp_directory_path() / ("chladni_" + std::to_string(getpid()) + "_" + name);
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  /// Starts the program; its streams go to files. `prepare` is called in the new process.
  pid_t started(
      const std::vector<std::string>& arguments, const std::string& stream = "",
      const std::function<void()>& prepare = [] {}) const {
    const pid_t child = fork();
    if (child != 0) return child;
    const auto onto = [](const fs::path& file, int descriptor) {
      dup2(open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), descriptor);
    };
    onto(stream.empty() ? folder_ / "stdout" : fs::path(stream), STDOUT_FILENO);
    onto(folder_ / "stderr", STDERR_FILENO);
    if (chdir(folder_.c_str()) != 0) _exit(99);
    prepare();
    std::string program = CHLADNI_BINARY_DIR "/bin/chladni";
    std::vector<std::string> words = arguments;
    std::vector<char*> argv = {program.data()};
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    execv(program.c_str(), argv.data());
    _exit(98);
  }

  Ended ended(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            whole(folder_ / "stdout"), whole(folder_ / "stderr")};
  }

  Ended run(const std::vector<std::string>& arguments, const std::string& stream = "") const {
    return ended(started(arguments, stream));
  }

  /// Files below the output folder, by name.
  std::vector<std::string> left(const std::string& out) const {
    std::vector<std::string> names;
    if (!fs::exists(folder_ / out)) return names;
    for (const auto& entry : fs::directory_iterator(folder_ / out)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder_;
};

inline constexpr const char* kPlate = R"(title = "small plate"
geometry = { plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "10 mm", order = 2 }
modes = { count = 4 }
[[sensor]]
name = "s1"
at = ["-40 mm", "20 mm"]
direction = "z"
)";

inline testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in\n" << text;
}

}  // namespace chladni::app
