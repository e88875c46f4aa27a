// Prints which eighth of the tests this tree's sample has, 0 to 7, or "all": its rest by four is
// the quarter.
#include <fmt/format.h>

#include <cstdlib>
#include <exception>

#include "rotation/drawn_sample.h"

int main(int count, char** arguments) {
  using namespace chladni::rotation;
  try {
    const char* asked = std::getenv("CHLADNI_STUDIES");
    const auto sample =
        drawn_sample(asked == nullptr ? "" : asked, tree_state(count > 1 ? arguments[1] : "."));
    fmt::print("{}\n", sample.all ? "all" : fmt::to_string(sample.eighth()));
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
