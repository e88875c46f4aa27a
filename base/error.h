// All exceptions of the library. No other exception crosses a public boundary.
#pragma once

#include <stdexcept>
#include <string>

namespace chladni {

/// The caller's input is wrong: a wrong shape, a wrong unit, a file with other content than it
/// claims. The message names the input, the value found and the value expected.
class InvalidInput : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The input was sound, but the computation has no usable result: a matrix is not positive
/// definite, or an iteration did not converge.
class NumericalFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine has too little memory (forecast before the computation starts) or disk space. It is
/// no NumericalFailure: code that leaves out what has no usable result does not leave this out.
class OutOfResources : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A worker program behind a pipe (the mesher, the painter) aborted, crashed or exceeded its
/// limits. The message says which program, how it ended and what to do.
class WorkerDied : public NumericalFailure {
 public:
  using NumericalFailure::NumericalFailure;
};

/// The user pressed Ctrl-C. `throw_if_interrupted()` throws it, never a signal handler. It is not a
/// failure: code that tries another way after a NumericalFailure does not catch it.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws InvalidInput(message) unless `condition` holds.
inline void require(bool condition, const std::string& message) {
  if (!condition) throw InvalidInput(message);
}

}  // namespace chladni
