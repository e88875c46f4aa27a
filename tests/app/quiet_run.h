// A verb's steps in a test: a folder of its own, no pictures, no inertia count, nothing on the
// terminal.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <sstream>
#include <string>

#include "app/command.h"

namespace chladni::app {

/// A folder that goes when this does.
class TestFolder {
 public:
  explicit TestFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("chladni_" + name + "_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A run that keeps what it says. The study must outlive it.
class QuietRun {
 public:
  QuietRun(const study::Study& study, const std::filesystem::path& folder,
           double memory_limit_gb = 0.0)
      : talk_(said_, {.quiet = false, .progress = false, .lines = false}),
        run_(study, options(folder, memory_limit_gb), shown_, talk_) {}

  [[nodiscard]] show::Run& run() { return run_; }
  [[nodiscard]] std::string shown() const { return shown_.str(); }
  [[nodiscard]] std::string said() const { return said_.str(); }

 private:
  static show::Options options(const std::filesystem::path& folder, double memory_limit_gb) {
    show::Options options;
    options.memory_limit_gb = memory_limit_gb;
    options.folder = folder;
    options.pictures = false;
    options.certificate = false;
    return options;
  }

  std::ostringstream shown_, said_;
  show::Talk talk_;
  show::Run run_;
};

}  // namespace chladni::app
