#include "app/command_line/guarded.h"

#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "app/command_line/exit_code.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "host/descriptor.h"
#include "show/excerpt.h"
#include "show/version.h"
#include "stage/remedies.h"

namespace chladni::app {
namespace {

/// Tells errors in a style. Each gives its exit code.
struct ErrorTeller {
  show::Talk& talk;
  const ErrorStyle& style;

  int operator()(const std::string& what, ExitCode code,
                 const std::vector<stage::Remedy>& remedies = {}) const {
    talk.error(style.excerpts ? show::with_excerpts(what) : what);
    if (style.json) {
      const auto result = style.result == nullptr ? "" : style.result->str();
      std::cout << io::text(show::error_json(what, code, remedies, result)) << std::flush;
    }
    return code;
  }

  [[nodiscard]] int unforeseen(const std::string& what) const {
    return (*this)(
        "chladni cannot go on: " + what + "; this is a fault of Chladni " + show::version(),
        kNumericalFailure);
  }
};

/// Tells the error that is being caught.
int told_error(const ErrorTeller& tell) {
  try {
    throw;
  } catch (const InvalidInput& e) {
    return tell(e.what(), kInvalidInput);
  } catch (const Interrupted& e) {
    return tell(e.what(), kInterrupted);
  } catch (const WorkerDied& e) {
    return tell(e.what(), kWorkerDied);
  } catch (const stage::DoesNotFit& e) {
    return tell(e.what(), kOutOfResources, e.remedies);
  } catch (const OutOfResources& e) {
    return tell(e.what(), kOutOfResources);
  } catch (const NumericalFailure& e) {
    return tell(e.what(), kNumericalFailure);
  } catch (const std::bad_alloc&) {
    return tell("out of memory; choose a longer mesh.edge_length or a lower mesh.order",
                kOutOfResources);
  } catch (const std::filesystem::filesystem_error& e) {
    try {
      throw_path_error(e);
    } catch (...) {
      return told_error(tell);
    }
  } catch (const std::system_error& e) {
    return tell(e.what(), kOutOfResources);
  } catch (const std::exception& e) {
    return tell.unforeseen(e.what());
  } catch (...) {
    return tell.unforeseen("it met an error without a name");
  }
}

}  // namespace

int guarded(show::Talk& talk, const std::function<int()>& work, const ErrorStyle& style) {
  try {
    const int status = work();
    talk.clear_progress();
    return status;
  } catch (...) {
    return told_error({talk, style});
  }
}

}  // namespace chladni::app
