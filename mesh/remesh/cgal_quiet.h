// Makes CGAL silent and repeatable.
#pragma once

#include <CGAL/Random.h>
#include <CGAL/assertions_behaviour.h>

namespace chladni::mesh {

/// While an object of this class lives, failed CGAL preconditions throw without printing. Random
/// choices start from a fixed seed.
class CgalQuiet {
 public:
  CgalQuiet()
      : errors_(CGAL::set_error_handler(&say_nothing)),
        warnings_(CGAL::set_warning_handler(&say_nothing)) {
    CGAL::get_default_random() = CGAL::Random(0);
  }
  ~CgalQuiet() {
    CGAL::set_error_handler(errors_);
    CGAL::set_warning_handler(warnings_);
  }
  CgalQuiet(const CgalQuiet&) = delete;
  CgalQuiet& operator=(const CgalQuiet&) = delete;

 private:
  static void say_nothing(const char*, const char*, const char*, int, const char*) {}
  CGAL::Failure_function errors_, warnings_;
};

}  // namespace chladni::mesh
