// What all results of a study have in Python.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "io/json.h"
#include "python/calls/python_work.h"
#include "show/run.h"

namespace chladni::python {

class Result {
 public:
  Result(std::shared_ptr<const OpenedStudy> opened, Said said)
      : opened_(std::move(opened)), said_(std::move(said)) {}
  virtual ~Result() = default;
  Result(const Result&) = delete;
  Result& operator=(const Result&) = delete;
  Result(Result&&) = delete;
  Result& operator=(Result&&) = delete;

  /// What its verb prints, and the content of its JSON file.
  [[nodiscard]] virtual std::string text() const = 0;
  [[nodiscard]] virtual io::JsonObject json() const = 0;
  /// Leaves the files of its verb.
  virtual void leave(show::Run& run) const = 0;
  /// As a page of its own; empty: it has none.
  [[nodiscard]] virtual std::string page() const { return {}; }

  [[nodiscard]] const std::shared_ptr<const OpenedStudy>& opened() const { return opened_; }
  [[nodiscard]] const study::Study& study() const { return opened_->study; }
  [[nodiscard]] const Said& said() const { return said_; }

 private:
  std::shared_ptr<const OpenedStudy> opened_;
  Said said_;
};

}  // namespace chladni::python
