// What readers make of workers that lie: a script in the place of the program sends their replies.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "host/worker.h"
#include "io/mat.h"
#include "io/vtu.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

class FalseWorker : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("chladni_false_worker_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    for (const char* name : {"chladni-mat", "chladni-vtu"}) {
      std::ofstream(folder_ / name)
          << "#!/bin/sh\nexec cat '" << (folder_ / "reply").string() << "'\n";
      fs::permissions(folder_ / name, fs::perms::owner_all);
    }
    std::ofstream(folder_ / "a.mat") << "anything";
    std::ofstream(folder_ / "a.vtu") << "anything";
    setenv("CHLADNI_LIBEXEC", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("CHLADNI_LIBEXEC");
    fs::remove_all(folder_);
  }

  void say(const std::string& head, const std::string& arrays, std::size_t bytes) const {
    const std::string json = R"({"head": )" + head + R"(, "arrays": [)" + arrays + "]}";
    std::ofstream(folder_ / "reply", std::ios::binary) << "chladni-message " << json.size() << "\n"
                                                       << json << std::string(bytes, '\0');
  }

  // A file with one variable of these dimensions; six numbers are sent.
  void say_mat(const std::string& dims, const std::string& of) const {
    say(R"({"format": "MAT 5", "notes": [], "variables": [{"name": "H", "value": {"class": "double",
        "dims": )" +
            dims + ", " + of + "}}]}",
        R"({"name": "a0", "type": "f64", "rows": 6, "columns": 1})", 48);
  }

  fs::path folder_;
};

TEST_F(FalseWorker, ASoundReplyIsRead) {
  say_mat("[2, 3]", R"("kind": "number", "real": "a0", "imag": "")");
  const auto file = read_mat(folder_ / "a.mat", 1 << 20);
  EXPECT_EQ(file.variables.at(0).second.real.size(), 6);
}

TEST_F(FalseWorker, DimensionsThatLieAreRefused) {
  const std::string number = R"("kind": "number", "real": "a0", "imag": "")";
  const std::string text = R"("kind": "text", "rows": ["a"])";
  const std::string cells = R"("kind": "cell", "cells": [])";
  for (const auto& [dims, of] : std::vector<std::pair<std::string, std::string>>{
           {"[2, 4]", number},
           {"[6]", number},
           {"[]", number},
           {"[-2, -3]", number},
           {"[1.5, 4]", number},
           {"[1e300, 1]", text},
           {"[4294967296, 4294967296]", text},  // a product of 2⁶⁴
           {"[4294967296, 4294967296]", number},
           {"[0, 1e300]", text},
           {"[\"2\", 3]", number},
           {"[3, 1]", cells},
           {"[2, 3]", R"("kind": "number", "real": "b", "imag": "")"},
           {"[2, 3]", R"("kind": "number", "real": "", "imag": "a0")"}}) {
    say_mat(dims, of);
    EXPECT_THROW((void)read_mat(folder_ / "a.mat", 1 << 20), UnusableReply) << dims << of;
  }
}

TEST_F(FalseWorker, ABodyThatLiesIsRefused) {
  const auto points = [](int columns) {
    return R"({"name": "points", "type": "f64", "rows": 4, "columns": )" + std::to_string(columns) +
           "}";
  };
  const std::string tets = R"({"name": "tets", "type": "i32", "rows": 1, "columns": 4})";
  const std::string none = R"({"name": "region", "type": "i32", "rows": 0, "columns": 1})";
  say(R"({"region_names": []})", points(2) + "," + tets + "," + none, 4 * 16 + 16);
  EXPECT_THROW((void)read_vtu(folder_ / "a.vtu"), InvalidInput);
  say(R"({"region_names": []})", points(3) + "," + tets + "," + none, 4 * 24 + 16);
  EXPECT_THROW((void)read_vtu(folder_ / "a.vtu"), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
