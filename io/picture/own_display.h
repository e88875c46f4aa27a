// A private, invisible display for painting a picture.
#pragma once

#include <sys/types.h>

#include <string>

#include "host/descriptor.h"

namespace chladni::picture {

/// A private Xvfb of this process; DISPLAY and XAUTHORITY are set to it. The Xvfb ends with this
/// process in all cases (kill -9 too) and then removes its lock and its socket. The cookie that
/// gives access is in memory only. The start takes about 0.1 s.
class OwnDisplay {
 public:
  /// @throws std::runtime_error  `xvfb` does not start, or reports no display within 30 s
  explicit OwnDisplay(const std::string& xvfb);
  ~OwnDisplay();
  OwnDisplay(const OwnDisplay&) = delete;
  OwnDisplay& operator=(const OwnDisplay&) = delete;
  OwnDisplay(OwnDisplay&&) = delete;
  OwnDisplay& operator=(OwnDisplay&&) = delete;

 private:
  void end() const;

  Descriptor cookie_;  // open as long as the display is used
  pid_t server_ = -1;
};

}  // namespace chladni::picture
