// The exit codes of the program (docs/reference/cli.md).
#pragma once

namespace chladni::app {

enum ExitCode {
  kDone = 0,
  kUsage = 2,
  kInvalidInput = 3,
  kNumericalFailure = 4,
  kOutOfResources = 5,
  kWorkerDied = 6,
  kInterrupted = 130
};

}  // namespace chladni::app
