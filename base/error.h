// Everything the library throws. Nothing else crosses a public boundary.
#pragma once

#include <stdexcept>
#include <string>

namespace chladni {

/// What the caller passed cannot be meant: wrong shape, wrong unit, a file that is not what it
/// says. The message names the thing, the value found and the value expected.
class InvalidInput : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The input was sound and the computation still has no usable answer: a matrix that is not
/// positive definite, an iteration that did not converge.
class NumericalFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine does not have what the computation needs: memory (forecast before it starts), disk.
class OutOfResources : public NumericalFailure {
 public:
  using NumericalFailure::NumericalFailure;
};

/// A program of ours that works behind a pipe (the mesher, the painter) aborted, crashed or ran out
/// of its limits. The message says which, how it ended and what to do.
class WorkerDied : public NumericalFailure {
 public:
  using NumericalFailure::NumericalFailure;
};

/// The user pressed Ctrl-C. Thrown by `throw_if_interrupted()`, never by a signal handler. It is no
/// failure: what tries another way after a NumericalFailure lets it pass.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws InvalidInput(message) unless `condition` holds.
inline void require(bool condition, const std::string& message) {
  if (!condition) throw InvalidInput(message);
}

}  // namespace chladni
