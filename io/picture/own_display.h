// A display for a picture where nobody looks.
#pragma once

#include <sys/types.h>

#include <string>

namespace chladni::picture {

/// An Xvfb of this process's own, with DISPLAY and XAUTHORITY set to it. It ends with this process,
/// however that ends (kill -9 too), and takes its lock and its socket along; the cookie that admits
/// to it is in memory. Takes some 0.1 s.
class OwnDisplay {
 public:
  /// @throws std::runtime_error  `xvfb` does not start, or tells no display within 30 s
  explicit OwnDisplay(const std::string& xvfb);
  ~OwnDisplay();
  OwnDisplay(const OwnDisplay&) = delete;
  OwnDisplay& operator=(const OwnDisplay&) = delete;
  OwnDisplay(OwnDisplay&&) = delete;
  OwnDisplay& operator=(OwnDisplay&&) = delete;

 private:
  void end() const;

  pid_t server_ = -1;
};

}  // namespace chladni::picture
